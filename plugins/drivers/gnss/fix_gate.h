// SPDX-License-Identifier: LGPL-3.0-or-later
/// Distinguishes positions that can be from such that cannot: the rare sentence whose damage its
/// checksum does not show.
#pragma once

#include "../../types/gnss.h"

namespace drivers {

/// The knowledge about a fix beside the fix itself.
struct FixContext {
  double separation = 0.0;      ///< m, geoid above ellipsoid, or another value that stays as it is
  bool confirmed = false;       ///< another sentence had the same time and place
  bool denied = false;          ///< another sentence had another place; before, they agreed
  bool dilution_known = false;  ///< another sentence had the same dilution
  bool damage = false;          ///< damaged frames came lately: odd values are suspect
};

/// A fix and when it came.
struct TimedFix {
  rover::GnssFix fix;
  double now = 0.0;
  FixContext context;
};

/// A fix is refused when the receiver would have moved faster than the limit since the last
/// admitted one, or when its time is out of step with ours. A refused fix can be right (a wrong
/// first fix, a long tunnel): three in a row that agree with each other are the truth from then on.
///
/// On a line that damages its frames a fix is also refused when any value in it differs from that
/// which the last ones let expect. Two fixes in a row that agree that closely are the truth, and so
/// is the first. An undamaged line never loses a fix that way. All of it is [rt].
class FixGate {
 public:
  static constexpr int kPersists = 3;     ///< that many agree: not damage
  static constexpr int kFaithful = 2;     ///< that many agree closely: neither
  static constexpr double kNoise = 10.0;  ///< m a receiver may jump in no time
  static constexpr double kInStep = 2.5;  ///< s between the receiver's clock and ours
  static constexpr int kStubborn = 6;     ///< that many: as good, on a line that does damage

  /// `now` in seconds of a clock that never jumps; `limit` in m/s, 0 lets everything through. A fix
  /// without position shows no movement and passes; of a damaged line, the second one.
  bool admit(const rover::GnssFix& fix, double now, double limit, const FixContext& context = {});

 private:
  [[nodiscard]] bool plausible(const TimedFix& mark, double limit) const;
  [[nodiscard]] bool persists(const TimedFix& mark, double limit) const;
  [[nodiscard]] bool in_step(const TimedFix& mark) const;
  [[nodiscard]] bool expected(const TimedFix& from, const TimedFix& mark) const;
  [[nodiscard]] bool expected_place(const TimedFix& from, const TimedFix& mark) const;
  [[nodiscard]] bool expected_time(const TimedFix& from, const TimedFix& mark) const;
  void learn(const TimedFix& mark);
  void accept(const TimedFix& mark);

  TimedFix last_;       // let through
  TimedFix rival_;      // refused last
  TimedFix anchor_;     // where the comparison of both clocks began
  double north_ = 0.0;  // deg/s from the last fix but one to the last
  double east_ = 0.0;
  double pace_ = 0.0;  // s between two epochs, the shortest seen; 0: not known
  int rivals_ = 0;
  int faithful_ = 0;  // rivals in a row that agree closely
  int blank_ = 0;     // fixes in a row without position
  bool begun_ = false;
  bool live_ = false;  // our clock runs as fast as the receiver's: no recording in fast motion
};

}  // namespace drivers
