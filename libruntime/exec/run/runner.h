// SPDX-License-Identifier: LGPL-3.0-or-later
/// Runner: runs the tasks. Threads on the monotonic clock, or a simulation on a manual one.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rt/machine/noise.h"
#include "rt/thread/thread.h"

#include <mauve/host/clock.h>
#include <mauve/host/machine.h>
#include <mauve/result.h>

namespace mauve {
class CoreBase;
}  // namespace mauve

namespace mauve::exec {

class Task;

class Runner {
 public:
  virtual ~Runner() = default;

  [[nodiscard]] virtual const Clock& clock() const = 0;
  [[nodiscard]] Instant now() const { return clock().now(); }
  /// The noise of the machine, as probes see it; null: time is simulated.
  [[nodiscard]] virtual std::shared_ptr<const rt::Noise> noise() const { return nullptr; }
  /// Creates the thread of the task, or its place in a simulation, parked until open(). The task
  /// outlives the runner.
  virtual Status add(Task& task, const rt::ThreadAttributes& attributes) = 0;
  /// Waits until everything that was added is parked.
  virtual void settle() {}
  /// Lets all tasks go; each knows its T0 by now.
  virtual void open() = 0;
  /// How long it takes to start `count` tasks.
  [[nodiscard]] virtual Duration lead(std::size_t count) const = 0;
  /// Makes the task look at its mailbox soon.
  virtual void wake(Task& task) = 0;
  /// Waits until the condition holds; false when `deadline` passed first.
  virtual bool await(const std::function<bool()>& condition, Instant deadline) = 0;
  /// While the answer lives, the caller is scheduled before ordinary threads.
  [[nodiscard]] virtual std::shared_ptr<void> raise_priority() = 0;
  /// Does this task run with SCHED_FIFO at this priority?
  [[nodiscard]] virtual bool is_fifo(const Task& task, int priority) const = 0;
  /// Gives its thread another priority (0: not real-time) and other CPUs.
  virtual Status reschedule(Task& task, int priority, const std::vector<int>& cpus) = 0;
  /// Ends the task's thread; false when it does not end by `deadline` and was abandoned.
  virtual bool end(Task& task, Instant deadline) = 0;
  /// The time bound of a job has changed, so the guard of the threads looks again.
  virtual void look_again() {}
  /// May abandoned threads still be in elements of this task, or in this core? Null: in any?
  [[nodiscard]] virtual bool has_abandoned(const Task* /*task*/ = nullptr,
                                           const CoreBase* /*core*/ = nullptr) const {
    return false;
  }
  /// Processor time that the thread of the task used since it began; none: time is simulated.
  [[nodiscard]] virtual std::optional<Duration> processor_time(const Task& /*task*/) const {
    return std::nullopt;
  }
  /// Its thread neither runs nor waits for a processor; reads a file of the system.
  [[nodiscard]] virtual bool is_asleep(const Task& /*task*/) const { return false; }
  /// Simulations: runs all jobs due by then.
  virtual void run_until(Instant /*instant*/) {}
};

[[nodiscard]] std::unique_ptr<Runner> make_simulation();

}  // namespace mauve::exec
