// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../../../plugins/teleop/selection.h"
#include "../../../plugins/teleop/steering.h"

namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using rover::Joystick;
using rover::Velocity;
using teleop::choose;
using teleop::Controls;
using teleop::hear;
using teleop::Source;
using teleop::Sources;
using teleop::steer;
using teleop::Timeouts;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

Joystick held(float left, float forward, std::int32_t buttons = 1) {
  Joystick joystick;
  joystick.axes.push_back(left);
  joystick.axes.push_back(forward);
  joystick.buttons = buttons;
  joystick.connected = true;
  return joystick;
}

TEST(Steering, ScalesTheAxesToTheGreatestSpeeds) {
  const auto wanted = steer(held(-1.0F, 1.0F), {.max_linear = 0.7, .max_angular = 1.5});

  ASSERT_TRUE(wanted);
  EXPECT_DOUBLE_EQ(wanted->linear, 0.7);
  EXPECT_DOUBLE_EQ(wanted->angular, -1.5);
}

TEST(Steering, RestsInTheDeadZoneAndStartsSmoothlyAtItsEdge) {
  const Controls controls{.dead_zone = 0.2, .max_linear = 1.0};

  EXPECT_DOUBLE_EQ(steer(held(0.0F, 0.199F), controls)->linear, 0.0);
  EXPECT_NEAR(steer(held(0.0F, 0.21F), controls)->linear, 0.0125, 1e-6);
  EXPECT_NEAR(steer(held(0.0F, -0.6F), controls)->linear, -0.5, 1e-6);
}

TEST(Steering, WantsNothingWithoutJoystickOrDeadManButton) {
  Joystick gone = held(0.0F, 1.0F);
  gone.connected = false;

  EXPECT_FALSE(steer(gone, {}));
  EXPECT_FALSE(steer(held(0.0F, 1.0F, 0), {}));
  EXPECT_FALSE(steer(held(0.0F, 1.0F, 1), {.dead_man = 4}));
  EXPECT_TRUE(steer(held(0.0F, 1.0F, 1 << 4), {.dead_man = 4}));
  EXPECT_TRUE(steer(held(0.0F, 1.0F, std::numeric_limits<std::int32_t>::min()), {.dead_man = 31}));
}

TEST(Steering, HoldsTheRobotWithTheButtonAlone) {
  const auto wanted = steer(held(0.0F, 0.0F), {});

  ASSERT_TRUE(wanted);
  EXPECT_DOUBLE_EQ(wanted->linear, 0.0);
}

TEST(Steering, SteersByMovingAnAxisWhereThereIsNoDeadManButton) {
  EXPECT_FALSE(steer(held(0.05F, 0.05F, 0), {.dead_man = -1}));
  EXPECT_TRUE(steer(held(0.5F, 0.0F, 0), {.dead_man = -1}));
}

TEST(Steering, RestsOnWhatIsNoNumberAndNeverExceedsAFullAxis) {
  EXPECT_DOUBLE_EQ(steer(held(kNan, kInfinite), {})->linear, 0.0);
  EXPECT_DOUBLE_EQ(steer(held(kNan, kInfinite), {})->angular, 0.0);
  EXPECT_DOUBLE_EQ(steer(held(0.0F, 1e30F), {.max_linear = 0.5})->linear, 0.5);
  EXPECT_FALSE(steer(held(kNan, kNan, 0), {.dead_man = -1}));
}

TEST(Steering, RestsOnAxesThatTheJoystickDoesNotHave) {
  const auto wanted = steer(held(1.0F, 1.0F), {.linear_axis = 7, .angular_axis = -3});

  ASSERT_TRUE(wanted);
  EXPECT_DOUBLE_EQ(wanted->linear, 0.0);
  EXPECT_DOUBLE_EQ(wanted->angular, 0.0);
}

constexpr mauve::Instant kMs = 1'000'000;

TEST(Selection, ChoosesNobodyWhileNobodySpoke) {
  EXPECT_EQ(choose(Sources{}, {}, 0), Source::none);
  EXPECT_FALSE(said_by(Source::none, {}));
}

TEST(Selection, PrefersTeleopWhileItSpeaks) {
  Sources sources;
  ASSERT_TRUE(hear(sources.command, {0.5, 0.0}, 0));
  ASSERT_TRUE(hear(sources.teleop, {0.0, 1.0}, 100 * kMs));

  EXPECT_EQ(choose(sources, {}, 100 * kMs), Source::teleop);
  EXPECT_DOUBLE_EQ(said_by(Source::teleop, sources)->angular, 1.0);
  EXPECT_DOUBLE_EQ(said_by(Source::command, sources)->linear, 0.5);
}

TEST(Selection, LetsASilentSourceLoseRightAfterItsTimeOut) {
  const Timeouts timeouts{.teleop = 100ms, .command = 300ms};
  Sources sources;
  ASSERT_TRUE(hear(sources.teleop, {}, 0));
  ASSERT_TRUE(hear(sources.command, {}, 0));

  EXPECT_EQ(choose(sources, timeouts, 100 * kMs), Source::teleop);
  EXPECT_EQ(choose(sources, timeouts, 100 * kMs + 1), Source::command);
  EXPECT_EQ(choose(sources, timeouts, 300 * kMs), Source::command);
  EXPECT_EQ(choose(sources, timeouts, 300 * kMs + 1), Source::none);
}

TEST(Selection, HearsWhatWasWrittenAfterTheReadersJobBegan) {
  Sources sources;
  ASSERT_TRUE(hear(sources.teleop, {}, 10 * kMs));

  EXPECT_EQ(choose(sources, {}, 9 * kMs), Source::teleop);
}

TEST(Selection, DoesNotBelieveAWordFromTheFarFuture) {
  Sources sources;
  ASSERT_TRUE(hear(sources.teleop, {}, 1'000 * kMs));

  EXPECT_EQ(choose(sources, {}, 9 * kMs), Source::none);
}

TEST(Selection, DoesNotHearWhatIsNoNumber) {
  Sources sources;

  EXPECT_FALSE(hear(sources.teleop, {std::nan(""), 0.0}, 0));
  EXPECT_FALSE(hear(sources.teleop, {0.0, std::numeric_limits<double>::infinity()}, 0));
  EXPECT_EQ(choose(sources, {}, 0), Source::none);
}

}  // namespace
