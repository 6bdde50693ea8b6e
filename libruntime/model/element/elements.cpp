// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/element/elements.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <mauve/detail/capsule.h>
#include <mauve/detail/port_base.h>
#include <mauve/fsm.h>
#include <mauve/observable.h>
#include <mauve/slow_state.h>
#include <mauve/state.h>

namespace mauve {
namespace {

std::size_t place_of(const void* member, const void* object) {
  return static_cast<std::size_t>(static_cast<const char*>(member) -
                                  static_cast<const char*>(object));
}

void append_values(const Configurable& element, const void* object, std::vector<Member>& members) {
  for (const PropertyBase* one : element.properties()) {
    members.push_back({"property " + std::string(one->name()), one->type().name, one->type().layout,
                       place_of(one, object)});
  }
  for (const ObservableBase* one : element.observables()) {
    members.push_back({"observable " + std::string(one->name()), one->type().name,
                       one->type().layout, place_of(one, object)});
  }
}

void append_state(const Capsule* state, const char* kind, const void* object,
                  std::vector<Member>& members) {
  if (state == nullptr) return;
  members.push_back({kind + state->type().name, state->type().name, state->type().layout,
                     place_of(state, object)});
}

/// A member on the heap has an offset beyond the object, since that is unsigned.
void leave_out_heap(std::vector<Member>& members, std::size_t size) {
  std::erase_if(members, [size](const Member& member) { return member.offset >= size; });
}

const Member* find(const std::vector<Member>& members, const std::string& name) {
  for (const Member& member : members) {
    if (member.name == name) return &member;
  }
  return nullptr;
}

/// The difference of two members of one name, as a clause of a sentence. `other` may be null.
std::string difference(const Member& member, const Member* other) {
  if (other == nullptr) return member.name + " is unknown to one of them";
  if (member.type != other->type) {
    return member.name + " is a " + member.type + " for one and a " + other->type +
           " for the other";
  }
  if (member.layout != other->layout) {
    return "the type " + member.type + " of " + member.name +
           " has other fields, or has no description and was compiled apart";
  }
  return member.name + " lies at byte " + std::to_string(member.offset) + " for one and at byte " +
         std::to_string(other->offset) + " for the other";
}

/// The first difference; nothing when there is none.
std::optional<std::string> difference(const std::vector<Member>& a, const std::vector<Member>& b) {
  for (const Member& member : a) {
    // Two members may have one name, which is refused elsewhere and is no difference here.
    const bool same = std::find(b.begin(), b.end(), member) != b.end();
    if (!same) return difference(member, find(b, member.name));
  }
  for (const Member& member : b) {
    if (find(a, member.name) == nullptr) return difference(member, nullptr);
  }
  return std::nullopt;
}

std::string two(std::size_t a, std::size_t b, const char* unit) {
  return std::to_string(a) + " and " + std::to_string(b) + " " + unit;
}

std::optional<std::string> difference(const Contract& a, const Contract& b) {
  if (a.shell != b.shell) return "the shell is " + a.shell + " for one and " + b.shell;
  if (auto members = difference(a.shell_members, b.shell_members)) return members;
  if (a.shell_size != b.shell_size) {
    return "the shell has " + two(a.shell_size, b.shell_size, "bytes");
  }
  if (a.functions != b.functions) {
    return "the contract class has " + two(a.functions, b.functions, "virtual functions");
  }
  if (a.size != b.size) return "the contract class has " + two(a.size, b.size, "bytes");
  return std::nullopt;
}

Error other_headers(const std::string& at, std::string message) {
  return refuse({Errc::type_mismatch, "contract_layout_differs"}, at, std::move(message),
                "rebuild both plugins with the same header; a contract or shell that changes on "
                "purpose gets a new revision in its name");
}

/// A core, a state machine and a shell of one contract see the same classes.
Status check_same_headers(const std::string& at, const CoreType& core, const FsmType& fsm,
                          const ShellType& shell) {
  if (const auto differs = difference(core.contract, fsm.contract)) {
    return other_headers(at, "core " + core.name + " and state machine " + fsm.name +
                                 " were built with different headers of contract " +
                                 core.contract.name + ": " + *differs);
  }
  if (core.contract.shell != shell.name) {
    return other_headers(at, "core " + core.name + " expects the shell " + core.contract.shell +
                                 ", but the component has " + shell.name);
  }
  if (const auto differs = difference(core.contract.shell_members, shell.members)) {
    return other_headers(at, "core " + core.name + " was built with another header of the shell " +
                                 shell.name + ": " + *differs);
  }
  return ok();
}

}  // namespace

std::vector<Member> members_of(const Shell& shell, std::size_t size) {
  std::vector<Member> members;
  for (const PortBase* port : shell.ports()) {
    members.push_back({"port " + std::string(port->name()), to_string(port->signature()),
                       port->signature().layout, place_of(port, &shell)});
  }
  append_values(shell, &shell, members);
  leave_out_heap(members, size);
  return members;
}

std::vector<Member> members_of(const CoreBase& core, std::size_t size) {
  std::vector<Member> members;
  append_values(core, &core, members);
  append_state(core.declared_state(), "state ", &core, members);
  append_state(core.declared_slow_state(), "slow state ", &core, members);
  leave_out_heap(members, size);
  return members;
}

Status check_same_members(const CoreBase& old, const CoreBase& now, const Contract& contract) {
  const auto differs = difference(members_of(old, contract.size), members_of(now, contract.size));
  if (!differs) return ok();
  return other_headers(now.address(), "was built with another header of contract " + contract.name +
                                          " than the core in force: " + *differs);
}

Status check_contract(const std::string& at, const CoreType& core, const FsmType& fsm,
                      const ShellType& shell) {
  if (core.contract.name != fsm.contract.name) {
    return refuse(
        {Errc::type_mismatch, "core_other_contract"}, at,
        "core " + core.name + " fulfils contract " + core.contract.name + ", but state machine " +
            fsm.name + " calls " + fsm.contract.name,
        "choose a core of contract " + fsm.contract.name +
            ", or write `using Contract = BASE;` into BASE, the base class of both cores");
  }
  return check_same_headers(at, core, fsm, shell);
}

void name_ports_in_trace(const Shell& shell) {
  const std::string& address = shell.address();
  const std::string owner = address.substr(0, address.find('.'));
  for (PortBase* port : shell.ports()) {
    port->name_in_trace(owner + "." + std::string(port->name()));
  }
}

Status check_machine(FsmBase& fsm) {
  if (fsm.configured()) return ok();
  if (Status built = fsm.configure(); !built) return built;
  return fsm.cleanup();
}

Status configure_in_order(std::span<Configurable* const> elements) {
  std::vector<Configurable*> configured;
  for (Configurable* element : elements) {
    if (element->configured()) continue;
    if (Status done = element->configure(); !done) {
      static_cast<void>(cleanup_in_reverse(configured));
      return done;
    }
    configured.push_back(element);
  }
  return ok();
}

Status cleanup_in_reverse(std::span<Configurable* const> elements) {
  Status first = ok();
  for (auto element = elements.rbegin(); element != elements.rend(); ++element) {
    Status done = (*element)->cleanup();
    if (first && !done) first = std::move(done);
  }
  return first;
}

}  // namespace mauve
