// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/task_report.h"

#include <utility>

#include "rt/process/cache.h"

#include <mauve/host/component.h>

namespace mauve::exec {

TaskReport::TaskReport(std::string name, const Clock& clock, const Clock* simulated)
    : name_(std::move(name)),
      trace_name_(trace_name_id(name_)),
      clock_(clock),
      simulated_(simulated),
      trace_(new Trace{rt::TraceRing(simulated), nullptr}) {}

TaskReport::~TaskReport() { delete trace_.load(); }

void TaskReport::note(rt::EventKind kind, LogLevel level, std::int64_t a, std::int64_t b) {
  events_.push({clock_.now(), kind, level, nullptr, LogArgument(a), LogArgument(b), {}});
}

MAUVE_RUNS_AT_A_SWAP void TaskReport::record(TraceKind kind, Instant time, std::int64_t value,
                                             std::uint64_t small, std::uint32_t name) {
  if (!detail::traces(TraceMode::jobs)) return;
  trace_.load(std::memory_order_relaxed)->ring.push(kind, time, name, small, value);
}

void TaskReport::begin_new_trace() {
  trace_ = new Trace{rt::TraceRing(simulated_), std::unique_ptr<Trace>(trace_.load())};
}

}  // namespace mauve::exec
