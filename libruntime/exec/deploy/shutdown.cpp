// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/deploy/shutdown.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "exec/commit/under_way.h"
#include "exec/deploy/stop.h"
#include "model/job/keep_for_abandoned.h"

namespace mauve::exec {
namespace {

/// A healthy component gets this long to end its job, and its thread to end, however late it is.
constexpr Duration kShortestPatience = 100ms;

}  // namespace

std::vector<std::string> bring_down(System& system, Duration bound, Duration ordinary) {
  std::vector<std::string> abandoned;
  if (!system.up) return abandoned;
  system.up = false;
  const Instant deadline = system.runner->now() + bound.count();
  const Instant ordinary_deadline = deadline + ordinary.count();
  Stop stop(system, in_order_of_safe_values(system), patience_within(bound));
  // Ends by itself: every step of it is bounded.
  static_cast<void>(system.runner->await([&] { return stop.advance(); }, kNever));
  const auto is_stuck = [&](const Deployed& one) {
    return stop.hung().count(&one) != 0 && one.state() == ComponentState::running;
  };
  // The machine may keep an ordinary thread from its processor. When the thread runs, it parks and
  // writes its safe values, which were written on its behalf before.
  if (ordinary > Duration{0}) {
    const auto all_park = [&] {
      advance(system);
      return std::none_of(system.deployed.begin(), system.deployed.end(),
                          [&](const Deployed& one) { return !one.realtime && is_stuck(one); });
    };
    static_cast<void>(system.runner->await(all_park, ordinary_deadline));
  }
  for (Deployed& deployed : system.deployed) {
    const Instant now = system.runner->now();
    const Instant limit = deployed.realtime ? deadline : ordinary_deadline;
    const Instant until =
        is_stuck(deployed) ? now : std::max(limit, now + kShortestPatience.count());
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
