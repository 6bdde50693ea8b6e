// SPDX-License-Identifier: LGPL-3.0-or-later
/// SteppedClock: the monotonic clock, moved forward from release to release, so that jobs run back
/// to back, in time, and without the sleep between them.
#pragma once

#include <mauve/host/clock.h>

namespace bench {

class SteppedClock final : public mauve::Clock {
 public:
  [[nodiscard]] mauve::Instant now() const override { return real_.now() + ahead_; }
  /// It shows `instant` now.
  void set(mauve::Instant instant) { ahead_ = instant - real_.now(); }
  void step(mauve::Duration duration) { ahead_ += duration.count(); }

 private:
  mauve::MonotonicClock real_;
  mauve::Instant ahead_ = 0;
};

}  // namespace bench
