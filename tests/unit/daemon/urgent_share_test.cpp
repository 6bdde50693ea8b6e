// SPDX-License-Identifier: LGPL-3.0-or-later
#include "changes/urgent_share.h"

#include <gtest/gtest.h>

namespace mauve::daemon {
namespace {

/// A thread whose clocks the test sets.
struct Worker {
  UrgentShare share;
  Instant now = Duration{1s}.count();
  Duration used{0};

  Worker() { EXPECT_TRUE(share.look(now, used)); }
  /// It works for so long, then rests.
  bool work(Duration time, Duration rest = 0ms) {
    now += (time + rest).count();
    used += time;
    return share.look(now, used);
  }
};

TEST(UrgentShare, IsKeptByAThreadThatWorksNowAndThen) {
  Worker io;
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(io.work(1ms, 9ms));
}

TEST(UrgentShare, IsLostByAThreadThatWorksWithoutEnd) {
  Worker io;
  EXPECT_TRUE(io.work(5ms));
  EXPECT_TRUE(io.work(5ms));
  EXPECT_FALSE(io.work(5ms));
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(io.work(1ms, 1ms));
}

TEST(UrgentShare, ComesBackAfterARestOnceHalfOfItIsThere) {
  Worker io;
  EXPECT_FALSE(io.work(20ms));
  EXPECT_FALSE(io.work(0ms, 100ms));
  EXPECT_TRUE(io.work(0ms, 60ms));
}

TEST(UrgentShare, OfALongRestIsNoMoreThanThatOfAShortOne) {
  Worker io;
  EXPECT_TRUE(io.work(0ms, 1h));
  EXPECT_FALSE(io.work(12ms));
}

TEST(UrgentShare, IsNothingForAThreadWithoutPriority) { EXPECT_FALSE(urgent_within_share(0)); }

}  // namespace
}  // namespace mauve::daemon
