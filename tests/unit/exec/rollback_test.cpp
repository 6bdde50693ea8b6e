// SPDX-License-Identifier: LGPL-3.0-or-later
/// Setting the rollback off while the thread that does is held up at each point of it.
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "exec/update/decision.h"

namespace mauve::exec {
namespace {

using Verdict = Decision::Verdict;

/// Does something at each look.
class HeldUp : public Clock {
 public:
  [[nodiscard]] Instant now() const override {
    if (at_look) at_look(++looks);
    return time;
  }
  mutable Instant time = 1'000'000;
  mutable int looks = 0;
  std::function<void(int)> at_look;
};

class RollbackTrigger : public testing::Test {
 protected:
  bool trigger() { return back.trigger(clock, fault, nullptr); }
  Instant instant() { return back.decision().instant(); }

  HeldUp clock;
  FaultRecord fault;
  Rollback back;
};

TEST_F(RollbackTrigger, LeadsAllBackFromOneInstantOn) {
  EXPECT_EQ(back.decision().at_boundary(clock.time), Verdict::not_yet);
  ASSERT_TRUE(trigger());

  EXPECT_TRUE(back.decided());
  EXPECT_EQ(instant(), clock.time + 200'000);
  EXPECT_EQ(back.decision().at_boundary(instant() - 1), Verdict::not_yet);
  EXPECT_EQ(back.decision().at_boundary(instant()), Verdict::take);
  EXPECT_FALSE(trigger()) << "once";
}

TEST_F(RollbackTrigger, MovesTheInstantThatPassedBeforeTheDecision) {
  std::vector<Instant> passed;
  clock.at_look = [&](int look) {
    if (look != 2 && look != 4) return;
    clock.time += 1'000'000;  // the instant is chosen, but not yet decided
    passed.push_back(instant());
    EXPECT_EQ(back.decision().at_boundary(instant()), Verdict::not_yet) << "nobody goes back alone";
  };
  ASSERT_TRUE(trigger());

  ASSERT_EQ(passed.size(), 2u);
  EXPECT_GT(instant(), clock.time);
  EXPECT_EQ(back.decision().at_boundary(passed[1]), Verdict::not_yet);
  EXPECT_EQ(back.decision().at_boundary(instant()), Verdict::take);
}

TEST_F(RollbackTrigger, MovesAnInstantThatAMemberCameToFirst) {
  clock.at_look = [&](int look) {
    if (look != 2) return;
    EXPECT_EQ(back.decision().at_boundary(instant()), Verdict::not_yet);
  };
  ASSERT_TRUE(trigger());

  EXPECT_EQ(clock.looks, 4) << "the first attempt was aborted";
  EXPECT_EQ(back.decision().at_boundary(instant()), Verdict::take);
}

TEST_F(RollbackTrigger, EndsHoweverOftenItIsHeldUp) {
  clock.at_look = [&](int /*look*/) { clock.time += 100'000'000; };
  ASSERT_TRUE(trigger());

  EXPECT_LT(clock.looks, 20);
  EXPECT_GT(instant(), clock.time);
  EXPECT_EQ(back.decision().at_boundary(instant()), Verdict::take);
}

TEST_F(RollbackTrigger, AndANewerChangeExcludeEachOther) {
  const auto newer = std::make_shared<Decision>(clock.time);
  back.give_way_to(newer);
  EXPECT_FALSE(back.rolls_back());
  ASSERT_TRUE(trigger());
  EXPECT_EQ(newer->state(), Decision::State::aborted);
  EXPECT_TRUE(back.rolls_back());

  Rollback other;
  const auto decided = std::make_shared<Decision>(clock.time, Decision::State::committed);
  other.give_way_to(decided);
  EXPECT_FALSE(other.trigger(clock, fault, nullptr));
  EXPECT_TRUE(other.closed());

  Rollback kept;
  kept.give_way_to(decided);
  kept.give_way_to(nullptr);  // it was revoked
  EXPECT_TRUE(kept.trigger(clock, fault, nullptr));
}

}  // namespace
}  // namespace mauve::exec
