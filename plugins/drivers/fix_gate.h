// SPDX-License-Identifier: LGPL-3.0-or-later
/// Tells positions that can be from such that cannot: the rare sentence whose damage its checksum
/// does not show.
#pragma once

#include "../types/gnss.h"

namespace drivers {

/// A fix and when it came.
struct TimedFix {
  rover::GnssFix fix;
  double now = 0.0;
};

/// A fix is refused when the receiver would have moved faster than the limit since the last one
/// that was let through, or when its time is out of step with ours. What is refused can be right (a
/// wrong first fix, a long tunnel): three in a row that agree with each other are the truth from
/// then on. All of it is [rt].
class FixGate {
 public:
  static constexpr int kPersists = 3;     ///< that many agree: not damage
  static constexpr double kNoise = 10.0;  ///< m a receiver may jump in no time
  static constexpr double kInStep = 2.5;  ///< s between the receiver's clock and ours

  /// `now` in seconds of a clock that never jumps; `limit` in m/s, 0 lets everything through. A fix
  /// without position says nothing of movement and passes.
  bool admit(const rover::GnssFix& fix, double now, double limit);

 private:
  [[nodiscard]] bool in_step(const TimedFix& mark) const;
  void accept(const TimedFix& mark);

  TimedFix last_;    // let through
  TimedFix rival_;   // refused last
  TimedFix anchor_;  // where the comparison of both clocks began
  int rivals_ = 0;
  bool begun_ = false;
  bool live_ = false;  // our clock runs as fast as the receiver's: no recording in fast motion
};

}  // namespace drivers
