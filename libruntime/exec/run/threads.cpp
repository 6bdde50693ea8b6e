// SPDX-License-Identifier: LGPL-3.0-or-later
/// One thread a task, all waiting in the same primitive; and the guard above them, which ends jobs
/// that do not return, or abandons their threads.
#include <algorithm>
#include <map>
#include <optional>
#include <thread>

#include "exec/run/threads.h"

#include "base/thread_role.h"
#include "exec/run/turn_watch.h"
#include "exec/task/task.h"
#include "model/job/keep_for_abandoned.h"
#include "rt/guardian/guardian_page.h"
#include "rt/process/pulse.h"
#include "rt/thread/fence.h"
#include "rt/thread/futex.h"
#include "rt/thread/pi_mutex.h"
#include "rt/thread/run_guarded.h"

#include <mauve/detail/job.h>
#include <mauve/host/component.h>

namespace mauve::exec {
namespace {

constexpr int kGuardPriority = 95;  // above every component
/// A job that exceeds its bound gets the signal to end this often and at this distance, since it
/// may run code that must not be interrupted.
constexpr unsigned kCalls = rt::kGuardsFaults ? 10 : 0;
constexpr Duration kBetweenCalls{100us};
/// The last tenth of its bound distinguishes a job that never returns from a preempted one.
constexpr Instant kShareToJudge = 10;
constexpr Duration kBetweenLooks{1ms};
constexpr Duration kBeyondBound{1s};

class Threads final : public Runner {
 public:
  explicit Threads(Duration assumed) : noise_(std::make_shared<rt::Noise>(assumed)) {}
  ~Threads() override {
    noise_->stop();  // abandoned tasks keep it
    rt::futex_bump(start_);
    guard_quits_.store(true);
    rt::futex_bump(bell_);
    guard_.join();
    for (auto& [task, worker] : workers_) {
      worker->quit.store(true);
      rt::futex_bump(worker->task.mailbox().wake_word());
    }
  }

  [[nodiscard]] const Clock& clock() const override { return clock_; }
  [[nodiscard]] std::shared_ptr<const rt::Noise> noise() const override { return noise_; }
  [[nodiscard]] Duration lead(std::size_t count) const override {
    return 200us + 5us * static_cast<std::int64_t>(count);
  }

  Status add(Task& task, const rt::ThreadAttributes& attributes) override {
    auto worker = std::make_unique<Worker>(task, attributes);
    Worker& self = *worker;
    // The guard waits for no thread that the kernel makes.
    Status started = worker->thread.start(attributes, [this, &self] { run(self); });
    const rt::PiMutexLock lock(mutex_);
    if (started) workers_.emplace(&task, std::move(worker));
    if (started && attributes.priority > 0) noise_->watch(attributes.cpus);
    look_again();
    return started;
  }

  void settle() override {
    rt::fence_all_threads();  // the first one takes milliseconds: before T0 is near
    std::size_t workers = 0;
    {
      const rt::PiMutexLock lock(mutex_);
      workers = workers_.size();
    }
    while (parked_.load() < workers) std::this_thread::sleep_for(20us);
  }
  void open() override {
    if (!guard_.running()) start_guard();
    rt::futex_bump(start_);
  }

  void wake(Task& task) override { rt::futex_bump(task.mailbox().wake_word()); }

  bool await(const std::function<bool()>& condition, Instant deadline) override {
    // Polled: a real-time thread then needs no system call to answer.
    for (Duration pause = 20us; !condition(); pause = std::min(2 * pause, Duration{1ms})) {
      if (now() >= deadline) return condition();
      std::this_thread::sleep_for(pause);
    }
    return true;
  }

  [[nodiscard]] std::shared_ptr<void> raise_priority() override {
    return std::make_shared<rt::Boost>(1);
  }

  [[nodiscard]] bool is_fifo(const Task& task, int priority) const override {
    const rt::PiMutexLock lock(mutex_);
    const auto worker = workers_.find(&task);
    return worker != workers_.end() && worker->second->thread.is_fifo(priority);
  }

  Status reschedule(Task& task, int priority, const std::vector<int>& cpus) override {
    const rt::PiMutexLock lock(mutex_);
    const auto found = workers_.find(&task);
    if (found == workers_.end()) return ok();
    Worker& worker = *found->second;
    worker.attributes.priority = priority;
    if (!cpus.empty()) worker.attributes.cpus = cpus;
    Status done = worker.thread.set_priority(priority);
    if (done && !cpus.empty()) done = worker.thread.set_cpus(cpus);
    if (done && priority > 0) noise_->watch(worker.attributes.cpus);
    return done;
  }

  [[nodiscard]] std::optional<Duration> processor_time(const Task& task) const override {
    const rt::PiMutexLock lock(mutex_);
    const auto worker = workers_.find(&task);
    if (worker == workers_.end()) return std::nullopt;
    return worker->second->thread.used();
  }

  [[nodiscard]] bool is_asleep(const Task& task) const override {
    const rt::PiMutexLock lock(mutex_);
    const auto worker = workers_.find(&task);
    return worker != workers_.end() && worker->second->thread.asleep();
  }

  bool end(Task& task, Instant deadline) override {
    Worker* const worker = begin_end(task);
    if (worker == nullptr) return true;
    const bool ended = await([&] { return !worker->thread.running(); }, deadline);
    // Its last steps are short, but those of an ordinary thread wait for a processor.
    const auto joined = [&] {
      const rt::PiMutexLock lock(mutex_);
      return worker->thread.join_if_ended();
    };
    if (ended) static_cast<void>(await(joined, rt::kForever));
    const rt::PiMutexLock lock(mutex_);
    const auto found = workers_.find(&task);
    if (!ended) {
      worker->abandoned = true;
      worker->thread.abandon();
      keep_for_abandoned(std::shared_ptr<Worker>(std::move(found->second)));
    }
    workers_.erase(found);
    return ended;
  }

  void look_again() override { rt::futex_bump(bell_); }

  [[nodiscard]] bool has_abandoned(const Task* task, const CoreBase* core) const override {
    const rt::PiMutexLock lock(mutex_);
    const auto has_core = [core](const auto& bundle) { return bundle->core.get() == core; };
    return std::any_of(lost_.begin(), lost_.end(), [&](const auto& worker) {
      const auto& inside = worker->inside;
      return (task == nullptr || &worker->task == task) &&
             (core == nullptr || std::any_of(inside.begin(), inside.end(), has_core));
    });
  }

 private:
  struct Worker {
    Worker(Task& its_task, rt::ThreadAttributes its_attributes)
        : task(its_task), attributes(std::move(its_attributes)) {}

    /// Is a job past its bound because it runs on and on, or sleeps? A job that more urgent
    /// threads, or a host that stood still, keep from the processor is not to blame.
    [[nodiscard]] bool is_to_blame(Instant bound) const {
      const Duration used = thread.used() - used_before;
      return used.count() >= bound / kShareToJudge * 9 / 10 || thread.asleep();
    }

    /// Code of a core may have changed its priority or CPUs, which only the architecture may set.
    void restore_scheduling() {
      const int priority = attributes.priority;
      if (quit.load() || priority <= 0 || thread.keeps(priority, attributes.cpus)) return;
      static_cast<void>(thread.set_priority(priority));
      if (!attributes.cpus.empty()) static_cast<void>(thread.set_cpus(attributes.cpus));
      if (thread.keeps(priority, attributes.cpus)) task.count_restored();
    }

    /// How long others keep the thread of a component with a guarded output from the processor; 0:
    /// they do not.
    [[nodiscard]] Duration starved(Instant now) {
      if (quit.load() || !task.outputs().holds_any()) return Duration{0};
      const Duration bound = task.bound(attributes.priority > 0);
      return turn.starved(now, {task.known_release(), thread.used(), bound},
                          [this] { return thread.asleep(); });
    }

    Task& task;
    rt::ThreadAttributes attributes;
    TurnWatch turn;
    std::atomic<bool> quit{false};
    std::vector<std::shared_ptr<const Bundle>> inside;  // once lost: the bundles it may use
    bool abandoned = false;  // its last orders went out while its job was under way
    bool ending = false;
    Instant judged = 0;       // when the job began that the next two are about
    Duration used_before{0};  // of the processor, when its last tenth began
    unsigned calls = 0;       // to end it
    rt::Thread thread;
  };

  /// The guard leaves it alone from now on.
  Worker* begin_end(Task& task) {
    const rt::PiMutexLock lock(mutex_);
    const auto found = workers_.find(&task);
    if (found == workers_.end()) return nullptr;
    found->second->quit.store(true);
    rt::futex_bump(task.mailbox().wake_word());
    return found->second.get();
  }

  void run(Worker& worker) {
    take_thread_role(ThreadRole::realtime);
    const rt::FaultStack stack;
    worker.task.watch().set_thread_job(&this_job());
    parked_.fetch_add(1);
    while (start_.load(std::memory_order_acquire) == 0) {
      rt::futex_wait_until(start_, 0, rt::kForever);
    }
    run_until_quit(worker);
  }

  /// An abandoned thread ends as soon as its job does.
  void run_until_quit(Worker& worker) {
    bool ours = true;
    while (ours && !worker.quit.load(std::memory_order_relaxed)) ours = step(worker.task);
    const rt::PiMutexLock lock(mutex_);  // the guard is not looking at this thread's job
    if (worker.inside.empty()) worker.task.watch().set_thread_job(nullptr);
    if (worker.abandoned) worker.task.outputs().repeat();
    worker.ending = true;
    look_again();
  }

  /// One look at the mailbox and at the clock; sleeps until there is something to do.
  static bool step(Task& task) {
    const std::uint32_t seen = task.mailbox().wake_word().load(std::memory_order_acquire);
    if (!task.serve()) return false;
    if (task.due()) return task.run_release();  // a wait for the past would cost 15 us
    rt::futex_wait_until(task.mailbox().wake_word(), seen,
                         task.running() ? task.next_release() : rt::kForever);
    return true;
  }

  // --- the guard ---------------------------------------------------------------------------------

  /// Real-time as soon as any component is.
  void start_guard() {
    bool realtime = false;
    {
      const rt::PiMutexLock lock(mutex_);
      realtime = std::any_of(workers_.begin(), workers_.end(), [](const auto& entry) {
        return entry.second->attributes.priority > 0;
      });
    }
    const auto body = [this] { guard(); };
    const rt::ThreadAttributes ordinary{"mauve-guard", 0, {}, 64 * 1024};
    rt::ThreadAttributes attributes = ordinary;
    attributes.priority = realtime ? kGuardPriority : 0;
    beats_ = realtime;
    pulse_.emplace("guard");
    if (guard_.start(attributes, body)) return;
    beats_ = false;                                     // it may be late by itself
    if (!guard_.start(ordinary, body)) pulse_.reset();  // no thread is ever abandoned
  }

  /// Sleeps until the earliest moment at which any job may run into its bound. The guardian of
  /// the process and the pulse of the guard want to hear of it earlier.
  void guard() {
    while (!guard_quits_.load()) {
      pulse_->turn();
      const std::uint32_t seen = bell_.load();
      Instant next = now() + rt::Pulse::kTurn.count();
      bool served = true;
      Duration starved{0};
      const bool beats = beats_ && rt::beats_are_heard();
      {
        const rt::PiMutexLock lock(mutex_);
        std::string_view kept_waiting;
        for (auto& [task, worker] : workers_) {
          next = std::min(next, look_at(worker));
          if (const Duration time = worker->starved(now()); time > starved) {
            starved = time;
            kept_waiting = task->name();
          }
          served = is_served(*worker) && served;
        }
        next = std::min(next, join_lost());
        if (beats) rt::say_starved(starved, kept_waiting);
      }
      if (beats && served && starved == Duration{0}) rt::beat();
      if (beats) next = std::min(next, now() + rt::kBeatPeriod.count());
      rt::futex_wait_until(bell_, seen, next);
    }
  }

  /// False for a release that is overdue by more than the bound of a job. The guard would have
  /// ended a job in its way by then, so the guard cannot help either.
  [[nodiscard]] bool is_served(const Worker& worker) const {
    const Duration bound = worker.task.bound(worker.attributes.priority > 0);
    const Instant latest = worker.task.known_release() + (bound + kBeyondBound).count();
    return worker.quit.load() || bound <= Duration{0} || now() < latest;
  }

  /// The host does not let its CPU run at this moment, and charges that time to its job: the job is
  /// judged by the time from now on. The excuse ends after twice the bound, because a core can keep
  /// even the probe from running.
  [[nodiscard]] bool is_excused(Worker& worker, Instant since, Instant bound) const {
    if (now() >= since + 2 * bound) return false;
    if (!noise_->stands_still(worker.attributes.cpus, now())) return false;
    worker.used_before = worker.thread.used();
    return true;
  }

  /// When to look again.
  Instant look_at(std::unique_ptr<Worker>& worker) MAUVE_REQUIRES(mutex_) {
    worker->restore_scheduling();
    Task& task = worker->task;
    const Instant bound = task.bound(worker->attributes.priority > 0).count();
    if (worker->quit.load() || bound <= 0) return rt::kForever;
    const Instant since = task.watch().busy_since();
    const Instant unjudged = bound - bound / kShareToJudge;
    if (since <= 0) return now() + unjudged;
    if (now() < since + unjudged) return since + unjudged;
    if (std::exchange(worker->judged, since) != since) {
      worker->calls = 0;
      worker->used_before = worker->thread.used();
    }
    if (now() < since + bound) return since + bound;
    if (is_excused(*worker, since, bound) || !worker->is_to_blame(bound)) {
      return now() + kBetweenLooks.count();
    }
    if (worker->calls != kCalls) {
      ++worker->calls;
      task.watch().interrupt(since);
      worker->thread.interrupt();
      return now() + kBetweenCalls.count();
    }
    if (task.lose_thread(since)) replace(worker);
    return now() + bound;
  }

  /// The old thread runs on, as an ordinary one; a new one goes on with the task.
  void replace(std::unique_ptr<Worker>& worker) MAUVE_REQUIRES(mutex_) {
    static_cast<void>(worker->thread.set_priority(0));
    auto next = std::make_unique<Worker>(worker->task, worker->attributes);
    worker->inside = worker->task.bundles();
    worker->abandoned = true;
    Worker& self = *next;
    lost_.push_back(std::exchange(worker, std::move(next)));
    const Status started = self.thread.start(self.attributes, [this, &self] {
      const rt::FaultStack stack;
      self.task.watch().set_thread_job(&this_job());
      self.task.go_on();
      run_until_quit(self);
    });
    if (!started) self.task.park_for_good("its job never returns, and there is no new thread");
  }

  /// Joins each abandoned thread that has ended: the guard must not wait for one that runs.
  Instant join_lost() MAUVE_REQUIRES(mutex_) {
    std::erase_if(lost_, [](const std::unique_ptr<Worker>& worker) {
      return worker->thread.join_if_ended();
    });
    const bool soon =
        std::any_of(lost_.begin(), lost_.end(), [](const auto& worker) { return worker->ending; });
    return soon ? now() + Duration{1ms}.count() : rt::kForever;
  }

  MonotonicClock clock_;
  const std::shared_ptr<rt::Noise> noise_;
  std::atomic<std::size_t> parked_{0};
  std::atomic<std::uint32_t> start_{0};
  std::atomic<std::uint32_t> bell_{0};
  mutable rt::PiMutex mutex_;  // no thread holds it long
  std::map<const Task*, std::unique_ptr<Worker>> workers_ MAUVE_GUARDED_BY(mutex_);
  std::vector<std::unique_ptr<Worker>> lost_ MAUVE_GUARDED_BY(mutex_);
  std::atomic<bool> guard_quits_{false};
  bool beats_ = false;              // the guard is real-time, so that its silence means something
  std::optional<rt::Pulse> pulse_;  // of the guard
  rt::Thread guard_;
};

}  // namespace

std::unique_ptr<Runner> make_threads(Duration assumed) {
  return std::make_unique<Threads>(assumed);
}

}  // namespace mauve::exec
