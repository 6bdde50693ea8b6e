// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/milestones.h"

#include <vector>

#include <gtest/gtest.h>

namespace mauve::daemon {
namespace {

/// Those of the counts that are reported.
std::vector<std::uint64_t> reported(const std::vector<std::uint64_t>& counts) {
  Milestones milestones;
  std::vector<std::uint64_t> all;
  for (const auto count : counts) {
    if (milestones.reached("arm", count)) all.push_back(count);
  }
  return all;
}

using Counts = std::vector<std::uint64_t>;

TEST(Milestones, AreTheFirstCountAtOrAfterEachPowerOfTen) {
  EXPECT_EQ(reported({0, 0, 1, 1, 2, 9, 10, 11, 99, 100}), (Counts{1, 10, 100}));
  EXPECT_EQ(reported({5, 9, 12, 99, 5000, 9999, 10000}), (Counts{5, 12, 5000, 10000}));
}

TEST(Milestones, BeginAnewForALowerCount) {
  EXPECT_EQ(reported({120, 130, 3, 9, 10}), (Counts{120, 3, 10}));
  EXPECT_EQ(reported({12, 0, 12}), (Counts{12, 12}));
}

TEST(Milestones, BeginAnewInAnotherEpochAlsoForAHigherCount) {
  Milestones milestones;
  EXPECT_TRUE(milestones.reached("arm", 5, 0));
  EXPECT_FALSE(milestones.reached("arm", 6, 0));
  EXPECT_TRUE(milestones.reached("arm", 7, 6));
  EXPECT_FALSE(milestones.reached("arm", 8, 6));
}

TEST(Milestones, AreOfEachNameAlone) {
  Milestones milestones;
  EXPECT_TRUE(milestones.reached("arm", 5));
  EXPECT_TRUE(milestones.reached("leg", 1));
  EXPECT_FALSE(milestones.reached("arm", 9));
}

}  // namespace
}  // namespace mauve::daemon
