// SPDX-License-Identifier: LGPL-3.0-or-later
/// What the machine itself takes from real-time threads: measured, since it differs by a factor of
/// ten between a virtual machine and bare metal.
#pragma once

#include <optional>
#include <vector>

#include <mauve/time.h>

namespace mauve::rt {

struct MachineCosts {
  Duration wake{0};        ///< from the instant of a timer until the thread that waits for it runs
  Duration activation{0};  ///< the switches to another thread and back
  Duration interrupt{0};   ///< of a timer
  Duration kernel{0};      ///< what the kernel takes in each `window`, its ticks above all
  static constexpr Duration window = 4ms;
};

/// The largest on any of these CPUs, each measured for some 30 ms at this SCHED_FIFO priority. A
/// few outliers are left out: that somebody else's machine stood in the way says nothing about the
/// next time. None when the process may not use SCHED_FIFO. [control], before components run
[[nodiscard]] std::optional<MachineCosts> measure_machine(const std::vector<int>& cpus,
                                                          int priority);

}  // namespace mauve::rt
