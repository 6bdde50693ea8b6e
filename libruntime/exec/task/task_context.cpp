// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/task_context.h"

#include <cstddef>
#include <utility>

#include "exec/update/task_update.h"
#include "rt/process/cache.h"

#include <mauve/core.h>
#include <mauve/fsm.h>
#include <mauve/host/component.h>
#include <mauve/shell.h>

namespace mauve::exec {
namespace {

/// Null: the time is that of the machine.
const Clock* simulated(const Clock& clock) {
  return dynamic_cast<const MonotonicClock*>(&clock) == nullptr ? &clock : nullptr;
}

}  // namespace

TaskContext::TaskContext(std::string name, const Clock& its_clock,
                         std::shared_ptr<const rt::Noise> noise)
    : clock(its_clock),
      report(std::move(name), clock, simulated(clock)),
      outputs(report.name()),
      meter(simulated(clock), std::move(noise)) {}

TaskContext::~TaskContext() { delete current; }

void TaskContext::park(ComponentState as) {
  running = false;
  failed.forget();
  parked_at = clock.now();
  report.counters().state.store(as, std::memory_order_release);
  outputs.stand();
  if (as != ComponentState::stopped) return;
  report.record(TraceKind::stopped, parked_at, parked_at - t0);
  report.note(rt::EventKind::stopped, LogLevel::info, parked_at - t0);
}

MAUVE_RUNS_AT_A_SWAP void TaskContext::show_core() {
  const Configurable* const core = current->bundle->core.get();
  const Configurable* const shell = current->bundle->shell.get();
  outputs.put_in_force(core, shell, running && !failed);
}

MAUVE_RUNS_AT_A_SWAP void TaskContext::miss(std::uint64_t releases, Instant time, bool planned) {
  Counters& counters = report.counters();
  add(counters.missed, releases);
  add(current->bundle->measured->here().missed, releases);
  report.record(TraceKind::missed, time, static_cast<std::int64_t>(releases),
                counters.missed.load(std::memory_order_relaxed), planned ? 1 : 0);
}

void TaskContext::touch() const {
  report.trace().ring.touch();
  watch.touch();
  rt::touch(&report.counters(), sizeof report.counters());
  if (state != nullptr) rt::touch(state, sizeof *state);
  const auto* const own = reinterpret_cast<const std::byte*>(&failed);
  rt::touch(own, static_cast<std::size_t>(reinterpret_cast<const std::byte*>(this + 1) - own));
}

}  // namespace mauve::exec
