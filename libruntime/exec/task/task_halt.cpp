// SPDX-License-Identifier: LGPL-3.0-or-later
/// The end of a job that others decide: its bound, and a stop that does without [control].
#include <algorithm>
#include <limits>

#include "exec/task/task.h"

namespace mauve::exec {

Duration Task::bound(bool realtime) const {
  // An ordinary thread shares its processor: a healthy job may be kept waiting for so long.
  constexpr Duration kShortestOrdinary = 500ms;
  const Duration own{bound_.load(std::memory_order_relaxed)};
  const Duration bound = realtime || own == Duration{0} ? own : std::max(own, kShortestOrdinary);
  if (!halted()) return bound;
  return bound == Duration{0} ? kHaltedJob : std::min(bound, kHaltedJob);
}

Instant Task::told_release() const {
  const bool runs = counters_.state.load() == ComponentState::running;
  return runs ? t0_ + counters_.next_release.load() : std::numeric_limits<Instant>::max() / 2;
}

/// A change took effect, but a direct stop has the last word: the component does not run, and its
/// outputs, which may be others, have their safe values before [control] goes on.
void Task::answer_between_jobs() {
  if (unacknowledged_ != nullptr && halted()) stand_still();
  acknowledge();
}

void Task::stand_still() {
  const bool runs = running_ || waiting_;
  waiting_ = false;
  failed_.forget();
  write_safe_values();
  if (runs) park(ComponentState::stopped);
}

}  // namespace mauve::exec
