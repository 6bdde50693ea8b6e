// SPDX-License-Identifier: LGPL-3.0-or-later
/// JobMeter: the time that a job takes: on the clock, on the processor, and held up by the machine.
/// Owned by the thread of a task. [rt]
#pragma once

#include <memory>
#include <optional>

#include "exec/task/counters.h"
#include "exec/task/evidence.h"
#include "rt/machine/noise.h"
#include "rt/time/measured.h"
#include "rt/time/ticks.h"

#include <mauve/host/clock.h>
#include <mauve/time.h>

namespace mauve {

struct TaskAttributes;

namespace exec {

class JobMeter {
 public:
  /// `simulated`: the clock of a simulation; null: the time is that of the machine. `noise`: the
  /// noise of the machine; null: it is not known.
  JobMeter(const Clock* simulated, std::shared_ptr<const rt::Noise> noise);

  /// A job begins; its times are added to `times`. Its processor time is read where it is needed:
  /// `on_probation`, or without a budget.
  void begin(rt::JobTimes& times, Instant start, Duration lateness, bool on_probation,
             bool has_budget);
  /// The job ended. Returns the processor time of the job itself, without the threads that
  /// preempted it and without the time that the host reports as stolen. None: the job was
  /// preempted, and its processor time was not read.
  [[nodiscard]] std::optional<Duration> end(const JobUse& job, bool preempted, bool on_probation,
                                            Counters& counters);
  /// The timing that the core is judged by. `wait`: from its release to the next one.
  [[nodiscard]] JobTiming timing_of(const JobUse& job, const TaskAttributes& task, Duration wait);
  /// Did the job take longer than this while the machine ran? Where its processor time is not
  /// known, the time from start to end stands in for it, but only where a probe saw the machine
  /// run.
  [[nodiscard]] bool took_long(const JobUse& job, Duration limit) const;

  /// The time at which a state ends, read once for each of them.
  [[nodiscard]] Instant now() const {
    return simulated_ == nullptr ? rt::fast_now() : simulated_->now();
  }
  [[nodiscard]] rt::JobTimes& times() { return *times_; }
  /// Whether another thread preempted the last job; never in a simulation.
  [[nodiscard]] bool was_preempted() const { return preempted_ && simulated_ == nullptr; }

 private:
  [[nodiscard]] Duration held_up_since(Instant instant) const {
    return noise_ == nullptr ? Duration{0} : noise_->held_up_since(instant);
  }
  [[nodiscard]] Duration excuse(Instant released, Instant end);

  static constexpr std::int64_t kUnknown = -1;

  const Clock* const simulated_;
  const std::shared_ptr<const rt::Noise> noise_;
  rt::JobTimes* times_ = nullptr;
  Duration excused_{0};        // for so long the machine was held up during the job before
  Instant excused_until_ = 0;  // jobs released before this instant wait behind that one
  std::int64_t waits_before_ = kUnknown;  // of the thread, before the job, on probation
  Duration cpu_before_{0};  // of this thread, when the job began; zero: it was not read
  bool preempted_ = false;  // the last job was
};

}  // namespace exec
}  // namespace mauve
