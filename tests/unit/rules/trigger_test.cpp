// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rules/trigger.h"

#include <gtest/gtest.h>

namespace mauve::rules {
namespace {

using namespace std::chrono_literals;  // NOLINT: durations

/// A trigger and the time it is looked at.
struct Watch {
  Trigger trigger;
  Instant now = 1'000'000'000;

  /// Looks after some time; `rearm` is the opposite of the condition.
  bool after(Duration passed, Truth when) { return after(passed, when, !when); }
  bool after(Duration passed, Truth when, Truth rearm) {
    now += passed.count();
    return trigger.step(now, when, rearm);
  }
  bool held_after(Duration passed) {
    now += passed.count();
    return trigger.step(now, Truth::yes, Truth::no, false);
  }
};

TEST(Trigger, FiresAtOnceWithoutATimeToHold) {
  Watch watch{Trigger({0ms, 1s, 60})};

  EXPECT_FALSE(watch.after(10ms, Truth::no));
  EXPECT_TRUE(watch.after(10ms, Truth::yes));
  EXPECT_EQ(watch.trigger.state(), State::fired);
  EXPECT_EQ(watch.trigger.last(), watch.now);
}

TEST(Trigger, FiresOnceTheConditionHeldForItsTime) {
  Watch watch{Trigger({2s, 1s, 60})};

  EXPECT_FALSE(watch.after(0s, Truth::yes));
  EXPECT_EQ(watch.trigger.state(), State::holding);
  EXPECT_FALSE(watch.after(1'999ms, Truth::yes));
  EXPECT_EQ(watch.trigger.held(watch.now), 1'999ms);
  EXPECT_TRUE(watch.after(1ms, Truth::yes));
  EXPECT_FALSE(watch.after(10s, Truth::yes)) << "only once";
  EXPECT_EQ(watch.trigger.times(), 1U);
}

TEST(Trigger, BeginsToCountAgainWhenTheConditionBreaksOrIsUnknown) {
  for (const Truth broken : {Truth::no, Truth::unknown}) {
    Watch watch{Trigger({2s, 1s, 60})};
    EXPECT_FALSE(watch.after(0s, Truth::yes));
    EXPECT_FALSE(watch.after(1s, broken));
    EXPECT_EQ(watch.trigger.state(), State::armed);
    EXPECT_FALSE(watch.after(1s, Truth::yes));
    EXPECT_FALSE(watch.after(1s, Truth::yes));
    EXPECT_TRUE(watch.after(1s, Truth::yes));
  }
}

TEST(Trigger, StaysFiredUntilItIsArmedAgain) {
  Watch watch{Trigger({0ms, 0ms, 60})};
  EXPECT_TRUE(watch.after(1s, Truth::yes));

  EXPECT_FALSE(watch.after(1s, Truth::no, Truth::no)) << "between the two conditions";
  EXPECT_FALSE(watch.after(1s, Truth::yes, Truth::no));
  EXPECT_FALSE(watch.after(1s, Truth::no, Truth::unknown));
  EXPECT_EQ(watch.trigger.state(), State::fired);
  EXPECT_FALSE(watch.after(1s, Truth::no, Truth::yes));
  EXPECT_EQ(watch.trigger.state(), State::armed);
  EXPECT_TRUE(watch.after(1s, Truth::yes, Truth::no));
}

TEST(Trigger, FiresAsSoonAsItMayWhenItWasHeld) {
  Watch watch{Trigger({2s, 1s, 60})};
  EXPECT_FALSE(watch.after(0s, Truth::yes));
  EXPECT_FALSE(watch.held_after(3s));
  EXPECT_EQ(watch.trigger.state(), State::held);
  EXPECT_FALSE(watch.held_after(3s));
  EXPECT_EQ(watch.trigger.times(), 0U);
  EXPECT_TRUE(watch.after(10ms, Truth::yes, Truth::no));
}

TEST(Trigger, FiresAgainWhenItsEffectWasUndoneAndCountsBoth) {
  Watch watch{Trigger({0s, 10ms, 2})};
  ASSERT_TRUE(watch.after(0s, Truth::yes, Truth::no));

  watch.trigger.fire_again();

  EXPECT_FALSE(watch.after(990ms, Truth::yes, Truth::no)) << "not at once";
  EXPECT_TRUE(watch.after(10ms, Truth::yes, Truth::no));
  watch.trigger.fire_again();
  EXPECT_FALSE(watch.after(10s, Truth::yes, Truth::no)) << "twice in this hour";
  EXPECT_EQ(watch.trigger.state(), State::limited);
}

TEST(Trigger, TriesAgainWhenNothingCameOfIt) {
  Watch watch{Trigger({0s, 10ms, 1})};
  EXPECT_TRUE(watch.after(0s, Truth::yes, Truth::no));
  EXPECT_FALSE(watch.after(10ms, Truth::yes, Truth::no));
  watch.trigger.try_again();

  EXPECT_FALSE(watch.after(980ms, Truth::yes, Truth::no)) << "not at once";
  EXPECT_EQ(watch.trigger.state(), State::cooling_down);
  EXPECT_TRUE(watch.after(10ms, Truth::yes, Truth::no)) << "the first did not count";
  watch.trigger.try_again();
  EXPECT_FALSE(watch.after(10s, Truth::no, Truth::no)) << "nothing to do any more";
  EXPECT_EQ(watch.trigger.state(), State::armed);
}

TEST(Trigger, CountsTheTimeAnewWhenItIsArmedWhileTheConditionHolds) {
  Watch watch{Trigger({2s, 0ms, 60})};
  EXPECT_FALSE(watch.after(0s, Truth::yes, Truth::no));
  EXPECT_TRUE(watch.after(2s, Truth::yes, Truth::no));

  EXPECT_FALSE(watch.after(5s, Truth::yes, Truth::yes));
  EXPECT_FALSE(watch.after(1s, Truth::yes, Truth::no));
  EXPECT_TRUE(watch.after(1s, Truth::yes, Truth::no));
}

TEST(Trigger, CoolsDownBeforeItFiresAgain) {
  Watch watch{Trigger({0ms, 5s, 60})};
  EXPECT_TRUE(watch.after(1s, Truth::yes));
  EXPECT_FALSE(watch.after(1s, Truth::no));

  EXPECT_FALSE(watch.after(1s, Truth::yes));
  EXPECT_EQ(watch.trigger.state(), State::cooling_down);
  EXPECT_EQ(watch.trigger.cooling(watch.now), 3s);
  EXPECT_FALSE(watch.after(2'999ms, Truth::yes));
  EXPECT_TRUE(watch.after(1ms, Truth::yes));
}

TEST(Trigger, FiresOnlySoOftenInAnHour) {
  Watch watch{Trigger({0ms, 0ms, 2})};
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(watch.after(1min, Truth::yes));
    EXPECT_FALSE(watch.after(1s, Truth::no));
  }

  EXPECT_FALSE(watch.after(1min, Truth::yes));
  EXPECT_EQ(watch.trigger.state(), State::limited);
  EXPECT_FALSE(watch.after(56min, Truth::yes)) << "the first was 58 min and 2 s ago";
  EXPECT_TRUE(watch.after(2min, Truth::yes));
  EXPECT_EQ(watch.trigger.times(), 3U);
}

}  // namespace
}  // namespace mauve::rules
