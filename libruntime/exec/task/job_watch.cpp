// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/job_watch.h"

#include <algorithm>

#include "rt/process/cache.h"
#include "rt/thread/fence.h"

#include <mauve/detail/resource_lock.h>

namespace mauve::exec {
namespace {

/// Stands in place of the begin of a job: no thread runs the task.
constexpr Instant kClaimed = -1;
/// An ordinary thread shares its processor: a sound job may be kept waiting for so long.
constexpr Duration kShortestOrdinary = 500ms;

}  // namespace

Duration JobWatch::bound(bool realtime) const {
  const Duration own{bound_.load(std::memory_order_relaxed)};
  return realtime || own == Duration{0} ? own : std::max(own, kShortestOrdinary);
}

bool JobWatch::take_from_thread(Instant since) {
  if (watched_.keeps_thread.load()) return false;
  return watched_.busy_since.compare_exchange_strong(since, kClaimed);
}

const ResourceLock* JobWatch::cut_off_thread() {
  Job* const job = job_.exchange(nullptr);
  if (job == nullptr) return nullptr;
  job->no_ports.store(true);
  rt::fence_all_threads();  // it writes alone to no exchange from here on: see LatestValue
  return ResourceLock::poison_and_free_all(*job);
}

void JobWatch::fence() {
  fenced_.store(true);
  if (Job* job = job_.load()) job->no_ports.store(true);
}

void JobWatch::set_thread_job(Job* job) {
  job_.store(job);
  if (job != nullptr && fenced_.load()) job->no_ports.store(true);
}

MAUVE_RUNS_AT_A_SWAP void JobWatch::set(Duration bound, bool has_safe_values) {
  bound_.store(bound.count(), std::memory_order_relaxed);
  has_safe_values_.store(has_safe_values, std::memory_order_relaxed);
}

void JobWatch::touch() const { rt::touch(&bound_, sizeof bound_); }

}  // namespace mauve::exec
