// SPDX-License-Identifier: LGPL-3.0-or-later
/// Silence: an element that works as it is asked, and has nothing to publish, says so and why.
#pragma once

#include <cstddef>

#include <mauve/element.h>

namespace rover {

/// Of a core that publishes at least once in `silent_after`. The warning `silent` lasts from then
/// on until the next value (`imu.core.silent == true` in a condition). All of it but the
/// constructor is [rt], by one thread at a time: that of the component, or of a service.
class Silence {
 public:
  explicit Silence(mauve::Configurable& core)
      : after_{core,
               "silent_after",
               mauve::Duration{5'000'000'000},
               "without a value for so long: warning `silent`",
               {.min = mauve::Duration{1'000'000}, .max = {}}},
        silent_{core, "silent", "it has nothing to publish; the log says why"} {}

  /// A value was published.
  void ended() {
    since_ = mauve::job_time();
    silent_.end("it publishes again");
  }
  /// Called in jobs without a value. `reason` is the present one.
  template <std::size_t N>
  void look(const char (&reason)[N], mauve::LogArgument a = {}, mauve::LogArgument b = {}) {
    const mauve::Instant now = mauve::job_time();
    if (since_ == 0) since_ = now;  // the first job after a change
    if (now - since_ >= after_.get().count()) silent_.begin(reason, a, b);
  }

 private:
  mauve::Property<mauve::Duration> after_;
  mauve::Warning silent_;
  mauve::Instant since_ = 0;
};

}  // namespace rover
