// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/job_meter.h"

#include <algorithm>
#include <utility>

#include "rt/thread/preemption.h"
#include "rt/time/cpu_time.h"

#include <mauve/detail/job.h>
#include <mauve/host/task_attributes.h>

namespace mauve::exec {
namespace {

/// A job that took no longer would have been in time, had it begun in time.
Duration longest_span(const TaskAttributes& task, Duration wait) {
  return task.deadline > Duration{0} ? std::min(wait, task.deadline) : wait;
}

}  // namespace

JobMeter::JobMeter(const Clock* simulated, std::shared_ptr<const rt::Noise> noise)
    : simulated_(simulated), noise_(std::move(noise)) {}

void JobMeter::begin(rt::JobTimes& times, Instant start, Duration lateness, bool on_probation,
                     bool has_budget) {
  times_ = &times;
  if (times.since.load(std::memory_order_relaxed) == 0) {
    times.since.store(start, std::memory_order_relaxed);
  }
  times.lateness.add(lateness.count());
  // A system call, so only where it counts. It counts on probation, where the core is judged by it.
  // It counts without a budget: there measured times stand in for it, and the longest job may be
  // just the preempted one. It counts after a preempted job, as the next one may be preempted as
  // well, and where the kernel does not report preemptions.
  const bool ask = on_probation || !has_budget || preempted_;
  cpu_before_ = ask && simulated_ == nullptr ? rt::cpu_time() : Duration{0};
  waits_before_ = on_probation && simulated_ == nullptr ? rt::waits_so_far() : kUnknown;
  rt::watch_for_preemption();
}

std::optional<Duration> JobMeter::end(const JobUse& job, bool preempted, bool on_probation,
                                      Counters& counters) {
  const Instant took = job.end - job.start;
  preempted_ = preempted;
  (preempted ? times_->preempted : times_->clean).add(took);
  times_->response.add(job.end - job.released);
  if (const Job::LockWaits& waits = this_job().lock_waits; waits.count != 0) {
    times_->lock_waits.add({waits.count, waits.sum, waits.longest});
  }
  std::optional<Duration> used;
  if (!preempted || simulated_ != nullptr) used = Duration{took};
  if (simulated_ == nullptr && cpu_before_ > Duration{0} && (preempted || on_probation)) {
    const Duration on_processor = rt::cpu_time() - cpu_before_;
    used = used ? std::min(*used, on_processor) : on_processor;
  }
  // Of the time that the host took from the processor, the kernel charges a part to the thread.
  const bool longest = used && used->count() > counters.used_max.load(std::memory_order_relaxed);
  if (longest) raise(counters.used_max, (*used - 2 * held_up_since(job.released)).count());
  return used;
}

/// The longest time that the machine may have held up this job. It is twice the time that a probe
/// saw, since a hold-up begins before the instant at which the probe was due. A job released before
/// such a job ended had to wait behind it, and has the same excuse.
Duration JobMeter::excuse(Instant released, Instant end) {
  Duration held_up = 2 * held_up_since(released);
  if (held_up == Duration{0} && released < excused_until_) held_up = excused_;
  excused_ = held_up;
  excused_until_ = held_up > Duration{0} ? end : 0;
  return held_up;
}

bool JobMeter::took_long(const JobUse& job, Duration limit) const {
  if (!job.used && (noise_ == nullptr || !noise_->is_known())) return false;
  const Duration took = job.used.value_or(Duration{job.end - job.start});
  return took - 2 * held_up_since(job.released) > limit;
}

JobTiming JobMeter::timing_of(const JobUse& job, const TaskAttributes& task, Duration wait) {
  const Duration excused = excuse(job.released, job.end);
  const Duration used = std::max(job.used.value_or(Duration{0}) - excused, Duration{0});
  JobTiming timing;
  timing.over_budget = task.budget > Duration{0} && used > task.budget;
  timing.twice_over = timing.over_budget && used > 2 * task.budget;
  timing.late = job.late > excused;
  if (!timing.late) return timing;
  const Duration span = longest_span(task, wait);
  const bool took_long = Duration{job.end - job.start} > span;
  const bool waited = took_long && waits_before_ != kUnknown &&
                      rt::waits_so_far() - waits_before_ > this_job().lock_waits.count;
  timing.too_long = used > span || waited;
  return timing;
}

}  // namespace mauve::exec
