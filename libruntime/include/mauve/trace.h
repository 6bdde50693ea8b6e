// SPDX-License-Identifier: LGPL-3.0-or-later
/// Tracing: the actions of every real-time thread, with their times. Each thread writes into a ring
/// of its own, wait-free; records that are not collected in time are overwritten and counted. A
/// core adds events of its own:
///
///   mauve::TraceEvent gain{*this, "gain"};
///   ... gain(3.5);
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/detail/data_status.h>
#include <mauve/time.h>

namespace mauve {

class Configurable;

/// How much is traced, in this process.
enum class TraceMode : std::uint8_t {
  off,
  jobs,    ///< jobs, states, locks, faults, changes, user events
  detail,  ///< also every use of a port, and locks that are only held for some stores
};

/// From the next event on. [any]
void set_trace_mode(TraceMode mode);
[[nodiscard]] TraceMode trace_mode();  ///< [any]

/// The kind of an event. The page daemon/protocol/README.md explains the name and the numbers of a
/// record.
enum class TraceKind : std::uint8_t {
  release,
  begin,
  end,
  wait,
  lock,
  unlock,
  timeout,
  call,
  user,
  overrun,
  budget,
  missed,
  fault,
  started,
  stopped,
  applied,
  given_back,
  prepare,
  commit,
  abort,
  rollback,
  member,
  set,
  disturbed,
  lost,
};
[[nodiscard]] std::string_view to_string(TraceKind kind);  ///< "release", "begin", ...

/// One record, as it is collected. Names are numbers, see trace_name().
struct TraceRecord {
  Instant time = 0;                  ///< since T0
  TraceKind kind = TraceKind::lost;  ///< the kind of event
  std::uint32_t thread = 0;          ///< the number of the thread
  std::uint32_t name = 0;            ///< 0: none
  std::int64_t a = 0;                ///< see the table of the kind
  std::int64_t b = 0;                ///< of `user` the bits of a double
};

/// The number of a name, the same for equal names, for the life of the process; 0 when there are
/// too many. Takes a lock and memory: never on a real-time thread.
[[nodiscard]] std::uint32_t trace_name_id(std::string_view name);
/// The name with this number; empty for 0 and for a number without a name. Stays valid. [any but
/// rt]
[[nodiscard]] std::string_view trace_name(std::uint32_t id);

/// A component that a trace refers to, as it is now.
struct TracedComponent {
  /// One state of its machine.
  struct State {
    std::string name;    ///< of the state
    bool waits = false;  ///< a synchronization state
    Duration wait{0};    ///< how long it waits
  };
  std::string name;           ///< of the component
  std::string type;           ///< "plugin/name"
  std::string core;           ///< "plugin/name"
  std::uint64_t change = 0;   ///< the number of the change that made it so; 0: as it was deployed
  int priority = 0;           ///< SCHED_FIFO
  std::vector<int> cpus;      ///< empty: any
  Instant scheduled = 0;      ///< since T0: from then on it has this priority and these CPUs
  Instant timed = 0;          ///< since T0: from then on it has this core, period and budget
  bool realtime = false;      ///< the system really runs it so
  Duration period{0};         ///< of its grid
  Duration offset{0};         ///< as declared
  Duration deadline{0};       ///< as declared
  Duration budget{0};         ///< as declared
  Duration bound{0};          ///< on its response times; zero: none was found
  bool measured = false;      ///< the bound rests on measured execution times
  std::vector<State> states;  ///< in the order of declaration
  std::string initial;        ///< the first state
};
/// The system that a trace refers to.
struct TracedSystem {
  std::string architecture;                 ///< name
  Instant t0 = 0;                           ///< monotonic
  std::vector<TracedComponent> components;  ///< all
  std::vector<std::string> resources;       ///< names
};

namespace detail {

extern std::atomic<TraceMode> trace_mode;
[[nodiscard]] inline bool traces(TraceMode mode) {
  return trace_mode.load(std::memory_order_relaxed) >= mode;
}
void trace_user(std::uint32_t name, double value);
[[nodiscard]] Instant trace_time();
void trace_call(std::uint32_t port, Instant began, DataStatus status);

}  // namespace detail

/// An event of a core's own, with a number, in the trace of its thread. Declared as a member.
/// Outside a job it does nothing.
/// @snippet api_examples.cpp TraceEvent
class TraceEvent {
 public:
  /// Takes the number of the name, a literal or not. [factory]
  TraceEvent(Configurable& /*owner*/, std::string_view name) : name_(trace_name_id(name)) {}
  TraceEvent(const TraceEvent&) = delete;
  TraceEvent& operator=(const TraceEvent&) = delete;

  /// [rt] Wait-free.
  void operator()(double value = 0) const {
    if (detail::traces(TraceMode::jobs)) detail::trace_user(name_, value);
  }

 private:
  std::uint32_t name_;
};

/// Runtime only: one use of a port.
class TracedCall {
 public:
  /// It begins.
  explicit TracedCall(std::uint32_t port)
      : port_(port), began_(detail::traces(TraceMode::detail) ? detail::trace_time() : 0) {}
  /// Records the end of the call, with the status that it returned.
  DataStatus ended(DataStatus status) const {
    if (began_ != 0) detail::trace_call(port_, began_, status);
    return status;
  }
  /// The same for a call that only succeeds or fails.
  bool ended(bool done) const {
    ended(done ? DataStatus::new_data : DataStatus::no_data);
    return done;
  }

 private:
  std::uint32_t port_;
  Instant began_;
};

}  // namespace mauve
