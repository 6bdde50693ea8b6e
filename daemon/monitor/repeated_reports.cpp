// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/repeated_reports.h"

#include <chrono>

#include "base/duration.h"
#include "commands/command.h"
#include "mauve/detail/port_base.h"
#include "mauve/host/architecture.h"
#include "mauve/host/resource.h"
#include "mauve/shell.h"

namespace mauve::daemon {

void RepeatedReports::report_locks(Running& running) {
  for (const auto* resource : running.architecture.resources()) {
    const auto& lock = resource->lock();
    const auto count = lock.over_budget();
    if (!held_too_long_.reached(resource->name(), count)) {
      continue;
    }
    const auto held = std::chrono::ceil<std::chrono::microseconds>(lock.longest_held());
    running.log.write(logging::Event::lock_budget_exceeded,
                      {{"resource", resource->name()},
                       {"held", format_duration(held)},
                       {"lock_budget", format_duration(lock.budget())},
                       {"count", static_cast<std::int64_t>(count)}});
  }
}

void RepeatedReports::report_components(Running& running) {
  for (const auto& one : running.deployer.status()) {
    const auto over = one.over_present_budget;
    if (over_budget_.reached(one.name, over)) {
      const auto used = std::chrono::ceil<std::chrono::microseconds>(one.used_max);
      running.log.write(logging::Event::budget_exceeded,
                        {{"component", one.name},
                         {"used", format_duration(used)},
                         {"budget", format_duration(one.budget)},
                         {"count", static_cast<std::int64_t>(over)}});
    }
    if (restored_.reached(one.name, one.restored)) {
      running.log.write(
          logging::Event::scheduling_restored,
          {{"component", one.name}, {"count", static_cast<std::int64_t>(one.restored)}});
    }
  }
  for (const auto* component : running.architecture.components()) {
    report_ports(running, component->name(), component->shell());
  }
  for (const auto* resource : running.architecture.resources()) {
    report_ports(running, {}, resource->shell());
  }
}

/// Of a resource without `component`. Values of cores before are the epoch of the present core.
void RepeatedReports::report_ports(Running& running, const std::string& component,
                                   const Shell& shell) {
  for (const auto* port : shell.ports()) {
    const auto [ever, count] = port->implausible();
    const auto address = port->address();
    if (implausible_.reached(address, count, ever - count)) {
      running.log.write(logging::Event::implausible_value,
                        {{"component", component},
                         {"port", component.empty() ? address : std::string(port->name())},
                         {"count", static_cast<std::int64_t>(count)}});
    }
  }
}

}  // namespace mauve::daemon
