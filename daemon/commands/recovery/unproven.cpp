// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/recovery/unproven.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include "mauve/host/architecture.h"
#include "state/recovery.h"
#include "state/state_store.h"

namespace mauve::daemon {

void begin_unproven(Running& running, Call& call, std::vector<FailureMark> changed) {
  MAUVE_ON_THREAD(control);
  call.mark = Confirmation::unconfirmed;
  running.unproven = {running.deployer.generation(), std::chrono::steady_clock::now(),
                      std::move(changed)};
}

void begin_start(Running& running, std::uint64_t replaces, unsigned crashes) {
  const auto now = std::chrono::steady_clock::now();
  running.started = {running.generation, now, crashes};
  running.unproven = {running.generation, now, {}, replaces};
  for (const auto* component : running.architecture.components()) {
    running.unproven.changed.push_back({component->name()});
  }
}

namespace {

/// A user who changed something and went back before the start was confirmed runs the start again.
void look_at_start(Running& running) {
  auto& started = running.started;
  const auto ran = std::chrono::steady_clock::now() - started.since;
  if (started.generation == 0) {
    return;
  }
  if (started.proves && ran >= Probation{}.time) {
    started.proves = false;
    if (started.generation != running.generation) {
      running.store->confirm_same(started.generation, running.generation);
    }
  }
  if (!started.long_ago && ran >= kSoon) {
    started.long_ago = true;
    running.store->ran_long();
    if (started.crashes > 0) {
      running.store->forget_crashes(started.generation);
    }
  }
}

}  // namespace

void look_at_unproven(Running& running) {
  MAUVE_ON_THREAD(control);
  look_at_start(running);
  const auto& unproven = running.unproven;
  if (unproven.generation == 0) {
    return;
  }
  const bool failed = std::ranges::any_of(
      unproven.changed, [&](const auto& mark) { return failure_since(running, mark).has_value(); });
  if (failed && unproven.since == running.started.since) {
    running.started.proves = false;
  }
  if (failed) {
    running.unproven = {};
  } else if (unproven.generation == running.generation && !running.deployer.on_probation() &&
             std::chrono::steady_clock::now() - unproven.since >= Probation{}.time) {
    static_cast<void>(confirm_unproven(running));
  }
}

void carry_unproven(Running& running, std::uint64_t generation) {
  MAUVE_ON_THREAD(control);
  const auto unproven = running.unproven.generation;
  const bool only_stopped = unproven >= running.deployer.generation(/*before_stops=*/true);
  if (unproven != 0 && (unproven + 1 == generation || only_stopped)) {
    running.unproven.generation = generation;
    running.unproven.replaces = 0;  // the copy is of another architecture
  }
}

bool confirm_unproven(Running& running) {
  MAUVE_ON_THREAD(control);
  const auto unproven = std::exchange(running.unproven, {});
  if (unproven.generation == 0 || unproven.generation != running.generation) {
    return false;
  }
  if (running.store != nullptr) {
    running.store->confirm_start(unproven.generation, unproven.replaces);
  }
  return true;
}

}  // namespace mauve::daemon
