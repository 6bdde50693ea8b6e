// SPDX-License-Identifier: LGPL-3.0-or-later
/// Rules beside changes that wait for a confirmation, and an undo of their actions.
#include "rules_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

constexpr const char* kCapped =
    R"({ "name": "capped", "when": "first.core.gain > 5", "do": "calm", "cool_down": "1ms" })";

TEST(Rules, OutrankAChangeThatWaitsForItsConfirmation) {
  RulesDaemon daemon(supervised(kCapped));
  daemon.ask("param.set", {{"values", {{"first.core.gain", 2.0}}}, {"probation", "off"}});

  daemon.ask("param.set", {{"values", {{"first.core.gain", 6.0}}}, {"confirm_within", "600s"}});

  ASSERT_TRUE(daemon.fired("capped", 1)) << daemon.rule("capped");
  EXPECT_THAT(daemon.answer("capped"), HasSubstr("applied, generation 5"));
  EXPECT_EQ(daemon.ask("param.get", {{"address", "first.core.gain"}})["value"], 1.0);
  EXPECT_TRUE(daemon.logs(1, "rolled_back", "not confirmed before calm began"));
  const auto rollback = daemon.ask("component.why", {{"component", "first"}})["rollback"];
  EXPECT_EQ(rollback["cause"], "not confirmed before calm began") << rollback;
  EXPECT_EQ(rollback["undone"], Json({3}));
  EXPECT_EQ(rollback["generation"], 4);
  EXPECT_EQ(rollback["uid"], nullptr);
}

TEST(Rules, WithStepsOfTheirOwnAreNamedByTheRollbackForThem) {
  RulesDaemon daemon(supervised(R"({ "name": "loud", "when": "first.core.gain > 5",
      "do": [{ "set": "first.core.gain", "value": 1.0 }] })"));

  daemon.ask("param.set", {{"values", {{"first.core.gain", 6.0}}}, {"confirm_within", "600s"}});

  ASSERT_TRUE(daemon.fired("loud", 1)) << daemon.rule("loud");
  EXPECT_TRUE(daemon.logs(1, "rolled_back", "before the steps given by rule loud began"));
  EXPECT_TRUE(
      daemon.logs(1, "transaction_applied", "the steps given by rule loud (first.core.gain"));
}

/// The file brings the rule, which changes a component that the file leaves as it is.
TEST(Rules, WaitForNoConfirmationOfAFileThatBringsRules) {
  RulesDaemon daemon(supervised(kCapped));
  auto wanted = daemon.ask("config.get")["architecture"];
  wanted["rules"].push_back(Json::parse(R"({ "name": "late", "when": "first.core.count > 1",
      "do": [{ "set": "second.core.gain", "value": 3.0 }] })"));

  const auto applied =
      daemon.ask("architecture.apply", {{"text", wanted.dump()}, {"confirm_within", "600s"}});

  ASSERT_EQ(applied["state"], "applied") << applied;
  ASSERT_TRUE(daemon.fired("late", 1)) << daemon.rule("late");
  EXPECT_THAT(daemon.answer("late"), HasSubstr("applied, generation"));
  EXPECT_EQ(daemon.value("second.core.gain"), 3.0);
  const auto open = daemon.ask("status.get")["probations"];
  EXPECT_THAT(open.dump(), HasSubstr("confirm")) << "the file still waits";
}

TEST(Rules, FireAgainWhenTheirActionIsUndone) {
  RulesDaemon daemon(supervised(kCapped));
  daemon.ask("param.set", {{"values", {{"first.core.gain", 6.0}}}, {"probation", "off"}});
  ASSERT_TRUE(daemon.fired("capped", 1)) << daemon.rule("capped");

  const auto plan = daemon.ask("change.undo", {{"dry_run", true}});
  const auto undone = daemon.ask("change.undo");

  for (const Json& answer : {plan, undone}) {
    EXPECT_THAT(answer["notes"].dump(), HasSubstr("generation 3 was made by rule capped, which "
                                                  "fires again while its condition holds"));
  }
  EXPECT_TRUE(daemon.fired("capped", 2)) << daemon.rule("capped");
  EXPECT_EQ(daemon.ask("param.get", {{"address", "first.core.gain"}})["value"], 1.0);
}

constexpr const char* kQuiet = R"({ "name": "quiet", "when": "first.core.gain < 0", "do": "rest",
                                  "per_hour": 3 })";

TEST(Rules, ThatAFileDoesNotChangeGoOnAsTheyAre) {
  const std::string sticky = R"({ "name": "sticky", "when": "first.core.gain > 5",
      "until": "first.core.gain < 0.5", "do": "calm", "cool_down": "1ms" })";
  RulesDaemon daemon(supervised(sticky));
  daemon.ask("param.set", {{"values", {{"first.core.gain", 6.0}}}, {"probation", "off"}});
  ASSERT_TRUE(daemon.fired("sticky", 1)) << daemon.rule("sticky");
  daemon.ask("param.set", {{"values", {{"first.core.gain", 7.0}}}, {"probation", "off"}});
  const auto running = daemon.ask("config.get")["architecture"];

  auto wanted = running;
  wanted["rules"].push_back(Json::parse(kQuiet));
  const auto added = daemon.ask("architecture.apply", {{"text", wanted.dump()}});
  EXPECT_FALSE(added.contains("error")) << added;
  EXPECT_EQ(daemon.rule("sticky")["fired"], 1) << "it has fired, and is not armed yet";
  EXPECT_EQ(daemon.rule("sticky")["state"], "fired");

  wanted["rules"][0]["cool_down"] = "2ms";
  const auto plan = daemon.ask("architecture.apply", {{"text", wanted.dump()}, {"dry_run", true}});
  EXPECT_THAT(plan["notes"].dump(),
              HasSubstr("rule sticky begins armed, and its condition holds "
                        "now (first.core.gain is 7): the rule fires at once"));
  daemon.ask("architecture.apply", {{"text", wanted.dump()}});
  EXPECT_TRUE(eventually([&] { return daemon.rule("sticky")["state"] == "fired"; }));
  EXPECT_TRUE(eventually([&] {
    return daemon.ask("param.get", {{"address", "first.core.gain"}})["value"] == 1.0;
  }));
}

TEST(Rules, ThatAnUndoTakesAwayDoNotFireAgain) {
  RulesDaemon daemon(supervised(kQuiet));
  auto wanted = daemon.ask("config.get")["architecture"];
  wanted["rules"].push_back(Json::parse(kCapped));
  daemon.ask("architecture.apply", {{"text", wanted.dump()}});
  daemon.ask("param.set", {{"values", {{"first.core.gain", 6.0}}}});
  ASSERT_TRUE(daemon.fired("capped", 1)) << daemon.rule("capped");

  const auto plan = daemon.ask("change.undo", {{"generation", 2}, {"dry_run", true}});

  EXPECT_THAT(plan.dump(), Not(HasSubstr("fires again"))) << plan;
}

TEST(Rules, ThatAnUndoBringsBackAreNamedWhenTheirConditionHolds) {
  const std::string once = R"({ "name": "once", "when": "first.core.gain > 5", "do": "calm",
                               "per_hour": 1, "cool_down": "1ms" })";
  RulesDaemon daemon(supervised(once));
  auto wanted = daemon.ask("config.get")["architecture"];
  wanted["rules"][0]["per_hour"] = 2;
  daemon.ask("architecture.apply", {{"text", wanted.dump()}});
  wanted["rules"][0]["when"] = "first.core.gain > 7";
  daemon.ask("architecture.apply", {{"text", wanted.dump()}});
  daemon.ask("param.set", {{"values", {{"first.core.gain", 6.0}}}});

  const auto plan = daemon.ask("change.undo", {{"generation", 3}, {"dry_run", true}});

  EXPECT_THAT(plan["notes"].dump(),
              HasSubstr("rule once begins armed, and its condition holds now"))
      << plan;
}

TEST(Rules, DoNotPromiseToFireAgainBeyondTheirLimit) {
  RulesDaemon daemon(supervised(
      R"({ "name": "once", "when": "first.core.gain > 5", "do": "calm", "per_hour": 1 })"));
  daemon.ask("param.set", {{"values", {{"first.core.gain", 6.0}}}, {"probation", "off"}});
  ASSERT_TRUE(daemon.fired("once", 1)) << daemon.rule("once");

  const auto plan = daemon.ask("change.undo", {{"dry_run", true}});

  EXPECT_THAT(plan["notes"].dump(), HasSubstr("has reached its per_hour")) << plan;
}

TEST(Rules, ThatALockHoldsAreReportedOnceAndShownByStatus) {
  RulesDaemon daemon(
      supervised(R"({ "name": "busy", "when": "first.core.gain > 5", "do": "deaf" })"));
  daemon.ask("lock.set", {{"lock", "topology"}});
  daemon.set("first.core.gain", 6.0);

  ASSERT_TRUE(eventually([&] { return daemon.rule("busy")["state"] == "held"; }));

  EXPECT_TRUE(eventually([&] { return daemon.events("rule_blocked", "rule busy") == 1; }));
  EXPECT_THAT(daemon.ctl({"status"}).out,
              HasSubstr("rule busy has no effect although its condition "
                        "holds: topology is locked"));
  EXPECT_TRUE(daemon.logs(1, "rule_blocked"));
}

TEST(Rules, FireAgainWhenTheChangeThatTheyReliedOnIsUndone) {
  RulesDaemon daemon(supervised(
      R"({ "name": "loud", "when": "first.core.gain > 5", "do": "deaf", "cool_down": "1ms" })"));
  daemon.ask("port.disconnect", {{"port", "second.ports.input"}});
  daemon.ask("param.set", {{"values", {{"first.core.gain", 6.0}}}, {"probation", "off"}});
  ASSERT_TRUE(daemon.fired("loud", 1)) << daemon.rule("loud");
  ASSERT_THAT(daemon.answer("loud"), HasSubstr("unchanged"));

  const auto undone = daemon.ask("change.undo");

  EXPECT_THAT(undone["notes"].dump(), HasSubstr("generation 2 is relied on by rule loud, which "
                                                "fires again while its condition holds"));
  EXPECT_TRUE(daemon.fired("loud", 2)) << daemon.rule("loud");
  EXPECT_EQ(daemon.service("second.ports.input"), nullptr);
}

}  // namespace
}  // namespace mauve::test
