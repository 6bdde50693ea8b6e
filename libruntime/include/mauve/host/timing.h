// SPDX-License-Identifier: LGPL-3.0-or-later
/// Timing: whether every job meets its deadline, as the analysis of response times sees it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <mauve/host/machine.h>
#include <mauve/time.h>

namespace mauve {

/// The job of a component that has the least time left.
struct ComponentTiming {
  std::string name;                  ///< of the component
  std::optional<int> cpu;            ///< none: it may run on several, which cannot be proved
  int priority = 0;                  ///< SCHED_FIFO
  Duration execution{0};             ///< of the job
  std::string source;                ///< of the execution time: "declared", "measured" or "unknown"
  Duration blocking{0};              ///< by less urgent ones
  Duration deadline{0};              ///< after the release
  std::optional<Duration> response;  ///< none: no bound was found
  std::optional<Duration> slack;     ///< deadline - response
  std::string problem;               ///< with a remedy; empty: it meets its deadline
};

/// How long one call keeps the lock of a resource.
struct LockTiming {
  std::string resource;                 ///< its name
  std::optional<Duration> lock_budget;  ///< none: not known, so the whole job of a user counts
  std::string source;                   ///< "declared", "measured" or "unknown"
};

/// The load of one CPU.
struct CpuTiming {
  int cpu = 0;              ///< its number
  double load = 0;          ///< long-term share that its components and its kernel may ask for
  bool overloaded = false;  ///< no bound exists
};

/// The answer of Deployer::analyze().
struct Timing {
  std::vector<ComponentTiming> components;  ///< by CPU, then highest priority first
  std::vector<CpuTiming> cpus;              ///< those that are used
  std::vector<LockTiming> locks;            ///< by name, of resources that are used
  /// The largest factor on all execution times with which every deadline is still met; 0: not even
  /// as they are. None: an execution time is not known.
  std::optional<double> factor;
  std::vector<std::string> problems;  ///< all, also of CPUs and locks
  /// Measurements of the code that runs which contradict the proof: longer jobs and locks than
  /// declared, and missed releases.
  std::vector<std::string> contradictions = {};
  std::vector<std::string> notes;  ///< times not counted, and the costs of the machine
  MachineCosts machine;            ///< the costs of the machine that all this assumes
  std::vector<WakeNoise> noise;    ///< wake-ups of its probes; empty: there are none
};

}  // namespace mauve
