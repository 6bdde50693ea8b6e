// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/task.h"

#include "base/thread_role.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "exec/update/prefetch_set.h"
#include "exec/update/task_update.h"
#include "rt/thread/preemption.h"

#include <mauve/host/component.h>
#include <mauve/host/task_attributes.h>

namespace mauve::exec {

Task::Task(std::string name, const Clock& clock, std::shared_ptr<const rt::Noise> noise)
    : context_(std::move(name), clock, std::move(noise)),
      faults_(context_),
      jobs_(context_, faults_),
      boundary_(context_, faults_, jobs_) {
  static_cast<void>(
      rt::preemption_is_reported());  // It finds that out in its first call, and sleeps.
}

void Task::begin(std::unique_ptr<TaskUpdate> first, Instant t0) {
  MAUVE_ON_THREAD(control);
  context_.t0 = t0;
  context_.current = first.release();
  const TaskUpdate& current = *context_.current;
  context_.watch.set(current.bound, current.has_safe_values);
  const TaskAttributes& attributes = current.bundle->task;
  context_.arm(t0 + attributes.offset.count());
  context_.running = attributes.start && current.mode != Mode::park;
  context_.report.counters().state.store(context_.running ? ComponentState::running
                                                          : ComponentState::stopped);
  context_.show_core();
  if (context_.running) {
    context_.report.record(TraceKind::started, context_.clock.now(), context_.release - t0);
  }
}

bool Task::suspected() const {
  return counters().suspected.load(std::memory_order_relaxed) &&
         counters().state.load(std::memory_order_relaxed) == ComponentState::running;
}

Duration Task::bound(bool realtime) const {
  const Duration bound = context_.watch.bound(realtime);
  if (!context_.mailbox.halted()) return bound;
  return bound == Duration{0} ? kHaltedJob : std::min(bound, kHaltedJob);
}

Instant Task::known_release() const {
  const bool runs = counters().state.load() == ComponentState::running;
  return runs ? context_.t0 + counters().next_release.load()
              : std::numeric_limits<Instant>::max() / 2;
}

bool Task::lose_thread(Instant since) {
  if (!context_.watch.take_from_thread(since)) return false;
  context_.report.begin_new_trace();
  context_.failed_in_lock = context_.watch.cut_off_thread();
  return true;
}

std::vector<std::shared_ptr<const Bundle>> Task::bundles() const { return boundary_.bundles(); }

bool Task::serve() {
  if (!boundary_.serve()) return false;
  context_.mailbox.count_quiescent();
  return true;
}

bool Task::run_release() {
  const auto& prefetch_set = context_.current->prefetch_set;
  if (prefetch_set != nullptr) prefetch_set->prefetch();
  const Instant now = context_.clock.now();
  boundary_.drop_missed(now);
  if (!boundary_.cross(now)) return false;
  if (context_.running && context_.release <= now) {
    if (context_.failed) {
      faults_.pass_release();
    } else if (!jobs_.run(now)) {
      return false;
    }
  }
  boundary_.acknowledge();
  context_.mailbox.count_quiescent();
  return true;
}

void Task::go_on() {
  boundary_.finish_taking();
  jobs_.go_on();
  boundary_.acknowledge();
  context_.mailbox.count_quiescent();
}

}  // namespace mauve::exec
