// SPDX-License-Identifier: LGPL-3.0-or-later
#include "filter.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace localization {
namespace {

static_assert(std::is_trivially_copyable_v<Memory>, "is handed over as bytes");

constexpr double kFarthest = 1e8;  // m
constexpr double kFastest = 1e3;   // m/s
constexpr double kQuickest = 1e2;  // rad/s
constexpr double kOldest = 60.0;   // s; beyond it the time is of another clock

bool within(double value, double limit) { return std::abs(value) <= limit; }  // false for NaN

bool sane(const rover::Twist& twist) {
  return within(twist.linear, kFastest) && within(twist.angular, kQuickest);
}
bool sane(const rover::Imu& imu) {
  return within(imu.yaw_rate, kQuickest) && (!imu.has_heading || within(imu.heading, kQuickest));
}
bool sane(const rover::Pose& pose) {
  return within(pose.x, kFarthest) && within(pose.y, kFarthest) && pose.deviation >= 0.0 &&
         within(pose.deviation, kFarthest);
}

double time_of(const Measurement& measurement) {
  return std::visit([](const auto& m) { return m.time; }, measurement);
}

void step(const Parameters& p, const Measurement& measurement, Estimate& estimate) {
  std::visit([&](const auto& m) { correct(p, m, estimate); }, measurement);
}

/// How many entries are not later than the time.
std::size_t count_until(const Memory& memory, double time) {
  std::size_t count = memory.size;
  while (count > 0 && time_of(memory.at(count - 1).measurement) > time) --count;
  return count;
}

void forget_oldest(Memory& memory) {
  memory.before = memory.at(0).after;
  memory.first = (memory.first + 1) % Memory::kCapacity;
  --memory.size;
}

/// Puts the measurement behind `count` entries and goes through those after it again.
void replay(const Parameters& p, const Measurement& measurement, std::size_t count,
            Memory& memory) {
  memory.estimate = count > 0 ? memory.at(count - 1).after : memory.before;
  if (memory.size == Memory::kCapacity) {
    forget_oldest(memory);
    --count;
  }
  for (std::size_t i = memory.size; i > count; --i) {
    memory.at(i).measurement = memory.at(i - 1).measurement;
  }
  ++memory.size;
  memory.at(count).measurement = measurement;
  for (std::size_t i = count; i < memory.size; ++i) {
    step(p, memory.at(i).measurement, memory.estimate);
    memory.at(i).after = memory.estimate;
  }
}

}  // namespace

void start(const Estimate& estimate, Memory& memory) {
  memory.before = memory.estimate = estimate;
  memory.first = memory.size = 0;
}

void add(const Parameters& p, const Measurement& measurement, double now, double window,
         Memory& memory) {
  const double time = time_of(measurement);
  const bool sound = std::visit([](const auto& m) { return sane(m); }, measurement);
  if (!sound || !within(time - now, kFarthest) || time > now + window) {
    ++memory.refused;
    return;
  }
  if (time < now - kOldest) {
    ++memory.too_late;
    return;
  }
  const std::size_t count = count_until(memory, time);
  if (count < memory.size) {
    const bool forgotten = count == 0 && (memory.before.begun || memory.size == Memory::kCapacity);
    if (forgotten || time < memory.estimate.time - window) {
      ++memory.too_late;
      return;
    }
    ++memory.late;
  }
  replay(p, measurement, count, memory);
}

Estimate predicted(const Parameters& p, double time, const Memory& memory) {
  Estimate estimate = memory.estimate;
  if (time < estimate.time) {
    const std::size_t count = count_until(memory, time);
    estimate = count > 0 ? memory.at(count - 1).after : memory.before;
  }
  if (estimate.begun) advance(p, time, estimate);
  return estimate;
}

}  // namespace localization
