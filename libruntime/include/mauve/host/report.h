// SPDX-License-Identifier: LGPL-3.0-or-later
/// Reports of a deployer: the state of its components, runtime events, and its own actions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/log.h>
#include <mauve/time.h>

namespace mauve {

/// Whether a component runs jobs.
enum class ComponentState : std::uint8_t {
  not_configured,  ///< no hook has run yet
  stopped,         ///< parked, its safe values are written
  running,         ///< runs a job at each release
  faulted,         ///< its core failed; it stays parked until it is started or changed
  recovering,      ///< its core failed, its outputs are safe; another core takes over by itself
};
[[nodiscard]] std::string_view to_string(ComponentState state);  ///< "stopped", ...

/// How a component recovers whose core failed.
struct Recovery {
  /// The next step.
  enum class Way : std::uint8_t {
    none,      ///< it stays as it is
    restart,   ///< with a fresh core, as soon as that stands by and the back-off has passed
    fallback,  ///< with its fallback core, as soon as that stands by
    rollback,  ///< the change on probation is rolled back
  };
  Way way = Way::none;            ///< the next step
  std::size_t restarts_left = 0;  ///< of a restart: this one and those after it, within its window
  Duration in{0};                 ///< of a restart: the rest of the back-off
};
[[nodiscard]] std::string_view to_string(Recovery::Way way);  ///< "restart", ...

/// A failure of a component: the thread of the component recorded all of it when it happened.
struct Incident {
  Instant time = 0;       ///< monotonic
  std::string cause;      ///< "threw", "crashed", "hung", ...
  std::string text;       ///< of the exception, or the like
  std::string core;       ///< the core that failed
  std::string state;      ///< of the state machine; empty: not known
  std::uint64_t job = 0;  ///< the number of the job, counted since the component began
  std::string resource;  ///< in whose call it failed, so that the core is not to blame; empty: none
};
/// "threw: sensor lost", "threw: out of range, in a call of meter".
[[nodiscard]] std::string to_string(const Incident& incident);

/// A look at one component; numbers may be some jobs apart.
struct ComponentStatus {
  std::string name;                                       ///< in the architecture
  std::string type;                                       ///< "plugin/name"
  std::string core;                                       ///< in force, "plugin/name"
  std::string fsm_state;                                  ///< now or last
  ComponentState state = ComponentState::not_configured;  ///< see there
  int priority = 0;                                       ///< as declared
  std::vector<int> cpus;                                  ///< as placed
  bool realtime = false;          ///< the system really runs it with SCHED_FIFO
  std::uint64_t releases = 0;     ///< jobs that ran
  std::uint64_t missed = 0;       ///< releases for which no job ran, also those that pass now
  std::uint64_t overruns = 0;     ///< jobs that ended after their wait or deadline
  std::uint64_t faults = 0;       ///< jobs that threw, crashed or hung
  std::uint64_t over_budget = 0;  ///< jobs whose processor time exceeds the declared budget
  std::uint64_t over_present_budget = 0;  ///< of these: with the present core and budget
  Duration lateness_max{0};               ///< of job starts
  Duration lateness_last{0};              ///< of the last job
  Duration elapsed_max{0};                ///< of jobs, from start to end, with preemption
  Duration elapsed_last{0};               ///< of the last job
  Duration used_max{0};      ///< the most processor time of a job; 0: none was measured
  Duration budget{0};        ///< as declared; 0: none
  Duration next_release{0};  ///< since T0
  Duration period{0};        ///< the grid that its releases lie on
  Duration watchdog{0};      ///< a job that runs longer is interrupted, or its thread is abandoned
  bool changing = false;     ///< a change, or an order to stop, waits for the end of its job
  bool stopping = false;     ///< of these it is an order to stop
  bool ran_until_end = false;  ///< Deployer::shutdown() found it running, and stops it
  /// How long ago the job under way should have ended, once that is more than its longest wait;
  /// else zero. A core that hangs is running and late.
  Duration late{0};
  std::string fault;                 ///< text of the last failure, when faulted or recovering
  std::optional<Incident> incident;  ///< when faulted or recovering
  Recovery recovery;                 ///< when recovering
  /// How often its code had changed its priority or CPUs, and the guard put that back.
  std::uint64_t restored = 0;
  /// Values that its ports did not let out, as they were not plausible.
  std::uint64_t implausible = 0;
  std::uint64_t implausible_of_core = 0;  ///< of these: since it runs the code of its present core
};

/// Something that happened on a real-time thread, as reported to the [log] thread.
struct RuntimeEvent {
  Instant time = 0;                 ///< monotonic
  LogLevel level = LogLevel::info;  ///< of the line in the log
  std::string component;            ///< empty: none
  std::string event;                ///< "swapped", "overrun", "missed", "faulted", "log", ...
  std::string text;                 ///< formatted for people
  /// Of an overrun: the job took longer than its budget or its wait while the machine ran.
  bool long_job = false;
};

/// An action of the system by itself: a probation that is over, or a core that took over from one
/// that failed.
struct Outcome {
  /// The kinds of outcomes.
  enum class Kind : std::uint8_t {
    passed,        ///< the change on probation stays
    overtaken,     ///< so it does: a newer change ended its probation early
    rolled_back,   ///< all its members are as they were before
    fell_back,     ///< the fallback core took over
    restarted,     ///< a fresh core took over
    stays_failed,  ///< no other core takes over from one that failed: its component is faulted
  };
  Kind kind = Kind::passed;      ///< which of them
  std::uint64_t began = 0;       ///< generation it happened to; of a probation: its first change
  std::uint64_t generation = 0;  ///< in force now
  std::string component;         ///< the one at fault; empty: none
  std::string reason;            ///< "threw: sensor lost", "confirmed", "3000 jobs without a fault"
  /// The failure that led to it; none: it was requested, or nothing failed.
  std::optional<Incident> incident = {};
  Duration commit{0};  ///< of a rollback, since T0
  /// The core that was new and at fault in a rollback, if any; the one that took over.
  std::vector<std::string> cores;
  /// Of a probation: the generations that its changes made, the oldest first. There are several
  /// when newer changes of the same components joined it.
  std::vector<std::uint64_t> generations = {};
  /// Of a probation: the first change of the oldest other one that is open; 0: there is no other,
  /// so that all that runs has proved itself.
  std::uint64_t oldest_open = 0;
};
[[nodiscard]] std::string_view to_string(Outcome::Kind kind);  ///< "passed", ...

}  // namespace mauve
