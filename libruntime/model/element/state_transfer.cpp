// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/element/state_transfer.h"

#include <new>

#include "model/job/guard.h"

#include <mauve/host/resource.h>
#include <mauve/state.h>

namespace mauve {
namespace {

/// Room for one value.
class Room {
 public:
  explicit Room(const DataType& type)
      : alignment_(static_cast<std::align_val_t>(type.alignment)),
        memory_(::operator new(type.size, alignment_)) {}
  ~Room() { ::operator delete(memory_, alignment_); }
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

  [[nodiscard]] void* get() const { return memory_; }

 private:
  std::align_val_t alignment_;
  void* memory_;
};

bool follows(const DataType& now, const DataType& old) {
  return now.before != nullptr && same_type(now.before(), old);
}

Error not_made_from(const ResourceBase& from, const DataType& old, const ResourceBase& into,
                    const ValueStore* place) {
  const std::string held = from.name() + " holds values of " + old.name;
  if (place == nullptr) {
    return refuse({Errc::type_mismatch, "state_would_be_lost"}, into.core().address(),
                  "has no place for them: " + held + ", and it does not say that it needs none",
                  "say --state drop to start it fresh, or --sync cut");
  }
  return refuse(
      {Errc::type_mismatch, "state_not_convertible"}, into.name(),
      held + ", and " + place->data().name + " cannot be made from them",
      "say --state drop to start it empty, or give the new type a Before and a convert(), "
      "see mauve/type.h");
}

Error undeclared(const CoreBase& core) {
  return refuse(
      {Errc::unsupported, "state_not_declared"}, core.address(),
      "declares neither a state to hand over nor that it has none, so what it holds would "
      "silently be lost",
      "say --state drop to start the next one fresh, or declare mauve::State or "
      "mauve::Stateless in the core");
}

Error no_copy_back(const StateBase& state, const CoreBase& into) {
  return refuse({Errc::unsupported, "state_not_plain"}, into.address(),
                "takes the state " + state.type().name +
                    " over as it is; it is not plain bytes, so the old resource could not keep a "
                    "copy to come back with",
                "say --probation off, or --state drop");
}

std::size_t transfer(const ValueStore& from, ValueStore& into) {
  const DataType& type = into.data();
  const bool as_it_is = same_type(type, from.data());
  const Room room(type);
  std::size_t bytes = 0;
  from.each([&](const void* value, Instant stamp) {
    if (!as_it_is) {
      type.construct(room.get());
      type.convert(value, room.get());
    }
    into.put(as_it_is ? value : room.get(), stamp);
    bytes += from.data().size;
  });
  return bytes;
}

}  // namespace

Result<std::size_t> StateTransfer::run(const std::string& at, const rt::Watched& watched) const {
  std::size_t bytes = hand_over.bytes;
  const auto body = [&] {
    if (from != nullptr) {
      bytes = transfer(*from, *into);
    } else if (copies) {
      hand_over.into->copy(*hand_over.from);
    } else if (const rt::Fault fault = hand_over.run(); fault.happened()) {
      return Status(detail::crashed(at, "converter", fault));
    }
    return ok();
  };
  if (Status done = call_hook(at, "converter", body, watched); !done) return done.error();
  return bytes;
}

void StateTransfer::undo() const {
  const bool moved = from == nullptr && !copies && hand_over.convert == nullptr;
  if (moved) static_cast<void>(hand_over.run());
}

Result<StateTransfer> plan_transfer(const ResourceBase& from, const ResourceBase& into,
                                    StatePolicy policy, bool rolls_back) {
  StateTransfer plan;
  if (policy == StatePolicy::drop) return plan;
  if (Status whole = check_whole(from, policy); !whole) return whole.error();
  const CoreBase& old = from.core();
  if (const auto* held = dynamic_cast<const ValueStore*>(&old)) {
    auto* const place = dynamic_cast<ValueStore*>(&into.core());
    if (place == nullptr && into.core().declared_stateless()) return plan;
    const bool goes_on = place != nullptr && (same_type(place->data(), held->data()) ||
                                              follows(place->data(), held->data()));
    if (!goes_on) return not_made_from(from, held->data(), into, place);
    plan.from = held;
    plan.into = place;
    return plan;
  }
  if (!declares_state(old)) return undeclared(old);
  const auto hand_over = plan_hand_over(old, into.core(), policy);
  if (!hand_over) return hand_over.error();
  plan.hand_over = *hand_over;
  const bool moves = plan.hand_over.from != nullptr && plan.hand_over.convert == nullptr;
  plan.copies = moves && rolls_back;
  const bool plain = moves && plan.hand_over.from->type().flat;
  if (plan.copies && !plain) return no_copy_back(*plan.hand_over.from, into.core());
  return plan;
}

}  // namespace mauve
