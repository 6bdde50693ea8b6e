// SPDX-License-Identifier: LGPL-3.0-or-later
/// lock.set: freezes the robot against changes, during a mission say. At once, also beside a change
/// that is prepared, which is then refused.
#include <algorithm>
#include <array>

#include "commands/answer.h"
#include "commands/gate.h"
#include "supervisor.h"

namespace mauve::daemon {

namespace {

constexpr std::array<std::string_view, 3> kLocks = {"none", "params", "all"};

}  // namespace

std::string_view to_string(Lock lock) { return kLocks.at(static_cast<std::size_t>(lock)); }

Kind kind_of(const Call& call) {
  if (call.method->harmless) {
    return Kind::harmless;
  }
  const auto method = call.method->name;
  if (method == "component.stop") {
    return Kind::stop;
  }
  if (method == "change.confirm" || method == "change.undo") {
    return Kind::ending;
  }
  const bool sets =
      method == "param.set" || method == "change.apply" || method == "config.rollback" ||
      (method == "core.swap" && (call.params.contains("set") || flag(call.params, "defaults")));
  return sets ? Kind::property : Kind::other;
}

Status may_change(const Running& running, Kind kind) {
  const bool always = kind == Kind::harmless || kind == Kind::stop || kind == Kind::ending;
  const bool free =
      always || running.lock == Lock::none || (running.lock == Lock::params && kind == Kind::other);
  if (free) {
    return ok();
  }
  const bool all = running.lock == Lock::all;
  return refuse(Errc::conflict, "lock",
                all ? "everything that runs is locked: only stop, confirm and undo may change it"
                    : "params are locked: no property may be changed",
                "an administrator ends it: mauvectl lock none");
}

void set_lock(Running& running, const CallPtr& call, Ticket /*none: it waits for no change*/) {
  const auto word = text_or(call->params, "lock");
  const auto* found = std::find(kLocks.begin(), kLocks.end(), word);
  if (found == kLocks.end()) {
    return answer(running, *call,
                  refuse(Errc::invalid_value, "lock", "'" + word.substr(0, 64) + "' is no lock",
                         "none, params or all"));
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
