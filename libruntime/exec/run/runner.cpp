// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/run/runner.h"

#include <algorithm>
#include <thread>

#include "exec/task/task.h"
#include "exec/update/decision.h"

namespace mauve::exec {
namespace {

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
  void wake(Task& task) override { static_cast<void>(task.serve()); }

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

  [[nodiscard]] std::shared_ptr<void> raise_priority() override { return nullptr; }
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
    first->task->run_release();
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

std::unique_ptr<Runner> make_simulation() { return std::make_unique<Simulation>(); }

}  // namespace mauve::exec
