// SPDX-License-Identifier: LGPL-3.0-or-later
/// lock.set: freezes the robot against changes, during a mission say. At once, also beside a change
/// that is prepared, which is then refused.
#include <algorithm>
#include <array>

#include "commands/answer.h"

#include "base/thread_role.h"
#include "commands/lock.h"
#include "judge/judgement.h"
#include "monitor/supervisor.h"
#include "protocol/in_words.h"

namespace mauve::daemon {

namespace {

constexpr std::array<std::string_view, 4> kLocks = {"none", "params", "topology", "all"};
constexpr const char* kHint = "an administrator ends it: mauvectl lock none";

}  // namespace

std::string_view to_string(Lock lock) { return kLocks.at(static_cast<std::size_t>(lock)); }

Kind kind_of(const Call& call) {
  using protocol::Effect;
  switch (call.method->effect) {
    case Effect::adjusts:
      return Kind::harmless;
    case Effect::stops:
      return Kind::stop;
    case Effect::ends:
      return Kind::ending;
    default:
      return Kind::other;
  }
}

Status may_change(const Running& running, Kind kind) {
  MAUVE_ON_THREAD(control);
  if (kind != Kind::other || running.lock != Lock::all) {
    return ok();
  }
  return refuse(Errc::conflict, "lock",
                "everything that runs is locked: only stop, confirm and undo may change it", kHint);
}

Status may_change(const Running& running, const std::vector<arch::Line>& lines) {
  MAUVE_ON_THREAD(control);
  const bool params = running.lock == Lock::params;
  if (!params && running.lock != Lock::topology) {
    return ok();
  }
  const auto held =
      std::ranges::find_if(lines, params ? arch::changes_a_property : arch::changes_the_topology);
  if (held == lines.end()) {
    return ok();
  }
  return refuse(Errc::conflict, held->address,
                (params ? "params are locked, so no property may be changed; this change has: "
                        : "topology is locked, so only properties may be changed, and components "
                          "started and stopped; this change has: ") +
                    protocol::line_in_words(to_json(*held)),
                kHint);
}

std::string_view held_by(Lock lock, const rules::Steps& steps) {
  using rules::Action;
  const auto is_of = [&](auto matches) {
    return std::ranges::any_of(steps,
                               [&](const rules::Step& step) { return matches(step.action); });
  };
  switch (lock) {
    case Lock::none:
      return {};
    case Lock::all:
      return "everything is locked";
    case Lock::params:
      return is_of([](Action action) { return action == Action::set; }) ? "params are locked" : "";
    case Lock::topology:
      break;
  }
  const bool other = is_of([](Action action) {
    return action != Action::set && action != Action::start && action != Action::stop;
  });
  return other ? "topology is locked" : "";
}

void set_lock(Running& running, const CallPtr& call, Ticket /*none: it waits for no change*/) {
  const auto word = text_or(call->params, "lock");
  const auto* found = std::find(kLocks.begin(), kLocks.end(), word);
  if (found == kLocks.end()) {
    return answer(running, *call,
                  refuse(Errc::invalid_value, "lock", "'" + word.substr(0, 64) + "' is no lock",
                         "none, params, topology or all"));
  }
  if (auto met = check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  const auto lock = static_cast<Lock>(found - kLocks.begin());
  const bool changed = running.lock != lock;
  running.lock = lock;
  answer(running, *call,
         Json{{"lock", word},
              {"changed", changed},
              {"rules_held", running.supervisor.held()},
              {"state", "applied"},
              {"generation", running.generation.load()}});
}

}  // namespace mauve::daemon
