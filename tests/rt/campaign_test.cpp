// SPDX-License-Identifier: LGPL-3.0-or-later
/// When a campaign is repeated, and when it is over.
#include <gtest/gtest.h>

#include <vector>

#include "support/campaign.h"

namespace mauve::test {
namespace {

constexpr Tally kClean{0, 5, kTooOften};
constexpr Tally kMissed{1, 0, kTooOften - 1};
constexpr Tally kDisturbed{1, 5, kTooOften};

struct Judged {
  Verdict verdict;
  std::size_t runs;
  bool operator==(const Judged&) const = default;
};

/// Of runs that end like this, one after the other.
Judged judged(const std::vector<Tally>& ends) {
  std::size_t runs = 0;
  const Verdict verdict = judge([&](Tally& tally) { tally = ends.at(runs++); });
  return {verdict, runs};
}

TEST(Campaign, IsOverWithTheFirstRunThatMissesNothing) {
  EXPECT_EQ(judged({kClean}), (Judged{Verdict::passed, 1}));
}

TEST(Campaign, FailsAtOnceWhenSomethingIsMissedOnAQuietHost) {
  EXPECT_EQ(judged({kMissed}), (Judged{Verdict::failed, 1}));
}

TEST(Campaign, IsRepeatedWhileTheHostIsTooDisturbedToJudgeAMiss) {
  EXPECT_EQ(judged({kDisturbed, kClean}), (Judged{Verdict::passed, 2}));
  EXPECT_EQ(judged({kDisturbed, kDisturbed, kMissed}), (Judged{Verdict::failed, 3}));
}

TEST(Campaign, ProvesNothingWhenAllItsRunsWereDisturbed) {
  EXPECT_EQ(judged({kDisturbed, kDisturbed, kDisturbed}), (Judged{Verdict::disturbed, 3}));
}

}  // namespace
}  // namespace mauve::test
