// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/refusals.h"

#include <gtest/gtest.h>

namespace mauve::server {
namespace {

using namespace std::chrono_literals;

/// How many of these are written.
unsigned written(Refusals& refusals, std::uint32_t uid, int count, Refusals::Time now) {
  unsigned written = 0;
  for (int i = 0; i < count; ++i) written += refusals.may_write(uid, now) ? 1 : 0;
  return written;
}

TEST(Refusals, AreWrittenTwentyTimesASecondForEachUserAndCountedBeyond) {
  Refusals refusals;
  const Refusals::Time begin{};

  EXPECT_EQ(written(refusals, 1, 68'253, begin), Refusals::kPerSecond);
  EXPECT_EQ(written(refusals, 2, 5, begin + 500ms), 5U) << "of another user";
  EXPECT_TRUE(refusals.take_counted(begin + 999ms).empty()) << "the second is not over";

  const auto counted = refusals.take_counted(begin + 1s);
  ASSERT_EQ(counted.size(), 1U);
  EXPECT_EQ(counted[0].uid, 1U);
  EXPECT_EQ(counted[0].count, 68'253U - Refusals::kPerSecond);
  EXPECT_TRUE(refusals.take_counted(begin + 9s).empty()) << "reported once";
  EXPECT_EQ(written(refusals, 1, 30, begin + 1s), Refusals::kPerSecond) << "a new second";
}

TEST(Refusals, ThatWereCountedAreNotForgottenWhenNobodyAskedInTime) {
  Refusals refusals;
  const Refusals::Time begin{};
  written(refusals, 1, 25, begin);

  EXPECT_FALSE(refusals.may_write(1, begin + 2s)) << "the count is reported first";

  EXPECT_EQ(refusals.take_counted(begin + 2s)[0].count, 6U);
  EXPECT_TRUE(refusals.may_write(1, begin + 2s));
}

}  // namespace
}  // namespace mauve::server
