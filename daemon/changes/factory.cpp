// SPDX-License-Identifier: LGPL-3.0-or-later
#include "changes/factory.h"

#include <algorithm>
#include <stdexcept>

#include "base/mutex.h"
#include "base/thread_role.h"
#include "mauve/detail/job.h"
#include "model/job/abandonable_thread.h"
#include "model/job/keep_for_abandoned.h"
#include "rt/process/pulse.h"
#include "rt/thread/run_guarded.h"
#include "rt/thread/stack.h"

namespace mauve::daemon {

using SteadyClock = std::chrono::steady_clock;

/// The work of one thread, under Shared::mutex but for `state` and `pulse`.
struct Factory::Thread {
  rt::Pulse pulse{"factory"};
  AbandonableThread state;
  bool busy = false;
  bool abandoned = false;
  bool returned = false;
  SteadyClock::time_point since;
  Job then;
  OnAbandoned on_abandoned;
};

/// Outlives the factory while a thread is abandoned.
struct Factory::Shared {
  struct Piece {
    Job work;
    Job then;
    OnAbandoned on_abandoned;
  };

  explicit Shared(std::function<void(Job)> its_on_control)
      : on_control(std::move(its_on_control)) {}

  const std::function<void(Job)> on_control;
  Mutex mutex;
  ConditionVariable wake;
  FairQueue<Piece> queue MAUVE_GUARDED_BY(mutex);
  bool stopping MAUVE_GUARDED_BY(mutex) = false;
  std::shared_ptr<Thread> serving;
};

Factory::Factory(std::function<void(Job)> on_control)
    : shared_(std::make_shared<Shared>(std::move(on_control))) {}

Factory::~Factory() { stop(); }

void Factory::start() { begin(); }

void Factory::begin() {
  auto fresh = std::make_shared<Thread>();
  {
    const MutexLock lock(shared_->mutex);
    shared_->serving = fresh;
  }
  thread_ = std::make_shared<rt::Thread>();
  const rt::ThreadAttributes attributes{"mauve-factory", 0, {}, rt::kHookStack, true};
  auto started = thread_->start(attributes, [shared = shared_, fresh] {
    begin_thread(ThreadRole::factory);
    const rt::FaultStack stack;  // a hook may fill its own
    fresh->state.begin_here();
    run(shared, fresh);
  });
  if (!started) {
    throw std::runtime_error(to_string(started.error()));  // as std::thread does
  }
}

void Factory::stop() {
  {
    const MutexLock lock(shared_->mutex);
    shared_->stopping = true;
  }
  shared_->wake.notify_all();
  if (thread_ != nullptr) {
    thread_->join();
  }
}

void Factory::post(Job work, Job then, OnAbandoned on_abandoned, const Asker& asker) {
  const MutexLock lock(shared_->mutex);
  if (shared_->stopping) {
    return;
  }
  shared_->queue.push(asker, {std::move(work), std::move(then), std::move(on_abandoned)});
  shared_->wake.notify_one();
}

void Factory::run(const std::shared_ptr<Shared>& shared, const std::shared_ptr<Thread>& self) {
  for (;;) {
    Job work;
    {
      MutexLock lock(shared->mutex);
      shared->wake.wait_for(lock, rt::Pulse::kTurn, [&]() MAUVE_REQUIRES(shared->mutex) {
        return shared->stopping || !shared->queue.empty();
      });
      self->pulse.turn();
      if (shared->queue.empty()) {
        if (shared->stopping) {
          return;
        }
        continue;
      }
      auto next = shared->queue.pop();
      work = std::move(next.work);
      self->then = std::move(next.then);
      self->on_abandoned = std::move(next.on_abandoned);
      self->busy = true;
      self->since = SteadyClock::now();
    }
    self->pulse.turn(rt::Pulse::kBoundedElsewhere);  // look() has the bound
    work();
    work = nullptr;  // its objects are destroyed here, before [control] goes on
    Job then;
    OnAbandoned unused;
    {
      const MutexLock lock(shared->mutex);
      if (self->abandoned) {
        self->returned = true;
        return;
      }
      self->busy = false;
      then = std::move(self->then);
      unused = std::move(self->on_abandoned);
    }
    unused = nullptr;
    shared->on_control(std::move(then));
  }
}

std::vector<AbandonedThread> Factory::look(std::chrono::nanoseconds bound) {
  MAUVE_ON_THREAD(control);
  Job then;
  OnAbandoned on_abandoned;
  AbandonedThread left;
  {
    const MutexLock lock(shared_->mutex);
    const auto thread = shared_->serving;
    const auto elapsed = SteadyClock::now() - thread->since;
    if (!thread->busy || elapsed < bound) {
      return {};
    }
    left.hook = thread->state.hook();
    if (!thread->state.abandon()) {
      return {};
    }
    thread->abandoned = true;
    then = std::move(thread->then);
    on_abandoned = std::move(thread->on_abandoned);
    left.since = std::chrono::system_clock::now() -
                 std::chrono::duration_cast<std::chrono::system_clock::duration>(elapsed);
    left.user = user_;
    left_.emplace_back(left, thread);
  }
  thread_->abandon();
  keep_for_abandoned(std::move(thread_));
  begin();
  // It may hold the last reference to elements, so it goes where these are freed; with it goes the
  // ticket of the change.
  post([then = std::move(then)]() mutable { then = nullptr; }, [] {}, {});
  if (on_abandoned) {
    on_abandoned(left.hook);
  }
  return {left};
}

std::vector<AbandonedThread> Factory::abandoned_threads() const {
  std::vector<AbandonedThread> all;
  const MutexLock lock(shared_->mutex);
  for (const auto& [left, thread] : left_) {
    if (!thread->returned) {
      all.push_back(left);
    }
  }
  return all;
}

}  // namespace mauve::daemon
