// SPDX-License-Identifier: LGPL-3.0-or-later
/// TaskReport: the reports of a task about itself while it runs: counters, log events, requests of
/// its jobs, trace records and the record of its last fault. One thread writes; no record waits.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "exec/task/counters.h"
#include "exec/update/fault_record.h"
#include "rt/ring/event_ring.h"
#include "rt/ring/request_ring.h"
#include "rt/ring/trace_ring.h"

#include <mauve/host/clock.h>
#include <mauve/log.h>
#include <mauve/trace.h>

namespace mauve::exec {

class TaskReport {
 public:
  /// The ring of the task's thread; behind it, by `older`, those of threads that it lost.
  struct Trace {
    rt::TraceRing ring;
    const std::unique_ptr<Trace> older;
  };

  /// `simulated`: the clock of a simulation; null: the time is that of the machine.
  TaskReport(std::string name, const Clock& clock, const Clock* simulated);
  ~TaskReport();
  TaskReport(const TaskReport&) = delete;
  TaskReport& operator=(const TaskReport&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint32_t trace_name() const { return trace_name_; }
  [[nodiscard]] Counters& counters() { return counters_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] FaultRecord& fault() { return fault_; }
  [[nodiscard]] const FaultRecord& fault() const { return fault_; }  ///< valid while faulted
  [[nodiscard]] rt::EventRing& events() { return events_; }
  [[nodiscard]] rt::RequestRing& requests() { return requests_; }
  [[nodiscard]] Trace& trace() const { return *trace_.load(std::memory_order_acquire); }  ///< [any]

  /// [rt] One line of the log.
  void note(rt::EventKind kind, LogLevel level, std::int64_t a = 0, std::int64_t b = 0);
  /// [rt] One record of the trace, while jobs are traced.
  void record(TraceKind kind, Instant time, std::int64_t value, std::uint64_t small = 0,
              std::uint32_t name = 0);
  /// [guard] The next thread writes into a ring of its own: the abandoned one may be about to
  /// write.
  void begin_new_trace();

 private:
  const std::string name_;
  const std::uint32_t trace_name_;
  const Clock& clock_;
  const Clock* const simulated_;
  Counters counters_;
  FaultRecord fault_;
  rt::EventRing events_;
  rt::RequestRing requests_;
  std::atomic<Trace*> trace_;
};

}  // namespace mauve::exec
