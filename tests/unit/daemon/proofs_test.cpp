// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/proofs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mauve::daemon {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

Outcome end_of(std::vector<std::uint64_t> changes, std::uint64_t now, std::uint64_t oldest_open) {
  Outcome outcome;
  outcome.began = changes.front();
  outcome.generations = std::move(changes);
  outcome.generation = now;
  outcome.oldest_open = oldest_open;
  return outcome;
}

TEST(Proofs, ProveTheChangeAndThatWhichIsInForceWhenNothingElseIsOpen) {
  Proofs proofs;
  EXPECT_THAT(proofs.passed(end_of({5}, 5, 0)), ElementsAre(5));
  EXPECT_THAT(proofs.passed(end_of({6}, 8, 0)), ElementsAre(6, 8)) << "a stop came in between";
  EXPECT_THAT(proofs.passed(end_of({9, 10}, 10, 0)), ElementsAre(9, 10));
}

TEST(Proofs, WaitForAnOlderChangeThatIsOpen) {
  Proofs proofs;
  EXPECT_THAT(proofs.passed(end_of({6}, 6, 5)), IsEmpty()) << "it holds the change 5";
  EXPECT_THAT(proofs.passed(end_of({5}, 6, 0)), UnorderedElementsAre(5, 6));
}

TEST(Proofs, DoNotWaitForANewerChangeThatIsOpen) {
  Proofs proofs;
  EXPECT_THAT(proofs.passed(end_of({5}, 6, 6)), ElementsAre(5)) << "what is in force holds 6";
}

TEST(Proofs, AreNeverOfAGenerationThatHoldsAChangeWhichWasRolledBack) {
  Proofs proofs;
  EXPECT_THAT(proofs.passed(end_of({6}, 6, 5)), IsEmpty());
  proofs.rolled_back(end_of({5}, 7, 0));
  EXPECT_THAT(proofs.passed(end_of({8}, 8, 0)), ElementsAre(8));
}

TEST(Proofs, AreNeverOfAGenerationThatHoldsAChangeWhichWasRolledBackBefore) {
  Proofs proofs;
  proofs.rolled_back(end_of({2}, 5, 3));
  EXPECT_THAT(proofs.passed(end_of({3}, 5, 4)), IsEmpty()) << "3 was saved with the change 2";
  EXPECT_THAT(proofs.passed(end_of({4}, 6, 0)), ElementsAre(6)) << "and so was 4";
  EXPECT_THAT(proofs.passed(end_of({7}, 7, 0)), ElementsAre(7));
}

TEST(Proofs, AreOfAllThatRunsUnlessAChangeStaysUndecided) {
  Proofs proofs;
  EXPECT_TRUE(proofs.all_decided());
  proofs.undecided(3);
  EXPECT_FALSE(proofs.all_decided());
  proofs.confirmed(2);
  EXPECT_FALSE(proofs.all_decided()) << "generation 2 is without it";
  proofs.confirmed(4);
  EXPECT_TRUE(proofs.all_decided()) << "generation 4 holds it";
  proofs.undecided(3);
  EXPECT_TRUE(proofs.all_decided()) << "it was reported late";
}

}  // namespace
}  // namespace mauve::daemon
