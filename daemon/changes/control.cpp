// SPDX-License-Identifier: LGPL-3.0-or-later
#include "changes/control.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/mutex.h"
#include "base/thread_role.h"
#include "mauve/detail/job.h"
#include "mauve/host/change.h"
#include "rt/process/pulse.h"
#include "rt/thread/crash_handler.h"
#include "rt/thread/run_guarded.h"
#include "rt/thread/thread.h"
#include "rt/time/cpu_time.h"

namespace mauve::daemon {

namespace {

constexpr std::chrono::microseconds kShortestPause{20};
constexpr std::chrono::microseconds kLongestPause{1'000};

}  // namespace

WorkerThread::~WorkerThread() { stop(); }

void WorkerThread::start() {
  thread_ = std::thread([this] {
    begin_thread(role_);
    const rt::FaultStack stack;  // code of a plugin that computes a value may fill its own
    run();
  });
}

void WorkerThread::stop() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void WorkerThread::halt() {
  FairQueue<Queued> dropped;  // destroyed out of the lock: it may hold the last ticket of a change
  std::deque<Job> dropped_urgent;
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
    std::swap(dropped, jobs_);
    dropped_urgent.swap(urgent_);
  }
  wake_.notify_all();
}

bool WorkerThread::post(Job job, const Asker& asker) {
  const MutexLock lock(mutex_);
  if (stopping_) {
    return false;
  }
  jobs_.push(asker, {std::move(job), asker});
  wake_.notify_one();
  return true;
}

bool WorkerThread::post_urgent(Job job) {
  const MutexLock lock(mutex_);
  if (stopping_) {
    return false;
  }
  urgent_.push_back(std::move(job));
  wake_.notify_one();
  return true;
}

bool WorkerThread::post_first(Job job) {
  const MutexLock lock(mutex_);
  if (stopping_) {
    return false;
  }
  urgent_.push_front(std::move(job));
  wake_.notify_one();
  return true;
}

bool WorkerThread::is_this_thread() const { return std::this_thread::get_id() == thread_.get_id(); }

void WorkerThread::set_priority(int priority) {
  rt::give_priority(thread_.native_handle(), priority);
}

void WorkerThread::await(std::function<bool()> over, Job then) {
  awaited_.push_back({std::move(over), std::move(then)});
  pause_ = kShortestPause;
}

void WorkerThread::run() {
  rt::Pulse pulse{std::string(to_string(role_))};
  for (;;) {
    pulse.turn();
    Queued next;
    const bool more = take(next);
    // While the process dies nothing changes any more, and nothing is judged or saved.
    if (!more || (role_ == ThreadRole::control && rt::is_dying())) {
      awaited_.clear();
      return;
    }
    if (next.job) {
      pulse.turn(rt::Pulse::kBoundedElsewhere);
      run_job(next);
    }
    look_at_awaited();
  }
}

void WorkerThread::run_job(const Queued& queued) {
  const bool counts = role_ == ThreadRole::control && queued.asker.role == server::Role::viewer;
  const auto before = counts ? rt::cpu_time() : Duration{0};
  {
    const MutexLock lock(mutex_);
    busy_since_ = std::chrono::steady_clock::now();
  }
  queued.job();
  const MutexLock lock(mutex_);
  busy_since_.reset();
  if (counts) {
    share_.served(queued.asker.uid, rt::cpu_time() - before, ViewerShare::Clock::now());
  }
}

std::optional<std::chrono::steady_clock::time_point> WorkerThread::busy_since() {
  const MutexLock lock(mutex_);
  return busy_since_;
}

/// Takes the next job. False: the thread ends. No job: it is time to turn, and to look at the
/// awaited conditions.
bool WorkerThread::take(Queued& next) {
  MutexLock lock(mutex_);
  const auto ready = [this]() MAUVE_REQUIRES(mutex_) {
    return stopping_ || !urgent_.empty() || jobs_.has(may_now());
  };
  const auto now = ViewerShare::Clock::now();
  Duration longest = awaited_.empty() ? rt::Pulse::kTurn : Duration{pause_};
  if (const auto viewer = share_.next(now); viewer && !jobs_.empty()) {
    longest = std::min<Duration>(longest, *viewer - now);
  }
  if (!wake_.wait_for(lock, longest, ready)) {
    pause_ = std::min(2 * pause_, kLongestPause);
    return true;
  }
  if (!urgent_.empty()) {
    next.job = std::move(urgent_.front());
    urgent_.pop_front();
    return true;
  }
  if (jobs_.empty()) {
    return false;
  }
  if (auto queued = jobs_.pop(may_now())) {
    next = *std::move(queued);
  }
  return true;
}

void WorkerThread::look_at_awaited() {
  std::vector<Job> due;
  std::erase_if(awaited_, [&](Awaited& awaited) {
    if (!awaited.over()) {
      return false;
    }
    due.push_back(std::move(awaited.then));
    return true;
  });
  for (auto& job : due) {
    job();
  }
}

Control::Control(std::chrono::nanoseconds prepare_within) : prepare_within_(prepare_within) {}

Control::~Control() { stop(); }

void Control::start() {
  control_.start();
  answer_.start();
  factory_.start();
}

void Control::stop() {
  FairQueue<Change> dropped;
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
    std::swap(dropped, waiting_);
  }
  // The factory may still post a continuation to [control]: it ends first.
  factory_.stop();
  control_.stop();
  answer_.halt();  // no client is left to read an answer
  answer_.stop();
}

void Control::read(Job job, const Asker& asker) { control_.post(std::move(job), asker); }

void Control::urgent(Job job) { control_.post_urgent(std::move(job)); }

bool Control::change(Change change, const Asker& asker) {
  {
    const MutexLock lock(mutex_);
    if (stopping_ || waiting_.size() >= kWaiting) {
      return false;
    }
    waiting_.push(asker, std::move(change));
  }
  begin_next();
  return true;
}

void Control::begin_next() {
  Change next;
  {
    const MutexLock lock(mutex_);
    if (busy_ || stopping_ || waiting_.empty()) {
      return;
    }
    busy_ = true;
    next = waiting_.pop();
  }
  Ticket ticket(nullptr, [this](void*) { ended(); });
  control_.post(
      [next = std::move(next), ticket = std::move(ticket)]() mutable { next(std::move(ticket)); });
}

void Control::ended() {
  {
    const MutexLock lock(mutex_);
    busy_ = false;
  }
  begin_next();
}

void Control::in_factory(Job work, Job then, Factory::OnAbandoned on_abandoned,
                         const Asker& asker) {
  factory_.post(std::move(work), std::move(then), std::move(on_abandoned), asker);
}

void Control::write_out(Job job, const Asker& asker) {
  {
    const MutexLock lock(mutex_);
    ++long_answers_[asker.uid];
  }
  answer_.post(
      [this, job = std::move(job), uid = asker.uid] {
        job();
        const MutexLock lock(mutex_);
        --long_answers_[uid];
      },
      asker);
}

std::size_t Control::long_answers(uid_t uid) const {
  const MutexLock lock(mutex_);
  const auto user = long_answers_.find(uid);
  return user == long_answers_.end() ? 0 : user->second;
}

std::vector<AbandonedThread> Control::look_after_factory() {
  return factory_.look(prepare_within_);
}

bool Control::busy() const {
  const MutexLock lock(mutex_);
  return busy_;
}

}  // namespace mauve::daemon
