// SPDX-License-Identifier: LGPL-3.0-or-later
/// Measures the costs of the machine that a proof assumes: they differ by a factor of ten between a
/// virtual machine and bare metal.
#pragma once

#include <optional>
#include <vector>

#include <mauve/host/machine.h>

namespace mauve::rt {

/// The largest costs on any of these CPUs, with a margin of two, each measured for some 300 ms by
/// threads of this SCHED_FIFO priority. They use a tenth of the CPU, 200 us at a time, and once
/// about 1 ms. A few outliers are left out. None when the process may not use SCHED_FIFO. [any]
[[nodiscard]] std::optional<MachineCosts> measure_machine(const std::vector<int>& cpus,
                                                          int priority);

}  // namespace mauve::rt
