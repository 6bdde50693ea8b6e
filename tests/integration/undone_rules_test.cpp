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
  EXPECT_EQ(daemon.events("rolled_back", "not confirmed before calm began"), 1U);
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
  EXPECT_EQ(daemon.events("rolled_back", "before the steps given by rule loud began"), 1U);
  EXPECT_EQ(daemon.events("transaction_applied", "the steps given by rule loud (first.core.gain"),
            1U);
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
