// SPDX-License-Identifier: LGPL-3.0-or-later
/// TaskSet: the input of the analysis about a system.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/graph.h"

namespace mauve::analysis {

/// The costs of the machine, as the analysis takes them; mauve/host/machine.h has the values that a
/// deployer assumes.
struct Overheads {
  Duration wake{60us};       ///< lambda: from a timer's instant until the thread could run
  Duration activation{3us};  ///< c_act: the switches to a job and back
  Duration interrupt{15us};  ///< c_irq: a timer's interrupt; one for all jobs released together
  Duration tick{30us};       ///< c_tick: the time of the kernel at each of its ticks
  Duration tick_period{4ms};
  Duration change{5us};  ///< the time that taking a change adds to the first job with it
};

/// All of 0: for the examples of textbooks.
[[nodiscard]] constexpr Overheads no_overheads() { return {0us, 0us, 0us, 0us, 4ms, 0us}; }

/// How long a job holds a resource under its priority-inheritance lock, nested ones included.
/// Part of the execution times. Wait-free resources are not listed.
struct Section {
  std::string resource;
  Duration length{0};
  Source source = Source::declared;  ///< unknown: the whole job counts

  bool operator==(const Section&) const = default;
};

/// When a task is there while a change is admitted.
enum class Presence : std::uint8_t { always, before, after };

struct Task {
  std::string name;
  std::optional<int> cpu;  ///< none: it floats, which cannot be proved
  int priority = 0;        ///< SCHED_FIFO: larger is more urgent
  Duration offset{0};      ///< of all its releases after T0
  Duration jitter{0};      ///< its jobs may begin as much later than their releases
  Graph graph;
  std::vector<Section> sections;
  std::uint64_t version = 0;  ///< another number: admit() takes it for changed
  Presence presence = Presence::always;
};

struct TaskSet {
  std::vector<Task> tasks;  ///< names differ
  Overheads overheads;
};

}  // namespace mauve::analysis
