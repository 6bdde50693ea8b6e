// SPDX-License-Identifier: LGPL-3.0-or-later
// Rules, transactions and permissions belong to a change like components: they go when it is rolled
// back, and no generation is saved with half of it.
#include "kept_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

class RolledBack : public Generations {
 protected:
  void SetUp() override { ASSERT_EQ(daemon_.ask("change.confirm")["saved"], true); }

  [[nodiscard]] static Json plain() { return Json::parse(kTrial); }
  /// With a transaction, a rule for it and the permission to ask for it.
  [[nodiscard]] static Json supervised(const std::string& address = "first.core.gain") {
    Json wanted = plain();
    wanted["transactions"]["calm"] = {{{"set", address}, {"value", 1.0}}};
    wanted["rules"] = {{{"name", "loud"}, {"when", address + " > 100"}, {"do", "calm"}}};
    wanted["components"]["first"]["may_request"] = {"calm"};
    return wanted;
  }
  Json apply(const Json& wanted, Json params = Json::object()) {
    params["text"] = wanted.dump();
    return daemon_.ask("architecture.apply", std::move(params));
  }
  [[nodiscard]] Json saved(const std::string& number) const {
    return Json::parse(TempDir::read(file(number)), nullptr, true, true);
  }
  bool rolled_back() { return was_logged(daemon_, "rolled_back"); }
  Json generation() { return daemon_.ask("status.get")["generation"]; }

  TrialDaemon daemon_{kTrial, options()};
};

TEST_F(RolledBack, RulesAreWhatTheyWereAfterAnUndo) {
  const Json before = exported(daemon_);
  Json wanted = supervised();
  wanted["components"]["first"]["properties"]["core.gain"] = 2.0;
  ASSERT_EQ(apply(wanted)["state"], "applied");
  ASSERT_NE(exported(daemon_), before);

  ASSERT_EQ(daemon_.ask("change.undo")["state"], "applied");

  EXPECT_EQ(exported(daemon_), before);
  EXPECT_FALSE(saved("3").contains("rules"));
  EXPECT_TRUE(saved("2").contains("rules"));
  EXPECT_EQ(daemon_.ask("rules.list")["items"].size(), 0U);
}

TEST_F(RolledBack, RulesThatAreAllThatChangesAreAGenerationOnProbation) {
  const Json before = exported(daemon_);

  const Json applied = apply(supervised(), {{"confirm_within", "50ms"}});

  EXPECT_EQ(applied["generation"], 2) << applied;
  EXPECT_TRUE(applied.contains("probation")) << applied;
  EXPECT_TRUE(rolled_back());
  EXPECT_EQ(exported(daemon_), before);
  EXPECT_TRUE(eventually([&] { return newest(daemon_)["mark"] == "confirmed"; }));
  EXPECT_EQ(newest(daemon_)["generation"], 3);
  EXPECT_FALSE(saved("3").contains("rules"));
}

TEST_F(RolledBack, RulesStayWhenTheirChangeIsConfirmed) {
  ASSERT_EQ(apply(supervised())["generation"], 2);
  const Json with_rules = exported(daemon_);

  ASSERT_EQ(daemon_.ask("change.confirm")["saved"], true);
  ASSERT_EQ(daemon_.ask("param.set", {{"values", {{"first.core.gain", 3.0}}}})["state"], "applied");
  ASSERT_EQ(daemon_.ask("change.undo")["state"], "applied");

  EXPECT_EQ(exported(daemon_), with_rules) << "the undone change brought no rules";
  crash(daemon_);
  daemon_.start();
  EXPECT_EQ(exported(daemon_), with_rules);
}

TEST_F(RolledBack, RulesOfAComponentThatLeavesAgainKeepNoGenerationFromStarting) {
  Json wanted = supervised("more.core.gain");
  wanted["components"]["more"] = wanted["components"]["first"];
  wanted["components"]["more"].erase("may_request");
  wanted["components"]["more"].erase("ports");
  ASSERT_EQ(apply(wanted, {{"confirm_within", "50ms"}})["state"], "applied");
  ASSERT_TRUE(rolled_back());

  ASSERT_EQ(daemon_.ask("param.set", {{"values", {{"first.core.gain", 3.0}}}})["saved"], true);
  ASSERT_EQ(daemon_.ask("change.confirm")["saved"], true);
  crash(daemon_);
  daemon_.start();

  EXPECT_EQ(daemon_.value("first.core.gain"), 3.0) << daemon_.errors();
}

TEST_F(RolledBack, PluginsAloneAreNoChangeThatCouldBe) {
  std::filesystem::copy_file(MAUVE_PLUGIN_DIR "/demo.so", daemon_.plugins() / "demo.so");
  Json wanted = plain();
  wanted["plugins"].push_back("demo");

  const Json refused = apply(wanted, {{"confirm_within", "1s"}});
  EXPECT_THAT(refused["message"].get<std::string>(), HasSubstr("nothing that runs")) << refused;
  EXPECT_EQ(daemon_.ask("plugin.list")["items"].size(), 1U);

  EXPECT_EQ(apply(wanted)["state"], "applied");
  EXPECT_EQ(generation(), 1);
  EXPECT_EQ(daemon_.ask("plugin.list")["items"].size(), 2U);
}

}  // namespace
}  // namespace mauve::test
