// SPDX-License-Identifier: LGPL-3.0-or-later
#include "fix_gate.h"

#include <cmath>
#include <numbers>

namespace drivers {
namespace {

using rover::GnssFix;

constexpr double kDayLength = 86'400.0;
constexpr double kRadius = 6'371'000.0;  // m, of the earth
constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kCompare = 5.0;  // s until both clocks are compared

/// Metres between two fixes: good for jumps, not for surveys.
double distance(const GnssFix& a, const GnssFix& b) {
  const double turn = std::remainder(b.longitude - a.longitude, 360.0);
  const double north = (b.latitude - a.latitude) * kRadians * kRadius;
  const double east = turn * std::cos(a.latitude * kRadians) * kRadians * kRadius;
  const double up = a.mode == 3 && b.mode == 3 ? b.altitude - a.altitude : 0.0;
  return std::hypot(north, east, up);
}

/// Seconds from one time of day to another, at most half a day either way.
double step(double from, double to) { return std::remainder(to - from, kDayLength); }

/// Seconds between two fixes; by our clock when the receiver does not know the time.
double between(const TimedFix& from, const TimedFix& to) {
  if (from.fix.time == 0.0 || to.fix.time == 0.0) return to.now - from.now;
  return step(from.fix.time, to.fix.time);
}

bool reachable(const TimedFix& from, const TimedFix& to, double limit) {
  return distance(from.fix, to.fix) <= limit * std::abs(between(from, to)) + FixGate::kNoise;
}

}  // namespace

bool FixGate::admit(const GnssFix& fix, double now, double limit) {
  if (limit <= 0.0 || fix.mode < 2) return true;
  const TimedFix mark{fix, now};
  if (!begun_ || (in_step(mark) && reachable(last_, mark, limit))) {
    accept(mark);
    return true;
  }
  // Of the clocks nothing is asked here: the line itself may have changed its pace.
  rivals_ = rivals_ > 0 && reachable(rival_, mark, limit) ? rivals_ + 1 : 1;
  rival_ = mark;
  if (rivals_ < kPersists) return false;
  begun_ = false;
  accept(mark);
  return true;
}

bool FixGate::in_step(const TimedFix& mark) const {
  // A receiver that was silent for half a day or more cannot be compared by its time of day.
  return !live_ || std::abs(std::remainder(between(last_, mark) - (mark.now - last_.now),
                                           kDayLength)) <= kInStep;
}

void FixGate::accept(const TimedFix& mark) {
  if (!begun_) {
    anchor_ = mark;
    live_ = false;
  }
  begun_ = true;
  rivals_ = 0;
  last_ = mark;
  const double received = step(anchor_.fix.time, mark.fix.time);
  if (std::abs(received) < kCompare) return;
  live_ = std::abs((mark.now - anchor_.now) / received - 1.0) < 0.25;
  anchor_ = mark;
}

}  // namespace drivers
