// SPDX-License-Identifier: LGPL-3.0-or-later
/// The machine below the components: the costs that a proof of deadlines assumes, and the lateness
/// that probes measure while the components run.
#pragma once

#include <vector>

#include <mauve/host/statistics.h>
#include <mauve/time.h>

namespace mauve {

/// Time that kernel and host take from real-time threads. A proof holds for a machine that takes no
/// more. The values are declared, not measured at start: the same file is then admitted or refused
/// alike at every start and by `mauved --check`. The defaults are those of a slow virtual machine:
/// 99 % of its wake-ups and 90 % of its windows take less.
struct MachineCosts {
  Duration wake{120us};      ///< from the instant of a timer until its thread could run
  Duration activation{3us};  ///< the switches to a thread and back
  Duration interrupt{15us};  ///< one timer interrupt; threads released together share it
  Duration kernel{140us};    ///< ticks of kernel and host, and mauve's probe, in each `window`
  static constexpr Duration window = 4ms;  ///< see `kernel`

  bool operator==(const MachineCosts&) const = default;  ///< of all costs
};

/// Wake-ups of the probe of one CPU: a thread above all components that wakes up 250 times a
/// second.
struct WakeNoise {
  int cpu = 0;               ///< its number
  Duration span{0};          ///< how far the distribution reaches back: the last one to two minutes
  Distribution late;         ///< from the instant asked for until the probe ran
  std::uint64_t beyond = 0;  ///< wake-ups of `late` that were later than MachineCosts::wake
  Duration worst{0};         ///< of all wake-ups since the probe began
  Duration worst_ago{0};     ///< the age of the worst one
};

}  // namespace mauve
