// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rules/sight.h"

#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "rules/engine.h"

namespace mauve::rules {
namespace {

const Value kNan{std::nan("")};

TEST(Sight, ReportsOnceThatAKnownValueIsLostAndOnceThatItIsBackForASecond) {
  Sight sight;
  EXPECT_FALSE(sight.step(0, true));
  EXPECT_TRUE(sight.step(1, false));
  EXPECT_FALSE(sight.step(2, false));
  EXPECT_TRUE(sight.lost());

  const Instant back = 10;
  EXPECT_FALSE(sight.step(back, true));
  EXPECT_FALSE(sight.step(back + Duration{999ms}.count(), true));
  EXPECT_TRUE(sight.step(back + Duration{1s}.count(), true));
  EXPECT_FALSE(sight.lost());
}

TEST(Sight, StaysLostWhileTheValueComesAndGoes) {
  Sight sight;
  EXPECT_FALSE(sight.step(0, true));
  int reports = 0;
  for (Instant now = 1; now < Duration{10s}.count(); now += Duration{10ms}.count()) {
    reports += sight.step(now, (now / Duration{10ms}.count()) % 2 == 1) ? 1 : 0;
  }
  EXPECT_EQ(reports, 1);
  EXPECT_TRUE(sight.lost());
}

TEST(Sight, GivesAValueThatWasNeverKnownASecondToCome) {
  Sight sight;
  EXPECT_FALSE(sight.step(5, false));
  EXPECT_FALSE(sight.step(5 + Duration{999ms}.count(), false));
  EXPECT_TRUE(sight.step(5 + Duration{1s}.count(), false));
}

class Blind : public testing::Test {
 protected:
  static Rule rule(const std::string& name, Unknown answer) {
    Rule rule{name, *Condition::parse("heater.core.error > 9"), std::nullopt, {}, "cool", {}};
    rule.when_unknown = answer;
    return rule;
  }
  std::vector<std::size_t> after(Duration passed) {
    now_ += passed.count();
    return engine_.step(now_, read_);
  }

  Engine engine_{{rule("holds", Unknown::hold), rule("fires", Unknown::fire)}};
  Value value_{1.0};
  Instant now_ = 1'000'000'000;
  ReadFresh read_ = [this](const std::string&, Duration) -> Result<Value> { return value_; };
};

using Fired = std::vector<std::size_t>;

TEST_F(Blind, OnlyTheRuleThatSaysSoFiresOnANan) {
  EXPECT_EQ(after(10ms), Fired{});
  value_ = kNan;

  EXPECT_EQ(after(10ms), Fired{1});

  ASSERT_EQ(engine_.changes().size(), 1U);
  EXPECT_EQ(engine_.changes()[0].address, "heater.core.error");
  EXPECT_TRUE(engine_.changes()[0].lost);
  EXPECT_EQ(engine_.changes()[0].rules, (std::vector<std::string>{"holds", "fires"}));
  EXPECT_EQ(engine_.lost().size(), 1U);
  EXPECT_EQ(after(10ms), Fired{});
  EXPECT_TRUE(engine_.changes().empty()) << "reported once";
  EXPECT_EQ(engine_.report(0, now_, read_).why_not,
            "condition is unknown: heater.core.error is nan");
}

TEST_F(Blind, TheRuleThatFiresOnUnknownWaitsForValuesThatAreStillToCome) {
  value_ = Value();
  EXPECT_EQ(after(10ms), Fired{}) << "nobody has written it yet";
  EXPECT_EQ(after(900ms), Fired{});
  EXPECT_EQ(after(100ms), Fired{1});
}

TEST_F(Blind, AValueThatIsBackIsReportedAndArmsTheRuleAgain) {
  static_cast<void>(after(10ms));
  value_ = kNan;
  EXPECT_EQ(after(10ms), Fired{1});
  engine_.answered(1, "applied");
  value_ = 1.0;
  EXPECT_EQ(after(10ms), Fired{});
  EXPECT_EQ(engine_.lost().size(), 1U);
  EXPECT_EQ(after(1s), Fired{});
  ASSERT_EQ(engine_.changes().size(), 1U);
  EXPECT_FALSE(engine_.changes()[0].lost);
  EXPECT_TRUE(engine_.lost().empty());
  value_ = kNan;
  EXPECT_EQ(after(1s), Fired{1});
}

}  // namespace
}  // namespace mauve::rules
