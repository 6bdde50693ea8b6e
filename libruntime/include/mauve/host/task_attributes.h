// SPDX-License-Identifier: LGPL-3.0-or-later
/// TaskAttributes: how the thread of a component is scheduled, and the reactions when it is late or
/// its core fails.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <mauve/time.h>

namespace mauve {

/// The treatment of releases that a component could not serve in time.
enum class OnOverrun : std::uint8_t {
  catch_up,  ///< run a job for every late release, back to back (paper Fig. 9)
  skip,      ///< run a job for the newest late release at once, miss the older ones
  stop,      ///< stop the component after `overrun_limit` overruns
  fallback,  ///< go on with the fallback core after `overrun_limit` overruns
};
[[nodiscard]] std::string_view to_string(OnOverrun value);  ///< "skip", ...

/// The treatment of a component whose core threw, crashed or did not return.
struct FaultPolicy {
  /// The reaction to a fault.
  enum class Action : std::uint8_t {
    stop,      ///< park as faulted
    restart,   ///< begin again with a fresh core, `restarts` times within `per`, then stop
    fallback,  ///< go on with the fallback core at the next release
  };
  Action action = Action::stop;  ///< the reaction
  unsigned restarts = 3;         ///< at most, within `per`
  Duration per{60s};             ///< see restarts
  Duration back_off{100ms};      ///< before the first restart; twice as long before each next one

  friend bool operator==(const FaultPolicy&, const FaultPolicy&) = default;  ///< all alike
};
[[nodiscard]] std::string_view to_string(FaultPolicy::Action value);  ///< "stop", ...

/// How a component's thread is scheduled.
struct TaskAttributes {
  int priority = 10;                       ///< SCHED_FIFO priority, 1 to 90
  std::vector<int> cpus;                   ///< empty: the deployer chooses one and reports it
  Duration offset{0};                      ///< phase of all releases on the common clock
  Duration deadline{0};                    ///< after the release; zero: the end of the current wait
  Duration budget{0};                      ///< execution time of one job; zero: not declared
  std::size_t stack = 64 * 1024;           ///< bytes, touched and locked at start
  OnOverrun on_overrun = OnOverrun::skip;  ///< see there
  /// For OnOverrun::stop and fallback: so many of the last 64 jobs; counted anew after a start and
  /// after a change of the component. 1 to 64.
  unsigned overrun_limit = 1;
  FaultPolicy on_fault;  ///< see there
  /// A job that runs longer is treated as one that never returns: it is interrupted, or its thread
  /// is abandoned (see on_fault). Zero: five budgets, else five times the longest wait, at least 75
  /// ms and at most 400 ms (two budgets, or a wait of up to 800 ms). So a job that loops ends
  /// before the kernel throttles all real-time threads of its CPU.
  Duration watchdog{0};
  bool start = true;  ///< false: parked after deployment

  /// All alike.
  friend bool operator==(const TaskAttributes&, const TaskAttributes&) = default;
};

}  // namespace mauve
