// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/element/hand_over.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "model/job/guard.h"
#include "rt/process/cache.h"

#include <mauve/converts.h>
#include <mauve/host/resource.h>

namespace mauve {
namespace {

/// "guidance/1 (layout 91c3f2aa, 40 B)"
std::string shown(const DataType& type) {
  std::array<char, 48> details{};
  std::snprintf(details.data(), details.size(), " (layout %08x, %zu B)",
                static_cast<unsigned>(type.layout >> 32U), type.size);
  return type.name + details.data();
}

Error lost(const CoreBase& into, const Capsule& from, const Capsule* found, const char* member) {
  const std::string drop = "say --state drop to start it fresh, or declare ";
  if (found == nullptr) {
    return refuse({Errc::type_mismatch, "state_would_be_lost"}, into.address(),
                  "the new core has no place for the state " + shown(from.type()) +
                      " of the core in force, and does not say that it needs none",
                  drop + member + " or mauve::Stateless in the new core");
  }
  if (found->type().name == from.type().name && !from.type().vouched) {
    return refuse(
        {Errc::type_mismatch, "state_not_described"}, into.address(),
        "the new core was built anew, and its state " + shown(from.type()) +
            " has no description, so its fields may lie otherwise than in the core in force",
        "give it a static type_name and fields() (or the type_name alone, by which you vouch for "
        "its layout) and build both again, or say --state drop to start it fresh");
  }
  return refuse({Errc::type_mismatch, "state_not_convertible"}, into.address(),
                "the new core has the state " + shown(found->type()) +
                    ", but the core in force has " + shown(from.type()) +
                    ", which the new core cannot convert",
                drop + "a mauve::Converts in the new core");
}

Error state_would_vanish(const CoreBase& into, const Capsule& from) {
  return refuse({Errc::type_mismatch, "state_would_be_lost"}, into.address(),
                "the new core takes no state, so " + shown(from.type()) +
                    " of the core in force would be lost",
                "say --state drop when that is meant");
}

Status share(const SlowStateBase& from, SlowStateBase& into, const std::string& address) {
  if (into.fits(from)) {
    into.share(from);
    return ok();
  }
  const ConvertsBase* const convert = into.converter_from(from.type());
  return call_hook(address, "converter", [&] { return into.convert(from, *convert), ok(); });
}

/// May the data go on in this place?
bool takes(const Capsule* into, const Capsule& from) {
  return into != nullptr && (into->fits(from) || into->converter_from(from.type()) != nullptr);
}

/// Is a struct in the description without fields? An empty fields() compares as little as a name.
bool lacks_fields(const Value& described) {
  if (const auto* fields = described.get_if<Value::Array>()) {
    return fields->empty() ||
           std::ranges::any_of(*fields, [](const Value& part) { return lacks_fields(part); });
  }
  const auto* object = described.get_if<Value::Object>();
  return object != nullptr &&
         std::ranges::any_of(*object, [](const auto& part) { return lacks_fields(part.second); });
}

bool lacks_fields(const DataType& type) {
  return type.describe == nullptr || lacks_fields(type.describe());
}

/// A core that is declared Stateless may leave a state that is only offered.
bool may_leave(const CoreBase& into, StatePolicy policy) {
  return policy == StatePolicy::offer && into.declared_stateless();
}

Status check_slow(const CoreBase& from, const CoreBase& into, StatePolicy policy) {
  if (from.declared_slow_state() == nullptr) return ok();
  const SlowStateBase& old = *from.declared_slow_state();
  const SlowStateBase* const place = into.declared_slow_state();
  if (takes(place, old)) return ok();
  if (place == nullptr && may_leave(into, policy)) return ok();
  if (place == nullptr && into.declared_stateless()) return state_would_vanish(into, old);
  return lost(into, old, place, "mauve::SlowState");
}

}  // namespace

MAUVE_RUNS_AT_A_SWAP rt::Fault HandOver::run(const rt::Watched& watched) const {
  if (from == nullptr) return {};
  if (convert == nullptr) {
    into->exchange(*from);
    return {};
  }
  HandOver copy = *this;  // a thread that never returns from the converter outlives the original
  return rt::run_guarded(&HandOver::run_converter, &copy, watched);
}

void HandOver::run_converter(void* self) {
  const auto& plan = *static_cast<const HandOver*>(self);
  plan.into->convert(*plan.from, *plan.convert);
}

void HandOver::touch() const {
  if (from == nullptr) return;
  rt::touch(from, sizeof *from);
  rt::touch(into, sizeof *into);
  if (convert == nullptr) return;
  rt::touch(convert, sizeof *convert);
  rt::touch(from->data(), from->type().size);
  rt::touch(into->data(), into->type().size);
}

Result<HandOver> plan_hand_over(const CoreBase& from, const CoreBase& into, StatePolicy policy) {
  StateBase* const old = from.declared_state();
  StateBase* const place = into.declared_state();
  if (&from == &into || policy == StatePolicy::drop || old == nullptr) return HandOver{};
  if (place == nullptr && may_leave(into, policy)) return HandOver{};
  if (place == nullptr && into.declared_stateless()) return state_would_vanish(into, *old);
  if (!takes(place, *old)) return lost(into, *old, place, "mauve::State");
  const ConvertsBase* const convert =
      place->fits(*old) ? nullptr : place->converter_from(old->type());
  return HandOver{old, place, convert, old->type().size};
}

Status check_hand_over(const CoreBase& from, const CoreBase& into, StatePolicy policy) {
  if (policy == StatePolicy::drop) return ok();
  if (const auto plan = plan_hand_over(from, into, policy); !plan) return plan.error();
  return check_slow(from, into, policy);
}

Status prepare_hand_over(const CoreBase& from, const CoreBase& into, StatePolicy policy) {
  if (Status good = check_hand_over(from, into, policy); !good) return good;
  const SlowStateBase* const old = from.declared_slow_state();
  SlowStateBase* const place = into.declared_slow_state();
  if (policy == StatePolicy::drop || old == nullptr || !takes(place, *old)) return ok();
  return share(*old, *place, into.address());
}

std::vector<const DataType*> dropped_states(const CoreBase& from, const CoreBase& into,
                                            StatePolicy policy) {
  std::vector<const DataType*> dropped;
  const auto look = [&](const Capsule* old, const Capsule* place) {
    const bool adopted = policy != StatePolicy::drop && old != nullptr && takes(place, *old);
    if (old != nullptr && !adopted) dropped.push_back(&old->type());
  };
  if (&from == &into) return dropped;
  look(from.declared_state(), into.declared_state());
  look(from.declared_slow_state(), into.declared_slow_state());
  return dropped;
}

std::vector<const DataType*> unexamined_states(const CoreBase& from, const CoreBase& into,
                                               StatePolicy policy) {
  std::vector<const DataType*> unexamined;
  const auto look = [&](const Capsule* old, const Capsule* place) {
    if (old == nullptr || place == nullptr || !place->fits(*old)) return;
    const bool one_build = &old->type() == &place->type();
    if (!one_build && lacks_fields(old->type())) unexamined.push_back(&old->type());
  };
  if (&from == &into || policy == StatePolicy::drop) return unexamined;
  look(from.declared_state(), into.declared_state());
  look(from.declared_slow_state(), into.declared_slow_state());
  return unexamined;
}

bool declares_state(const CoreBase& core) {
  return core.declared_state() != nullptr || core.declared_slow_state() != nullptr ||
         core.declared_stateless();
}

Status check_whole(const ResourceBase& from, StatePolicy policy) {
  if (policy == StatePolicy::drop || !from.lock().poisoned() || from.core().declared_stateless()) {
    return ok();
  }
  return refuse({Errc::wrong_state, "resource_poisoned"}, from.name(),
                "is poisoned: a caller was aborted in it, so its data may be half written",
                "say --state drop to start it fresh");
}

}  // namespace mauve
