// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/deploy/shutdown.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "exec/deploy/stop.h"
#include "model/job/keep_for_abandoned.h"

namespace mauve::exec {
namespace {

/// A healthy component gets this long to end its job, and its thread to end, however late it is.
constexpr Duration kShortestPatience = 100ms;

}  // namespace

std::vector<std::string> bring_down(System& system, Duration bound) {
  std::vector<std::string> abandoned;
  if (!system.up) return abandoned;
  system.up = false;
  const Instant deadline = system.runner->now() + bound.count();
  Stop stop(system, in_order_of_safe_values(system), patience_within(bound));
  // Ends by itself: every step of it is bounded.
  static_cast<void>(system.runner->await([&] { return stop.advance(); }, kNever));
  for (Deployed& deployed : system.deployed) {
    const bool stuck = stop.hung().count(&deployed) != 0;
    const Instant now = system.runner->now();
    const Instant until = stuck ? now : std::max(deadline, now + kShortestPatience.count());
    const bool ended = system.runner->end(*deployed.task, until);
    deployed.ended = ended && !system.runner->has_abandoned(deployed.task.get());
    if (deployed.ended) continue;
    abandoned.push_back(deployed.component->name());
    deployed.component->abandon();
    keep_for_abandoned(deployed.task);  // its thread still runs in it
    keep_for_abandoned(system.runner);
  }
  if (system.runner->has_abandoned()) {
    keep_for_abandoned(std::make_shared<Retired>(std::exchange(system.retired, {})));
  }
  system.crash_handler.reset();
  return abandoned;
}

Duration patience_within(Duration bound) { return std::max(bound / 4, kShortestPatience); }

}  // namespace mauve::exec
