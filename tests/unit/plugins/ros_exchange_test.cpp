// SPDX-License-Identifier: LGPL-3.0-or-later
/// The exchange between real-time threads and the ROS thread; needs no ROS.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "../../../plugins/ros/inbox.h"
#include "../../../plugins/ros/outbox.h"
#include "../../../plugins/ros/stamps.h"

namespace {

using ros_bridge::Inbox;
using ros_bridge::Outbox;

/// Torn when its words differ.
using Words = std::array<std::uint64_t, 32>;

Words words(std::uint64_t number) {
  Words all{};
  all.fill(number);
  return all;
}

TEST(Outbox, GivesOutWhatCameInInItsOrder) {
  Outbox<int> box(2);
  EXPECT_TRUE(box.put(10, [](int& value) { value = 1; }));
  EXPECT_TRUE(box.put(20, [](int& value) { value = 2; }));

  EXPECT_TRUE(box.take([](mauve::Instant stamp, int value) {
    EXPECT_EQ(stamp, 10);
    EXPECT_EQ(value, 1);
  }));
  EXPECT_TRUE(box.take([](mauve::Instant, int value) { EXPECT_EQ(value, 2); }));
  EXPECT_FALSE(box.take([](mauve::Instant, int) { FAIL(); }));
}

TEST(Outbox, TakesNothingMoreWhenItIsFull) {
  Outbox<int> box(1);
  EXPECT_TRUE(box.put(0, [](int& value) { value = 1; }));
  EXPECT_FALSE(box.put(0, [](int&) { FAIL(); }));

  EXPECT_TRUE(box.take([](mauve::Instant, int value) { EXPECT_EQ(value, 1); }));
  EXPECT_TRUE(box.put(0, [](int& value) { value = 2; }));
}

TEST(Outbox, DropsAnItemWhoseVisitorThrows) {
  Outbox<int> box(2);
  EXPECT_TRUE(box.put(0, [](int& value) { value = 1; }));
  EXPECT_TRUE(box.put(0, [](int& value) { value = 2; }));

  EXPECT_THROW(box.take([](mauve::Instant, int) { throw 1; }), int);
  EXPECT_TRUE(box.take([](mauve::Instant, int value) { EXPECT_EQ(value, 2); }));
}

TEST(Outbox, LosesAndTearsNothingBetweenTwoThreads) {
  constexpr std::uint64_t kCount = 20'000;
  Outbox<Words> box(8);
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kCount;) {
      if (box.put(0, [i](Words& value) { value = words(i); })) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::uint64_t seen = 0;
  bool whole = true;
  while (seen < kCount && whole) {
    const bool any = box.take([&](mauve::Instant, const Words& value) {
      whole = value == words(seen + 1);
      ++seen;
    });
    if (!any) std::this_thread::yield();
  }
  // A failure must not leave the writer with a full box.
  while (seen < kCount) box.take([&](mauve::Instant, const Words&) { ++seen; });
  writer.join();

  EXPECT_TRUE(whole);
}

TEST(Inbox, HasNothingBeforeTheFirstValue) {
  Inbox<int> box;
  mauve::Instant stamp = 0;
  EXPECT_EQ(box.newest(stamp), nullptr);
}

TEST(Inbox, ShowsTheNewestAndCountsWhatNobodySaw) {
  Inbox<int> box;
  mauve::Instant stamp = 0;
  bool replaced = true;
  const auto put = [&](int number) {
    return box.put(
        number,
        [number](int& value) {
          value = number;
          return true;
        },
        replaced);
  };
  EXPECT_TRUE(put(1));
  EXPECT_FALSE(replaced);
  EXPECT_TRUE(put(2));
  EXPECT_TRUE(replaced);
  ASSERT_NE(box.newest(stamp), nullptr);
  EXPECT_EQ(*box.newest(stamp), 2);
  EXPECT_EQ(stamp, 2);

  EXPECT_TRUE(put(3));
  EXPECT_FALSE(replaced);
  EXPECT_EQ(*box.newest(stamp), 3);
}

TEST(Inbox, KeepsWhatItHasWhenAValueIsRefused) {
  Inbox<int> box;
  mauve::Instant stamp = 0;
  bool replaced = false;
  ASSERT_TRUE(box.put(
      1, [](int& value) { return (value = 1) != 0; }, replaced));
  EXPECT_FALSE(box.put(
      2, [](int& value) { return (value = 2) == 0; }, replaced));

  EXPECT_EQ(*box.newest(stamp), 1);
  EXPECT_EQ(stamp, 1);
}

TEST(Inbox, TearsNothingAndNeverGoesBackBetweenTwoThreads) {
  Inbox<Words> box;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= 20'000; ++i) {
      bool replaced = false;
      const auto fill = [i](Words& value) {
        value = words(i);
        return true;
      };
      box.put(static_cast<mauve::Instant>(i), fill, replaced);
    }
    done = true;
  });
  std::uint64_t last = 0;
  bool whole = true;
  for (bool ended = false; !ended;) {
    ended = done;
    mauve::Instant stamp = 0;
    const Words* const value = box.newest(stamp);
    if (value == nullptr) continue;
    const auto number = static_cast<std::uint64_t>(stamp);
    whole = whole && *value == words(number) && number >= last;
    last = number;
  }
  writer.join();

  EXPECT_TRUE(whole);
  EXPECT_EQ(last, 20'000U);
}

constexpr std::int64_t kSecond = ros_bridge::kNanoseconds;
constexpr ros_bridge::Clocks kNow{.monotonic = 100 * kSecond, .wall = 1'700'000'000 * kSecond};

TEST(Stamps, MoveBetweenTheTwoClocks) {
  EXPECT_EQ(ros_bridge::to_wall(99 * kSecond, kNow), 1'699'999'999 * kSecond);
  EXPECT_DOUBLE_EQ(ros_bridge::to_seconds(1'699'999'999 * kSecond, kNow), 99.0);
}

TEST(Stamps, AreTheTimeOfArrivalWhenTheyAreOfAnotherClock) {
  EXPECT_DOUBLE_EQ(ros_bridge::to_seconds(0, kNow), 100.0);
  EXPECT_DOUBLE_EQ(ros_bridge::to_seconds(42 * kSecond, kNow), 100.0);
  EXPECT_DOUBLE_EQ(ros_bridge::to_seconds(1'700'000'011 * kSecond, kNow), 100.0);
}

TEST(Stamps, StayWithinWhatRosCanSay) {
  EXPECT_EQ(ros_bridge::to_wall(0, {.monotonic = 100 * kSecond, .wall = 0}), 0);
  EXPECT_EQ(ros_bridge::to_wall(0, {.monotonic = 0, .wall = 0x100000000 * kSecond}),
            0xffffffff * kSecond);
}

}  // namespace
