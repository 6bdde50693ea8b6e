// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/fsm.h>
#include <mauve/trace.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "base/address.h"
#include "model/element/find_named.h"

namespace mauve {
namespace {

using Marks = std::vector<char>;

void mark_reachable(const FsmState& state, Marks& reached) {
  if (std::exchange(reached[state.index()], char{1}) != 0) return;
  for (const auto& transition : state.transitions()) mark_reachable(*transition.target, reached);
  if (state.successor() != nullptr) mark_reachable(*state.successor(), reached);
}

/// Names a cycle of execution states through `state`, or returns an empty text.
std::string find_cycle(const FsmState& state, std::vector<const FsmState*>& path, Marks& done) {
  if (state.kind() == FsmState::Kind::synchronization || done[state.index()] != 0) return {};
  const auto before = std::find(path.begin(), path.end(), &state);
  if (before != path.end()) {
    std::string text;
    for (auto it = before; it != path.end(); ++it) text += std::string((*it)->name()) + " -> ";
    return text + std::string(state.name());
  }
  path.push_back(&state);
  std::vector<const FsmState*> next;
  for (const auto& transition : state.transitions()) next.push_back(transition.target);
  if (state.successor() != nullptr) next.push_back(state.successor());
  for (const FsmState* target : next) {
    if (std::string cycle = find_cycle(*target, path, done); !cycle.empty()) return cycle;
  }
  path.pop_back();
  done[state.index()] = 1;
  return {};
}

}  // namespace

FsmState::FsmState(FsmBase& fsm, std::string_view name, Kind kind)
    : name_(name), kind_(kind), index_(fsm.states_.size()), trace_name_(trace_name_id(name)) {
  fsm.states_.push_back(this);
}

FsmState* FsmBase::find_state(std::string_view name) const { return find_named(states_, name); }

Duration FsmBase::grid() const {
  Duration grid{0};
  for (const FsmState* state : states_) {
    grid = Duration{std::gcd(grid.count(), state->duration().count())};
  }
  return grid;
}

Duration FsmBase::shortest_wait() const {
  Duration shortest{0};
  for (const FsmState* state : states_) {
    const Duration wait = state->duration();
    if (wait > Duration{0} && (shortest == Duration{0} || wait < shortest)) shortest = wait;
  }
  return shortest;
}

void FsmBase::mauve_reset() {
  initial_ = nullptr;
  for (FsmState* state : states_) {
    state->transitions_.clear();
    state->successor_ = nullptr;
  }
}

Status FsmBase::mauve_verify() {
  if (initial_ == nullptr) {
    return refuse({Errc::invalid_value, "fsm_incomplete"}, address(), "has no initial state",
                  "call start_at(state) in on_configure");
  }
  Marks reached(states_.size(), 0);
  mark_reachable(*initial_, reached);
  Marks done(states_.size(), 0);
  for (const FsmState* state : states_) {
    if (Status named = check_name(state->name(), address()); !named) return named;
    const std::string at = address() + "." + std::string(state->name());
    if (reached[state->index()] == 0) {
      return refuse({Errc::invalid_value, "fsm_incomplete"}, at,
                    "can never be reached from the initial state");
    }
    if (state->successor() == nullptr) {
      return refuse({Errc::invalid_value, "fsm_incomplete"}, at, "has no default successor",
                    "add .then(state)");
    }
    std::vector<const FsmState*> path;
    if (std::string cycle = find_cycle(*state, path, done); !cycle.empty()) {
      return refuse({Errc::cycle, "fsm_never_waits"}, at,
                    "execution states form a cycle that never waits: " + cycle,
                    "put a synchronization state into it");
    }
  }
  return ok();
}

}  // namespace mauve
