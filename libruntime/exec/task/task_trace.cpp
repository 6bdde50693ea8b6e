// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a task tells of itself in a trace.
#include "exec/task/task.h"
#include "rt/cache.h"

#include <mauve/component.h>

namespace mauve::exec {

MAUVE_RUNS_AT_A_SWAP void Task::tell(TraceKind kind, Instant time, std::int64_t value,
                                     std::uint64_t small, std::uint32_t name) {
  if (!detail::traces(TraceMode::jobs)) return;
  trace_.load(std::memory_order_relaxed)->ring.push(kind, time, name, small, value);
}

/// A relief is no change of [control]: the task stays with the number it has.
MAUVE_RUNS_AT_A_SWAP void Task::tell_taken(const Published& next, Instant time) {
  const bool barrier = next.barrier != Published::Barrier::none;
  if (!barrier && next.number != 0) number_ = next.number;
  const TakenAs as = barrier ? TakenAs::barrier : next.taken_as;
  const bool has_instant = as != TakenAs::relief && next.transaction->has_instant();
  tell(TraceKind::taken, time, has_instant ? next.transaction->instant() - t0_ : -1,
       barrier ? next.number : number_, static_cast<std::uint32_t>(as));
}

/// `planned`: a change lets them pass, nobody was late.
void Task::miss(std::uint64_t releases, Instant time, bool planned) {
  add(counters_.missed, releases);
  add(current_->bundle->measured->here().missed, releases);
  tell(TraceKind::missed, time, static_cast<std::int64_t>(releases),
       counters_.missed.load(std::memory_order_relaxed), planned ? 1 : 0);
}

}  // namespace mauve::exec
