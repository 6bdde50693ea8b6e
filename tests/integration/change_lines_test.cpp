// SPDX-License-Identifier: LGPL-3.0-or-later
// The lines of a change state the value before and after: in its answer, the log, the history, and
// by rules. The same lines decide what a lock holds.
#include <filesystem>

#include "mauve/host/receipt.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

Json with_gain(double value) { return {{"values", {{"first.core.gain", value}}}}; }

/// How often these words stand in the log.
std::size_t times_logged(const TrialDaemon& daemon, const std::string& words) {
  const auto log = daemon.errors();
  std::size_t count = 0;
  for (auto at = log.find(words); at != std::string::npos; at = log.find(words, at + 1)) {
    ++count;
  }
  return count;
}

/// Three transactions: of a value, a connection, a stop.
std::string trial_with_rules(const std::string& rules) {
  std::string text(kTrial);
  const std::string resources = "\"resources\"";
  return text.insert(text.find(resources), R"("transactions": {
      "calm": [{ "set": "first.core.gain", "value": 1.0 }],
      "deaf": [{ "disconnect": "second.ports.input" }],
      "rest": [{ "stop": "second" }] },
    "rules": [)" + rules + "],\n");
}

Json rule_named(TrialDaemon& daemon, const std::string& name) {
  return daemon.ask("rules.list", {{"rule", name}})["items"][0];
}

TEST(Receipt, TheLogAndTheAnswerStateTheValueBeforeAndAfter) {
  TrialDaemon daemon;

  const auto receipt = daemon.ask("param.set", with_gain(2.5));

  const Json line = {{"op", "change"},
                     {"kind", "property"},
                     {"address", "first.core.gain"},
                     {"old", 1.0},
                     {"new", 2.5}};
  EXPECT_EQ(receipt["lines"], Json::array({line})) << receipt;
  EXPECT_TRUE(eventually([&] {
    return daemon.errors().find("~ first.core.gain: 1 -> 2.5") != std::string::npos;
  })) << daemon.errors();
  EXPECT_THAT(daemon.ctl({"set", "first.core.gain=1.5"}).out,
              HasSubstr("~ first.core.gain: 2.5 -> 1.5"));
}

TEST(History, ShowsWhatChangedAndComparesTwoGenerations) {
  TempDir state;
  TrialDaemon daemon(kTrial, {"--realtime", "off", "--state-dir", (state / "kept").string()});
  ASSERT_EQ(daemon.ask("param.set", with_gain(3.0))["saved"], true);
  ASSERT_EQ(daemon.ask("port.disconnect", {{"port", "second.ports.input"}})["saved"], true);
  ASSERT_EQ(daemon.ask("param.set", with_gain(4.0))["saved"], true);

  EXPECT_EQ(daemon.ask("config.history", {{"n", 1}})["items"][0]["changes"],
            "~ first.core.gain: 3 -> 4");
  const auto two = daemon.ask("config.compare", {{"from", 1}, {"to", 4}});
  EXPECT_EQ(two["same"], false) << two;
  ASSERT_EQ(two["lines"].size(), 2U) << two;
  EXPECT_EQ(two["lines"][0]["address"], "first.core.gain");
  EXPECT_EQ(two["lines"][0]["old"], 1.0);
  EXPECT_EQ(two["lines"][0]["new"], 4.0);
  EXPECT_EQ(two["lines"][1]["address"], "second.ports.input");
  EXPECT_EQ(daemon.ask("config.compare", {{"from", 1}, {"to", 1}})["same"], true);

  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");
  EXPECT_EQ(daemon.ask("config.history", {{"n", 1}})["items"][0]["changes"],
            "~ first.core.gain: 4 -> 1");
  const auto back = daemon.ask("config.rollback", {{"generation", 2}, {"dry_run", true}});
  EXPECT_EQ(back["dry_run"], true) << back;
  EXPECT_EQ(back["lines"][0]["address"], "first.core.gain") << back;
  EXPECT_EQ(daemon.ask("status.get")["generation"], 5);

  const auto said = daemon.ctl({"history", "2", "4"});
  EXPECT_EQ(said.exit, 0);
  EXPECT_THAT(said.out, HasSubstr("--- generation 2\n+++ generation 4\n"));
  EXPECT_THAT(said.out, HasSubstr("~ first.core.gain: 3 -> 4"));
  EXPECT_EQ(daemon.ctl({"history", "2"}).exit, 2);
  EXPECT_EQ(daemon.ctl({"history", "2", "77"}).exit, 4);
}

TEST(History, ShowsACoreThatWasMadeAnewAndItsDroppedState) {
  TempDir state;
  TrialDaemon daemon(kTrial, {"--realtime", "off", "--state-dir", (state / "kept").string()});

  const Json fresh = {{"component", "first"}, {"core", "trial/steady"}, {"state", "drop"}};
  ASSERT_EQ(daemon.ask("core.swap", fresh)["saved"], true);

  EXPECT_EQ(daemon.ask("config.history", {{"n", 1}})["items"][0]["changes"],
            "~ first.core: trial/steady, made anew; - first.core.state: trial_memory/1 (8 bytes)");
}

TEST(History, ComparesTheFilesOfGenerationsThatThePluginsOfNowCannotMake) {
  TempDir state;
  TrialDaemon daemon(kTrial, {"--realtime", "off", "--state-dir", (state / "kept").string()});
  ASSERT_EQ(daemon.ask("param.set", with_gain(3.0))["saved"], true);
  const auto as_it_was = daemon.plugins() / "trial.so";
  std::filesystem::rename(as_it_was, daemon.plugins() / "away");

  for (const bool backwards : {false, true}) {
    const auto two =
        daemon.ask("config.compare", {{"from", backwards ? 2 : 1}, {"to", backwards ? 1 : 2}});
    EXPECT_EQ(two["same"], false) << two;
    ASSERT_EQ(two["lines"].size(), 1U) << two;
    EXPECT_EQ(two["lines"][0]["address"], "components.first.properties.core.gain");
    EXPECT_EQ(two["lines"][0][backwards ? "old" : "new"], 3.0) << two;
    EXPECT_THAT(two["by_text"].dump(), HasSubstr("cannot be made from the plugin files of now"));
  }
  const auto said = daemon.ctl({"history", "1", "2"});
  EXPECT_EQ(said.exit, 0) << said.out;
  EXPECT_THAT(said.out, HasSubstr("+ components.first.properties.core.gain: 3"));
  EXPECT_THAT(said.out, HasSubstr("so the files are compared"));
}

TEST(RulesThatFire, ReportInOneLineOfTheLogWhatTheyFoundAndWhatTheyChanged) {
  TrialDaemon daemon(trial_with_rules(R"({ "name": "loud", "when": "second.core.input > 5",
                                     "do": "calm", "cool_down": "1h" })"));
  ASSERT_EQ(daemon.ask("param.set", with_gain(6.0))["state"], "applied");

  ASSERT_TRUE(eventually([&] { return times_logged(daemon, "calm by rule loud") > 0; }))
      << daemon.errors();
  EXPECT_EQ(times_logged(daemon, "calm by rule loud (second.core.input is 6): "), 1U)
      << daemon.errors();
  EXPECT_EQ(times_logged(daemon, "~ first.core.gain: 6 -> 1"), 1U) << daemon.errors();
  EXPECT_EQ(times_logged(daemon, "rule loud"), 1U) << daemon.errors();
}

TEST(RulesThatFire, ReportInTheLogThatTheirChangeJoinedAProbation) {
  TrialDaemon daemon(trial_with_rules(R"({ "name": "loud", "when": "second.core.input > 5",
                                     "do": "calm", "cool_down": "1h" })"));
  const auto swapped = daemon.ask(
      "core.swap", {{"component", "first"}, {"core", "trial/other"}, {"probation", "100000"}});
  ASSERT_EQ(swapped.value("state", ""), "applied") << swapped;
  ASSERT_EQ(daemon.ask("param.set", with_gain(6.0))["state"], "applied");

  ASSERT_TRUE(eventually([&] { return times_logged(daemon, "calm by rule loud") > 0; }))
      << daemon.errors();
  EXPECT_THAT(daemon.errors(),
              testing::ContainsRegex("calm by rule loud.*; .*are still on probation"));
}

TEST(RulesUnderALock, AreHeldByTheLockOfWhatTheirStepsChange) {
  TrialDaemon daemon(
      trial_with_rules(R"({ "name": "calming", "when": "second.core.count > 400", "do": "calm" },
      { "name": "deafening", "when": "second.core.count > 100000000", "do": "deaf" },
      { "name": "resting", "when": "second.core.count > 100000000", "do": "rest" })"));

  EXPECT_EQ(daemon.ask("lock.set", {{"lock", "topology"}})["rules_held"], 1) << "deafening";
  EXPECT_EQ(daemon.ask("lock.set", {{"lock", "params"}})["rules_held"], 1) << "calming";
  ASSERT_TRUE(eventually([&] { return rule_named(daemon, "calming")["state"] == "held"; }))
      << rule_named(daemon, "calming");
  EXPECT_EQ(rule_named(daemon, "calming")["why_not"], "params are locked");
}

}  // namespace
}  // namespace mauve::test
