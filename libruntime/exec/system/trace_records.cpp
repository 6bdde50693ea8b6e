// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system/trace_records.h"

#include "base/thread_role.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/mutex.h"
#include "exec/system/system.h"
#include "rt/time/ticks.h"

#include <mauve/host/component.h>

namespace mauve::exec {
namespace {

std::uint32_t name_of(AppliedAs as) {
  constexpr std::array<std::string_view, 4> kWords{"change", "back", "standby", "barrier"};
  return trace_name_id(kWords.at(static_cast<std::size_t>(as)));
}

TraceRecord record_of(const rt::TraceEntry& entry, std::uint32_t thread, Instant t0) {
  TraceRecord record{entry.time - t0, entry.kind, thread, entry.name, entry.value, entry.small};
  switch (entry.kind) {
    case TraceKind::end:
    case TraceKind::call:
    case TraceKind::user:
      std::swap(record.a, record.b);
      break;
    case TraceKind::fault:
      record.name = trace_name_id(word_of(static_cast<Cause>(entry.name)));
      break;
    case TraceKind::missed:
      record.name = trace_name_id(entry.name != 0 ? "planned" : "");
      break;
    case TraceKind::applied:
      record.name = name_of(static_cast<AppliedAs>(entry.name));
      break;
    default:
      break;
  }
  return record;
}

/// The rings of abandoned threads come first: their records are older.
void drain_ring(TaskReport::Trace& trace, std::uint32_t thread, Instant t0,
                std::vector<TraceRecord>& all) {
  if (trace.older != nullptr) drain_ring(*trace.older, thread, t0, all);
  std::int64_t lost = 0;
  const auto visit = [&](const rt::TraceEntry& entry) {
    const TraceRecord record = record_of(entry, thread, t0);
    if (const std::int64_t gap = std::exchange(lost, 0); gap != 0) {
      all.push_back({record.time, TraceKind::lost, thread, 0, gap, 0});
    }
    all.push_back(record);
  };
  trace.ring.drain(visit, [&](std::uint64_t count) { lost += static_cast<std::int64_t>(count); });
  if (lost == 0) return;
  const Instant time = all.empty() ? 0 : all.back().time;
  all.push_back({time, TraceKind::lost, thread, 0, lost, 0});
}

}  // namespace

void keep_last_trace(System& system, Deployed& deployed) {
  MAUVE_ON_THREAD(control);
  constexpr std::size_t kMost = 16'384;  // when no reader collects
  const MutexLock lock(system.members);
  if (system.last_trace.size() >= kMost) return;
  Task& task = *deployed.task;
  drain_ring(task.report().trace(), task.report().trace_name(), system.t0, system.last_trace);
}

std::size_t drain_trace(System& system, const std::function<void(const TraceRecord&)>& visit) {
  MAUVE_ON_THREAD(trace);
  rt::tie_ticks();
  std::vector<TraceRecord> all = system.control_trace.take();
  {
    const MutexLock lock(system.members);
    all.insert(all.end(), system.last_trace.begin(), system.last_trace.end());
    system.last_trace.clear();
    for (Deployed& deployed : system.deployed) {
      if (deployed.task == nullptr) continue;
      drain_ring(deployed.task->report().trace(), deployed.task->report().trace_name(), system.t0,
                 all);
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const TraceRecord& a, const TraceRecord& b) { return a.time < b.time; });
  for (const TraceRecord& record : all) visit(record);
  return all.size();
}

}  // namespace mauve::exec
