// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/runner.h"

#include <algorithm>
#include <map>
#include <thread>

#include "model/left_behind.h"
#include "rt/futex.h"
#include "rt/rescue.h"

#include <mauve/job.h>

namespace mauve::exec {
namespace {

/// One thread a task; all wait in the same primitive.
class Threads final : public Runner {
 public:
  ~Threads() override {
    open();
    for (auto& [task, worker] : workers_) {
      worker->quit.store(true);
      rt::futex_bump(worker->task.command());
    }
  }

  [[nodiscard]] const Clock& clock() const override { return clock_; }
  [[nodiscard]] Duration lead(std::size_t count) const override {
    return 200us + 5us * static_cast<std::int64_t>(count);
  }

  Status add(Task& task, const rt::ThreadAttributes& attributes) override {
    auto worker = std::make_unique<Worker>(task);
    Worker& self = *worker;
    Status started = worker->thread.start(attributes, [this, &self] { run(self); });
    if (started) workers_.emplace(&task, std::move(worker));
    return started;
  }

  void settle() override {
    while (parked_.load() < workers_.size()) std::this_thread::sleep_for(20us);
  }
  void open() override { rt::futex_bump(gate_); }

  void wake(Task& task) override { rt::futex_bump(task.command()); }

  bool await(const std::function<bool()>& condition, Instant deadline) override {
    // Polled: a real-time thread then needs no system call to answer.
    for (Duration pause = 20us; !condition(); pause = std::min(2 * pause, Duration{1ms})) {
      if (now() >= deadline) return condition();
      std::this_thread::sleep_for(pause);
    }
    return true;
  }

  [[nodiscard]] std::shared_ptr<void> hurry() override { return std::make_shared<rt::Boost>(1); }

  [[nodiscard]] bool is_fifo(const Task& task, int priority) const override {
    const auto worker = workers_.find(&task);
    return worker != workers_.end() && worker->second->thread.is_fifo(priority);
  }

  Status reschedule(Task& task, int priority, const std::vector<int>& cpus) override {
    const auto worker = workers_.find(&task);
    if (worker == workers_.end()) return ok();
    Status done = worker->second->thread.set_priority(priority);
    if (done && !cpus.empty()) done = worker->second->thread.set_cpus(cpus);
    return done;
  }

  bool end(Task& task, Instant deadline) override {
    const auto found = workers_.find(&task);
    if (found == workers_.end()) return true;
    Worker& worker = *found->second;
    worker.quit.store(true);
    rt::futex_bump(task.command());
    const bool ended = await([&] { return !worker.thread.running(); }, deadline);
    if (ended) {
      worker.thread.join();
    } else {
      worker.thread.abandon();
      leave_behind(std::shared_ptr<Worker>(std::move(found->second)));
    }
    workers_.erase(found);
    return ended;
  }

 private:
  struct Worker {
    explicit Worker(Task& its_task) : task(its_task) {}
    Task& task;
    std::atomic<bool> quit{false};
    rt::Thread thread;
  };

  void run(Worker& worker) {
    const rt::FaultStack stack;
    worker.task.runs_on(&this_job());
    parked_.fetch_add(1);
    while (gate_.load(std::memory_order_acquire) == 0) {
      rt::futex_wait_until(gate_, 0, rt::kForever);
    }
    while (!worker.quit.load(std::memory_order_relaxed)) step(worker.task);
    worker.task.runs_on(nullptr);
  }

  /// One look at the mailbox and at the clock; sleeps until there is something to do.
  void step(Task& task) {
    const std::uint32_t seen = task.command().load(std::memory_order_acquire);
    task.serve();
    if (task.due()) {  // a wait for the past would cost 15 us
      task.release();
    } else {
      rt::futex_wait_until(task.command(), seen,
                           task.running() ? task.next_release() : rt::kForever);
    }
  }

  MonotonicClock clock_;
  std::map<const Task*, std::unique_ptr<Worker>> workers_;
  std::atomic<std::size_t> parked_{0};
  std::atomic<std::uint32_t> gate_{0};
};

/// No threads: jobs run in the caller's thread in the order of release, then priority.
class Simulation final : public Runner {
 public:
  [[nodiscard]] const Clock& clock() const override { return clock_; }
  [[nodiscard]] Duration lead(std::size_t /*count*/) const override { return 1ms; }

  Status add(Task& task, const rt::ThreadAttributes& attributes) override {
    tasks_.push_back({&task, attributes.priority});
    return ok();
  }
  void open() override {}
  void wake(Task& task) override { task.serve(); }

  bool await(const std::function<bool()>& condition, Instant deadline) override {
    while (!condition()) {
      if (step(deadline)) continue;
      if (deadline != kNever) return condition();
      // No job is to come: only the time passes that the condition waits for.
      clock_.set(clock_.now() + std::chrono::nanoseconds(1ms).count());
      std::this_thread::sleep_for(20us);
    }
    return true;
  }

  [[nodiscard]] std::shared_ptr<void> hurry() override { return nullptr; }
  [[nodiscard]] bool is_fifo(const Task& /*task*/, int /*priority*/) const override {
    return false;
  }
  Status reschedule(Task& task, int priority, const std::vector<int>& /*cpus*/) override {
    for (Entry& entry : tasks_) {
      if (entry.task == &task) entry.priority = priority;
    }
    return ok();
  }
  bool end(Task& task, Instant /*deadline*/) override {
    std::erase_if(tasks_, [&](const Entry& entry) { return entry.task == &task; });
    return true;
  }
  void run_until(Instant instant) override {
    while (step(instant)) {
    }
    clock_.set(std::max(clock_.now(), instant));
  }

 private:
  struct Entry {
    Task* task;
    int priority;
  };

  /// Runs the first job due by `limit`; false when there is none.
  bool step(Instant limit) {
    const Entry* first = nullptr;
    for (const Entry& entry : tasks_) {
      if (entry.task->running() && (first == nullptr || before(entry, *first))) first = &entry;
    }
    if (first == nullptr || first->task->next_release() > limit) return false;
    clock_.set(std::max(clock_.now(), first->task->next_release()));
    first->task->release();
    return true;
  }
  static bool before(const Entry& a, const Entry& b) {
    const Instant due_a = a.task->next_release();
    const Instant due_b = b.task->next_release();
    return due_a != due_b ? due_a < due_b : a.priority > b.priority;
  }

  ManualClock clock_{1'000'000'000};
  std::vector<Entry> tasks_;
};

}  // namespace

std::unique_ptr<Runner> make_threads() { return std::make_unique<Threads>(); }
std::unique_ptr<Runner> make_simulation() { return std::make_unique<Simulation>(); }

}  // namespace mauve::exec
