// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rules/engine.h"

#include <map>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace mauve::rules {
namespace {

using namespace std::chrono_literals;  // NOLINT: durations

class Rules : public testing::Test {
 protected:
  static Rule rule(const std::string& name, const std::string& when, Timing timing = {}) {
    return {name, *Condition::parse(when), std::nullopt, timing, "drop_gnss", {}};
  }
  std::vector<std::size_t> after(Engine& engine, Duration passed) {
    now_ += passed.count();
    return engine.step(now_, read_);
  }
  Report report(const Engine& engine) { return engine.report(0, now_, read_); }

  std::map<std::string, Value> values_{{"gnss.core.satellites", 9}};
  Instant now_ = 1'000'000'000;
  std::map<std::string, Duration> ages_;
  ReadFresh read_ = [this](const std::string& address, Duration max_age) -> Result<Value> {
    if (max_age > Duration{0} && ages_[address] > max_age) return Value();
    const auto found = values_.find(address);
    if (found != values_.end()) return found->second;
    return refuse(Errc::unknown_name, address, "there is nothing of this name");
  };
};

using Fired = std::vector<std::size_t>;

/// A device that is silent shows its last values.
TEST_F(Rules, DoNotTrustAValueThatIsOlderThanTheirMaxAge) {
  Rule lost = rule("lost", "gnss.core.satellites < 4");
  lost.max_age = 2s;
  lost.when_unknown = Unknown::fire;
  Rule back = rule("back", "gnss.core.satellites > 4");
  back.max_age = 3s;
  Engine engine({lost, back, rule("any_age", "gnss.core.satellites == 9")});
  EXPECT_EQ(after(engine, 10ms), (Fired{1, 2}));

  ages_["gnss.core.satellites"] = 2500ms;
  EXPECT_EQ(after(engine, 10ms), Fired{0});
  ASSERT_EQ(engine.lost().size(), 1U) << "it is known to the rule that permits 3 s";
  EXPECT_EQ(engine.lost()[0].rules, std::vector<std::string>{"lost"});
  EXPECT_EQ(engine.lost()[0].max_age, 2s);

  ages_["gnss.core.satellites"] = 3500ms;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(engine.report(1, now_, read_).why_not, "fired, its transaction is under way");
  EXPECT_EQ(engine.lost().size(), 2U);
}

TEST_F(Rules, FireOneByOneAndAreArmedAgain) {
  Engine engine({rule("few", "gnss.core.satellites < 4"), rule("none", "gnss.core.satellites == 0"),
                 rule("many", "gnss.core.satellites > 8")});

  EXPECT_EQ(after(engine, 10ms), Fired{2});
  engine.answered(2, "applied");
  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), Fired{0});
  engine.answered(0, "applied");
  values_["gnss.core.satellites"] = 0;
  EXPECT_EQ(after(engine, 2s), Fired{1});
  engine.answered(1, "applied");
  values_["gnss.core.satellites"] = 9;
  EXPECT_EQ(after(engine, 2s), Fired{2});
}

TEST_F(Rules, HaveACooldownAndALimitThatNobodyAskedFor) {
  const Rule bare = rule("few", "gnss.core.satellites < 4");

  EXPECT_EQ(bare.timing, (Timing{0s, 1s, 60}));
}

TEST_F(Rules, WaitForTheSecondConditionToBeArmedAgain) {
  Rule few = rule("few", "gnss.core.satellites < 4", {0s, 0s, 60});
  few.until = *Condition::parse("gnss.core.satellites >= 6");
  Engine engine({few});
  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), Fired{0});
  engine.answered(0, "applied");

  values_["gnss.core.satellites"] = 5;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(report(engine).state, State::fired);
  EXPECT_EQ(report(engine).why_not, "fired, to be armed again when gnss.core.satellites >= 6");
  values_["gnss.core.satellites"] = 6;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(report(engine).state, State::armed);
  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), Fired{0});
}

TEST_F(Rules, AreNotArmedWhileTheirTransactionIsUnderWay) {
  Engine engine({rule("few", "gnss.core.satellites < 4", {0s, 0s, 60})});
  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), Fired{0});

  values_["gnss.core.satellites"] = 9;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(report(engine).answer, "under way");
  engine.answered(0, "applied");
  EXPECT_EQ(report(engine).answer, "applied");
  EXPECT_EQ(after(engine, 10ms), Fired{}) << "it has fired";
}

TEST_F(Rules, ThatAreRefusedTryAgainAtGrowingPausesWhileTheirConditionHolds) {
  Engine engine({rule("few", "gnss.core.satellites < 4", {0s, 0s, 60})});
  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), Fired{0});

  for (const Duration pause : std::vector<Duration>{1s, 2s, 4s, 8s, 16s, 32s, 1min, 1min}) {
    engine.answered(0, "refused: its state would be lost", Ended::refused);
    EXPECT_EQ(engine.blocked(), Fired{0});
    EXPECT_EQ(after(engine, pause - 10ms), Fired{});
    EXPECT_EQ(report(engine).why_not, "tries again in 0.01 s");
    EXPECT_EQ(after(engine, 10ms), Fired{0});
  }
  engine.answered(0, "refused: its state would be lost", Ended::refused);
  values_["gnss.core.satellites"] = 9;
  EXPECT_EQ(after(engine, 2min), Fired{});
  EXPECT_EQ(engine.blocked(), Fired{}) << "there is nothing to do any more";

  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), Fired{0});
  engine.answered(0, "refused: its state would be lost", Ended::refused);
  EXPECT_EQ(after(engine, 1s), Fired{0}) << "the pauses begin anew";
  engine.answered(0, "applied");
  EXPECT_EQ(engine.blocked(), Fired{});
}

TEST_F(Rules, GoOnAsTheyAreWhenOthersChange) {
  Engine engine({rule("few", "gnss.core.satellites < 4", {0s, 0s, 60}),
                 rule("other", "gnss.core.satellites < 4", {0s, 0s, 60})});
  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), (Fired{0, 1}));
  const RuleId few = engine.id(0);
  const RuleId other = engine.id(1);

  const auto kept = [](const Rule& one) { return one.name == "few"; };
  engine.replace({rule("new", "gnss.core.satellites > 100"),
                  rule("few", "gnss.core.satellites < 4", {0s, 0s, 60}),
                  rule("other", "gnss.core.satellites < 5", {0s, 0s, 60})},
                 kept);

  EXPECT_EQ(engine.id(1), few);
  EXPECT_NE(engine.id(2), other);
  EXPECT_EQ(after(engine, 10ms), Fired{2}) << "the changed rule begins anew, armed";
  engine.answered(few, "applied");
  engine.answered(other, "refused: the rule is gone", Ended::refused);
  EXPECT_EQ(engine.report(1, now_, read_).answer, "applied");
  EXPECT_EQ(engine.report(2, now_, read_).answer, "under way");
  EXPECT_EQ(after(engine, 10ms), Fired{}) << "it has fired";
}

TEST_F(Rules, AreBlockedWhileALockOrTheirLimitKeepsThemFromFiring) {
  Engine engine({rule("few", "gnss.core.satellites < 4", {0s, 0s, 1})});
  values_["gnss.core.satellites"] = 3;
  now_ += 10'000'000;
  const Held locked = [](const Rule&) { return std::string_view("everything is locked"); };
  EXPECT_EQ(engine.step(now_, read_, locked), Fired{});
  EXPECT_EQ(engine.blocked(), Fired{0});

  EXPECT_EQ(after(engine, 10ms), Fired{0});
  EXPECT_EQ(engine.blocked(), Fired{});
  engine.answered(0, "applied");
  values_["gnss.core.satellites"] = 9;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(engine.blocked(), Fired{0}) << "once an hour";
}

TEST_F(Rules, SayWhyTheyDoNotFire) {
  Engine engine({rule("few", "gnss.core.satellites < 4", {2s, 5s, 1})});
  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(report(engine).why_not, "condition is false: gnss.core.satellites is 9");

  values_["gnss.core.satellites"] = Value();
  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(report(engine).why_not, "condition is unknown: gnss.core.satellites is not there");

  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(after(engine, 400ms), Fired{});
  EXPECT_EQ(report(engine).why_not, "holds for 0.4 of 2 s");
  EXPECT_EQ(after(engine, 1600ms), Fired{0});
  EXPECT_EQ(report(engine).why_not, "fired, its transaction is under way");
  engine.answered(0, "applied");
  EXPECT_EQ(report(engine).why_not, "fired, to be armed again when the condition is false");

  values_["gnss.core.satellites"] = 9;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  values_["gnss.core.satellites"] = 3;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(after(engine, 1980ms), Fired{});
  EXPECT_EQ(after(engine, 20ms), Fired{});
  EXPECT_EQ(report(engine).why_not, "cooling down 2.98 s more");
  EXPECT_EQ(after(engine, 5s), Fired{});
  EXPECT_EQ(report(engine).why_not, "limit 1 an hour reached, for 3593 s more");
  EXPECT_EQ(report(engine).times, 1U);
}

TEST_F(Rules, AreDisabledWhileAnAddressIsNotThere) {
  Engine engine({rule("few", "gnss.core.satellites < 4 or gnss.core.gone > 1")});
  values_["gnss.core.satellites"] = 5;

  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(report(engine).state, State::disabled);
  EXPECT_NE(report(engine).why_not.find("gnss.core.gone"), std::string::npos);

  values_["gnss.core.gone"] = 0;
  EXPECT_EQ(after(engine, 10ms), Fired{});
  EXPECT_EQ(report(engine).state, State::armed);
}

}  // namespace
}  // namespace mauve::rules
