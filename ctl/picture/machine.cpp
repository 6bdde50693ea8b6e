// SPDX-License-Identifier: LGPL-3.0-or-later
#include "picture/machine.h"

#include <algorithm>

namespace mauve::ctl {
namespace {

std::optional<std::size_t> find(const std::vector<Machine::State>& states,
                                const std::string& name) {
  const auto found = std::find_if(states.begin(), states.end(),
                                  [&](const Machine::State& one) { return one.name == name; });
  if (found == states.end()) return std::nullopt;
  return static_cast<std::size_t>(found - states.begin());
}

/// Guards are asked in order; the remaining transition is followed when none is true.
void add_transitions(const Json& rows, const std::vector<Machine::State>& states,
                     Machine::State& state) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto to = find(states, word(rows[i], "to"));
    if (!to) continue;
    state.transitions.push_back({*to, mark_of_transition(rows, i)});
  }
}

}  // namespace

Machine machine_of(const Json& object) {
  Machine machine;
  machine.component = word(object, "address");
  machine.type = word(object, "fsm");
  const Json described = object.is_object() ? object.value("machine", Json()) : Json();
  const Json& rows = list_in(described, "states");
  for (const Json& row : rows) {
    const bool waits = word(row, "kind") == "synchronization";
    machine.states.push_back(
        {word(row, "name"), waits, waits ? nanoseconds_in_words(number(row, "wait_ns")) : "", {}});
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    add_transitions(list_in(rows[i], "transitions"), machine.states, machine.states[i]);
  }
  machine.initial = find(machine.states, word(described, "initial")).value_or(0);
  if (word(object, "state") == "running") {
    machine.current = find(machine.states, word(object, "fsm_state"));
  }
  return machine;
}

}  // namespace mauve::ctl
