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

}  // namespace
}  // namespace mauve::daemon
