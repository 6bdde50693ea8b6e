// SPDX-License-Identifier: LGPL-3.0-or-later
#include "../../../plugins/types/reporting.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace rover {
namespace {

TEST(Reporting, IsSeldomWhenSomethingHappensAgainAndAgain) {
  int reported = 0;
  for (std::uint64_t count = 1; count <= 100'000; ++count)
    reported += worth_reporting(count) ? 1 : 0;

  EXPECT_EQ(reported, 6) << "the 1st, 10th, 100th, 1,000th, 10,000th and 100,000th";
  EXPECT_FALSE(worth_reporting(0));
  EXPECT_FALSE(worth_reporting(20));
  EXPECT_FALSE(worth_reporting(std::numeric_limits<std::uint64_t>::max()));
}

TEST(Reporting, IsForChanges) {
  Condition lost(false);
  EXPECT_FALSE(lost.changed(false));
  EXPECT_TRUE(lost.changed(true));
  EXPECT_FALSE(lost.changed(true));
  EXPECT_TRUE(lost.changed(false));
}

}  // namespace
}  // namespace rover
