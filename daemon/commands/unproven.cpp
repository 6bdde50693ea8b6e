// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/unproven.h"

#include <algorithm>
#include <utility>

#include "keeper.h"

namespace mauve::daemon {

void begin_unproven(Running& running, Call& call, const Change& change) {
  call.mark = Mark::unconfirmed;
  running.unproven = {running.earlier + running.deployer.generation(),
                      std::chrono::steady_clock::now()};
  for (const auto& edit : change.edits) {
    running.unproven.components.push_back(edit.component);
  }
}

void look_at_unproven(Running& running) {
  const auto& unproven = running.unproven;
  if (unproven.generation == 0) {
    return;
  }
  const bool failed =
      std::any_of(unproven.components.begin(), unproven.components.end(), [&](const auto& name) {
        return running.deployer.status(name).state == ComponentState::faulted;
      });
  if (failed || unproven.generation != running.generation) {
    running.unproven = {};
  } else if (std::chrono::steady_clock::now() - unproven.since >= Probation{}.time) {
    static_cast<void>(confirm_unproven(running));
  }
}

bool confirm_unproven(Running& running) {
  const auto generation = std::exchange(running.unproven, {}).generation;
  if (generation == 0 || generation != running.generation) {
    return false;
  }
  if (running.keeper != nullptr) {
    running.keeper->mark(generation, Mark::confirmed);
  }
  return true;
}

}  // namespace mauve::daemon
