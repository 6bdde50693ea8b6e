// SPDX-License-Identifier: LGPL-3.0-or-later
#include "fix_gate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace drivers {
namespace {

using rover::GnssFix;

constexpr double kDayLength = 86'400.0;
constexpr double kRadius = 6'371'000.0;  // m, of the earth
constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kCompare = 5.0;  // s until both clocks are compared

// The limits beyond which a fix is suspect, on a line that damages its frames.
constexpr double kStray = 0.5;  // m from where it was going, and half as much each second
constexpr double kTurn = 0.3;   // of the way
constexpr double kRise = 1.0;   // m of height, and as much each second
constexpr double kSame = 0.05;  // m of the geoid
constexpr double kHole = 30.0;  // s without a fix

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

bool FixGate::admit(const GnssFix& fix, double now, double limit, const FixContext& context) {
  if (limit <= 0.0) return true;
  if (fix.mode < 2) return ++blank_ > 1 || !begun_ || !context.damage;
  blank_ = 0;
  const TimedFix mark{fix, now, context};
  if (plausible(mark, limit)) {
    accept(mark);
    return true;
  }
  // Of the clocks nothing is asked here: the line itself may have changed its pace.
  faithful_ = rivals_ > 0 && expected(rival_, mark) ? faithful_ + 1 : 1;
  rivals_ = rivals_ > 0 && reachable(rival_, mark, limit) ? rivals_ + 1 : 1;
  rival_ = mark;
  if (!persists(mark, limit)) return false;
  if (!begun_ || !reachable(last_, mark, limit) || !in_step(mark)) begun_ = false;
  accept(mark);
  return true;
}

bool FixGate::plausible(const TimedFix& mark, double limit) const {
  if (!begun_) return !mark.context.damage;
  if (!in_step(mark) || !reachable(last_, mark, limit) || mark.context.denied) return false;
  return !mark.context.damage || expected(last_, mark);
}

bool FixGate::persists(const TimedFix& mark, double limit) const {
  if (rivals_ >= (mark.context.damage ? kStubborn : kPersists)) return true;
  const bool near = !begun_ || (reachable(last_, mark, limit) && in_step(mark));
  return near && faithful_ >= kFaithful;
}

bool FixGate::in_step(const TimedFix& mark) const {
  // A receiver that was silent for half a day or more cannot be compared by its time of day.
  return !live_ || std::abs(std::remainder(between(last_, mark) - (mark.now - last_.now),
                                           kDayLength)) <= kInStep;
}

bool FixGate::expected(const TimedFix& from, const TimedFix& mark) const {
  const double more = 1.0 + std::abs(between(from, mark)) / 2.0;
  const double dilution = mark.fix.hdop / std::max(from.fix.hdop, 0.1);
  return mark.fix.mode == from.fix.mode &&
         std::abs(mark.context.separation - from.context.separation) < kSame &&
         std::abs(mark.fix.satellites - from.fix.satellites) <= more &&
         (mark.context.dilution_known || (dilution > 0.6 && dilution < 1.7)) &&
         expected_time(from, mark) && expected_place(from, mark);
}

/// On from the fix before at its speed, to a metre or so. Nothing confirms a height.
bool FixGate::expected_place(const TimedFix& from, const TimedFix& mark) const {
  const double elapsed = std::abs(between(from, mark));
  if (mark.fix.mode == 3 &&
      std::abs(mark.fix.altitude - from.fix.altitude) > kRise * (1.0 + elapsed)) {
    return false;
  }
  if (mark.context.confirmed) return true;
  GnssFix guess = mark.fix;  // at its height
  guess.latitude = from.fix.latitude + north_ * elapsed;
  guess.longitude = from.fix.longitude + east_ * elapsed;
  GnssFix rest = guess;
  rest.latitude = from.fix.latitude;
  rest.longitude = from.fix.longitude;
  const double way = distance(rest, guess);
  return distance(guess, mark.fix) <= kStray * (1.0 + elapsed / 2.0) + kTurn * way;
}

bool FixGate::expected_time(const TimedFix& from, const TimedFix& mark) const {
  if (mark.context.confirmed || from.fix.time == 0.0) return true;
  if (mark.fix.time == 0.0) return false;
  const double elapsed = between(from, mark);
  return elapsed > 0.0 && elapsed < kHole &&
         (pace_ == 0.0 || std::abs(std::remainder(elapsed, pace_)) < 1e-3);
}

void FixGate::learn(const TimedFix& mark) {
  const double elapsed = between(last_, mark);
  if (elapsed <= 0.0 || last_.fix.time == 0.0 || mark.fix.time == 0.0) return;
  north_ = (mark.fix.latitude - last_.fix.latitude) / elapsed;
  east_ = std::remainder(mark.fix.longitude - last_.fix.longitude, 360.0) / elapsed;
  if (pace_ == 0.0 || elapsed < pace_) pace_ = std::min(elapsed, 1.0);
}

void FixGate::accept(const TimedFix& mark) {
  if (begun_) {
    learn(mark);
  } else {
    anchor_ = mark;
    live_ = false;
    north_ = east_ = pace_ = 0.0;
  }
  begun_ = true;
  rivals_ = faithful_ = 0;
  last_ = mark;
  const double received = step(anchor_.fix.time, mark.fix.time);
  if (std::abs(received) < kCompare) return;
  live_ = std::abs((mark.now - anchor_.now) / received - 1.0) < 0.25;
  anchor_ = mark;
}

}  // namespace drivers
