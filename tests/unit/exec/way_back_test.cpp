// SPDX-License-Identifier: LGPL-3.0-or-later
/// Setting the way back off while the thread that does is held up at each point of it.
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "exec/update/transaction.h"

namespace mauve::exec {
namespace {

using Verdict = Transaction::Verdict;

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

class SetOff : public testing::Test {
 protected:
  bool set_off() { return back.set_off(clock, fault, nullptr); }
  Instant instant() { return back.transaction().instant(); }

  HeldUp clock;
  FaultRecord fault;
  WayBack back;
};

TEST_F(SetOff, LeadsAllBackFromOneInstantOn) {
  EXPECT_EQ(back.transaction().meet(clock.time), Verdict::go_on);
  ASSERT_TRUE(set_off());

  EXPECT_TRUE(back.told());
  EXPECT_EQ(instant(), clock.time + 200'000);
  EXPECT_EQ(back.transaction().meet(instant() - 1), Verdict::go_on);
  EXPECT_EQ(back.transaction().meet(instant()), Verdict::take);
  EXPECT_FALSE(set_off()) << "once";
}

TEST_F(SetOff, MovesTheInstantThatPassedBeforeTheDecision) {
  std::vector<Instant> passed;
  clock.at_look = [&](int look) {
    if (look != 2 && look != 4) return;
    clock.time += 1'000'000;  // the instant is chosen, but not yet decided
    passed.push_back(instant());
    EXPECT_EQ(back.transaction().meet(instant()), Verdict::go_on) << "nobody goes back alone";
  };
  ASSERT_TRUE(set_off());

  ASSERT_EQ(passed.size(), 2u);
  EXPECT_GT(instant(), clock.time);
  EXPECT_EQ(back.transaction().meet(passed[1]), Verdict::go_on);
  EXPECT_EQ(back.transaction().meet(instant()), Verdict::take);
}

TEST_F(SetOff, MovesAnInstantThatAMemberCameToFirst) {
  clock.at_look = [&](int look) {
    if (look != 2) return;
    EXPECT_EQ(back.transaction().meet(instant()), Verdict::go_on);
  };
  ASSERT_TRUE(set_off());

  EXPECT_EQ(clock.looks, 4) << "the first attempt was aborted";
  EXPECT_EQ(back.transaction().meet(instant()), Verdict::take);
}

TEST_F(SetOff, EndsHoweverOftenItIsHeldUp) {
  clock.at_look = [&](int /*look*/) { clock.time += 100'000'000; };
  ASSERT_TRUE(set_off());

  EXPECT_LT(clock.looks, 20);
  EXPECT_GT(instant(), clock.time);
  EXPECT_EQ(back.transaction().meet(instant()), Verdict::take);
}

TEST_F(SetOff, AndANewerChangeExcludeEachOther) {
  const auto newer = std::make_shared<Transaction>(clock.time);
  back.give_way_to(newer);
  EXPECT_FALSE(back.leads_back());
  ASSERT_TRUE(set_off());
  EXPECT_EQ(newer->state(), Transaction::State::aborted);
  EXPECT_TRUE(back.leads_back());

  WayBack other;
  const auto decided = std::make_shared<Transaction>(clock.time, Transaction::State::committed);
  other.give_way_to(decided);
  EXPECT_FALSE(other.set_off(clock, fault, nullptr));
  EXPECT_TRUE(other.closed());

  WayBack kept;
  kept.give_way_to(decided);
  kept.give_way_to(nullptr);  // it was revoked
  EXPECT_TRUE(kept.set_off(clock, fault, nullptr));
}

}  // namespace
}  // namespace mauve::exec
