// SPDX-License-Identifier: LGPL-3.0-or-later
/// The filter with its memory: measurements that come late, out of order, or are none at all.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "../../../plugins/localization/filter.h"
#include "../../../plugins/world/random.h"
#include "support/sanitized.h"

namespace localization {
namespace {

using rover::Imu;
using rover::Pose;
using rover::Twist;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kEndless = std::numeric_limits<double>::infinity();

double time_of(const Measurement& measurement) {
  return std::visit([](const auto& m) { return m.time; }, measurement);
}

Memory started(const Parameters& parameters) {
  Memory memory;
  start(begin(parameters, {}, 0.1, 0.05), memory);
  return memory;
}

/// Wheels, gyroscope and satellites of a robot that drives a circle; no two at the same time.
std::vector<Measurement> circle(double seconds) {
  std::vector<Measurement> measurements;
  world::Random random(7);
  for (int i = 0; i < static_cast<int>(seconds * 50); ++i) {
    const double time = 5.0 + i * 0.02;
    measurements.push_back(Twist{time, 1.0 + random.normal(0.05), 0.2 + random.normal(0.02)});
    measurements.push_back(Imu{time + 0.005, 0.2 + random.normal(0.01)});
    if (i % 10 != 0) continue;
    const double angle = 0.2 * (time + 0.01 - 5.0);
    measurements.push_back(Pose{time + 0.01, 5.0 * std::sin(angle) + random.normal(0.3),
                                5.0 - 5.0 * std::cos(angle) + random.normal(0.3), 0.3});
  }
  return measurements;
}

Memory filtered(const Parameters& parameters, const std::vector<Measurement>& measurements) {
  Memory memory = started(parameters);
  double now = 0.0;
  for (const Measurement& measurement : measurements) {
    now = std::max(now, time_of(measurement));
    add(parameters, measurement, now, 0.5, memory);
  }
  return memory;
}

TEST(Filter, EndsWhereItWouldInOrderWhenDataIsLate) {
  const Parameters parameters;
  const std::vector<Measurement> in_order = circle(30.0);
  std::vector<Measurement> late = in_order;
  world::Random random(8);
  std::vector<std::pair<double, std::size_t>> arrivals;
  for (std::size_t i = 0; i < late.size(); ++i) {
    arrivals.emplace_back(time_of(late[i]) + random.uniform(0.0, 0.4), i);
  }
  std::sort(arrivals.begin(), arrivals.end());
  for (std::size_t i = 0; i < late.size(); ++i) late[i] = in_order[arrivals[i].second];

  const Memory expected = filtered(parameters, in_order);
  const Memory actual = filtered(parameters, late);

  EXPECT_GT(actual.late, in_order.size() / 2);
  EXPECT_EQ(actual.too_late, 0u);
  EXPECT_EQ(actual.estimate.mean, expected.estimate.mean);
  EXPECT_EQ(actual.estimate.covariance, expected.estimate.covariance);
  EXPECT_EQ(actual.estimate.accepted, expected.estimate.accepted);
  EXPECT_EQ(actual.estimate.rejected, expected.estimate.rejected);
}

TEST(Filter, DropsWhatIsOlderThanTheWindow) {
  const Parameters parameters;
  Memory memory = filtered(parameters, circle(5.0));
  const Estimate before = memory.estimate;

  add(parameters, Pose{before.time - 0.6, 50.0, 50.0, 0.1}, before.time, 0.5, memory);

  EXPECT_EQ(memory.too_late, 1u);
  EXPECT_EQ(memory.late, 0u);
  EXPECT_EQ(memory.estimate.covariance, before.covariance);
}

TEST(Filter, DropsWhatIsOlderThanItsMemory) {
  const Parameters parameters;
  Memory memory = filtered(parameters, circle(10.0));  // far more than it remembers

  add(parameters, Pose{6.0, 50.0, 50.0, 0.1}, memory.estimate.time, 60.0, memory);

  EXPECT_EQ(memory.size, Memory::kCapacity);
  EXPECT_EQ(memory.too_late, 1u);
}

TEST(Filter, DropsTheTimeOfAnotherClockEvenAtFirst) {
  const Parameters parameters;
  Memory memory = started(parameters);

  add(parameters, Pose{4000.0, 50.0, 50.0, 0.1}, 16'000.0, 0.5, memory);

  EXPECT_EQ(memory.too_late, 1u);
  EXPECT_FALSE(memory.estimate.begun);
}

TEST(Filter, StandsAPositionThatClaimsToBePerfect) {
  const Parameters parameters;
  Memory memory = filtered(parameters, circle(5.0));
  const double now = memory.estimate.time;
  const rover::MotionState state = motion_state(memory.estimate);

  for (int i = 0; i < 100; ++i) {
    add(parameters, Pose{now, state.x, state.y, 1e-300}, now, 0.5, memory);
  }

  const rover::MotionState after = motion_state(memory.estimate);
  EXPECT_GT(after.variance_x, 0.0);
  EXPECT_GT(after.variance_x * after.variance_y, after.covariance_xy * after.covariance_xy);
}

TEST(Filter, PutsALateMeasurementInBeforeAFullMemoryForgets) {
  const Parameters parameters;
  std::vector<Measurement> measurements = circle(10.0);
  const std::size_t at = measurements.size() - Memory::kCapacity + 1;
  const Measurement delayed = measurements[at];
  measurements.erase(measurements.begin() + static_cast<std::ptrdiff_t>(at));
  Memory memory = filtered(parameters, measurements);

  add(parameters, delayed, memory.estimate.time, 60.0, memory);

  EXPECT_EQ(memory.late, 1u);
  EXPECT_EQ(memory.estimate.mean, filtered(parameters, circle(10.0)).estimate.mean);
}

TEST(Filter, IsNotMovedByAsking) {
  const Parameters parameters;
  const Memory memory = filtered(parameters, circle(5.0));
  const Estimate before = memory.estimate;

  for (int i = 0; i < 100; ++i) {
    static_cast<void>(predicted(parameters, before.time + i * 0.5 - 10.0, memory));
  }

  EXPECT_EQ(memory.estimate.time, before.time);
  EXPECT_EQ(memory.estimate.mean, before.mean);
  EXPECT_EQ(memory.estimate.covariance, before.covariance);
}

TEST(Filter, PredictsAlongTheArcAndRemembersThePast) {
  const Parameters parameters;
  const Memory memory = filtered(parameters, circle(20.0));
  const double now = memory.estimate.time;

  const Estimate ahead = predicted(parameters, now + 0.5, memory);
  const Estimate then = predicted(parameters, now - 0.2, memory);

  const double angle = 0.2 * (now + 0.5 - 5.0);
  EXPECT_NEAR(ahead.mean[kX], 5.0 * std::sin(angle), 0.4);
  EXPECT_NEAR(ahead.mean[kY], 5.0 - 5.0 * std::cos(angle), 0.4);
  EXPECT_GT(ahead.dispersion(), memory.estimate.dispersion());
  EXPECT_NEAR(then.time, now - 0.2, 1e-9);
  EXPECT_NEAR(std::hypot(ahead.mean[kX] - then.mean[kX], ahead.mean[kY] - then.mean[kY]), 0.7,
              0.05);
}

TEST(Filter, RefusesWhatIsNoMeasurementAndCountsIt) {
  const Parameters parameters;
  Memory memory = filtered(parameters, circle(5.0));
  const Estimate before = memory.estimate;
  const double now = before.time;
  const std::vector<Measurement> nonsense{Twist{now, kNoNumber, 0.0},
                                          Twist{now, 0.0, kEndless},
                                          Twist{kNoNumber, 0.0, 0.0},
                                          Twist{kEndless, 0.0, 0.0},
                                          Twist{now, 1e30, 0.0},
                                          Twist{now + 10.0, 0.0, 0.0},
                                          Imu{now, -kEndless},
                                          Imu{now, 0.0, 0, 0, kNoNumber, true},
                                          Pose{now, kNoNumber, 0.0, 1.0},
                                          Pose{now, 0.0, kNoNumber, 1.0},
                                          Pose{now, 0.0, 0.0, kNoNumber},
                                          Pose{now, 0.0, 0.0, -1.0},
                                          Pose{now, 1e300, 0.0, 1e300},
                                          Pose{-kEndless, 0.0, 0.0, 1.0}};

  for (const Measurement& measurement : nonsense) add(parameters, measurement, now, 0.5, memory);

  EXPECT_EQ(memory.refused, nonsense.size());
  EXPECT_EQ(memory.estimate.mean, before.mean);
  EXPECT_EQ(memory.estimate.covariance, before.covariance);
}

TEST(Filter, TakesAnAccelerometerThatIsBrokenForWhatItIs) {
  const Parameters parameters;
  Memory memory = started(parameters);

  add(parameters, Imu{1.0, 0.1, kNoNumber, kNoNumber, kNoNumber, false}, 1.0, 0.5,
      memory);  // not looked at

  EXPECT_EQ(memory.refused, 0u);
  EXPECT_TRUE(std::isfinite(memory.estimate.mean[kTurn]));
}

TEST(Filter, StandsTimeThatStopsAndTimeThatRunsBack) {
  const Parameters parameters;
  Memory memory = started(parameters);
  for (int i = 0; i < 1000; ++i) add(parameters, Twist{5.0, 0.5, 0.1}, 5.0, 0.5, memory);
  const double spread = memory.estimate.dispersion();
  for (int i = 0; i < 1000; ++i) {
    add(parameters, Twist{5.0 - i * 0.01, 0.5, 0.1}, 5.0 - i * 0.01, 0.5, memory);
  }

  EXPECT_EQ(memory.estimate.time, 5.0);
  EXPECT_NEAR(memory.estimate.mean[kX], 0.0, 0.01);
  EXPECT_NEAR(memory.estimate.dispersion(), spread, 1e-6);
  EXPECT_GT(memory.too_late, 900u);
}

TEST(Filter, GoesOnAfterAVeryLongSilence) {
  const Parameters parameters;
  Memory memory = filtered(parameters, circle(5.0));
  const double later = memory.estimate.time + 1e7;

  add(parameters, Twist{later, 0.0, 0.0}, later, 0.5, memory);
  EXPECT_GT(memory.estimate.dispersion(), 10.0);
  for (int i = 1; i <= 50; ++i) {
    add(parameters, Twist{later + i * 0.1, 0.0, 0.0}, later + i * 0.1, 0.5, memory);
    add(parameters, Pose{later + i * 0.1, 3.0, 4.0, 0.3}, later + i * 0.1, 0.5, memory);
  }

  EXPECT_NEAR(memory.estimate.mean[kX], 3.0, 0.3);
  EXPECT_NEAR(memory.estimate.mean[kY], 4.0, 0.3);
  EXPECT_LT(memory.estimate.dispersion(), 0.3);
}

TEST(Filter, RunsForADayWithoutSatellites) {
  const Parameters parameters;
  Memory memory = started(parameters);
  const double start = 1e6;  // a machine that has been up for days
  constexpr int kSeconds = support::kSanitized ? 3'600 : 86'400;
  for (int i = 0; i < 2 * kSeconds; ++i) {
    const double time = start + i * 0.5;
    correct(parameters, Twist{time, i % 600 < 300 ? 0.5 : 0.0, 0.05}, memory.estimate);
  }
  const rover::MotionState state = motion_state(memory.estimate);

  EXPECT_TRUE(std::isfinite(state.x) && std::isfinite(state.y));
  EXPECT_LE(std::abs(state.heading), 3.1416);
  EXPECT_GT(state.variance_x * state.variance_y, state.covariance_xy * state.covariance_xy);
  EXPECT_LT(state.variance_x, 1.1e8);
  add(parameters, Pose{start + kSeconds, 10.0, 10.0, 0.3}, start + kSeconds, 0.5, memory);
  EXPECT_LT(memory.estimate.dispersion(), 0.4);
}

}  // namespace
}  // namespace localization
