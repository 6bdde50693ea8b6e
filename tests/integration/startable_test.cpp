// SPDX-License-Identifier: LGPL-3.0-or-later
// Every system that a change leaves can be started: after a crash it comes back, with the rules and
// transactions that name an element which the change took away.
#include "kept_daemon.h"
#include "rt/thread/run_guarded.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// `first` has the core with the property `uses`, which no other core has. `more`: keys of the
/// file.
std::string with_names(const std::string& more) {
  std::string text(kTrial);
  const std::string resources = "\"resources\"";
  text.insert(text.find(resources), more + ",\n");
  const std::string first = R"({ "type": "trial/unit", "properties": { "fsm.period": "2ms" },)";
  return text.replace(text.find(first), first.size(),
                      R"({ "type": "trial/unit", "core": "trial/hungry",
                      "properties": { "fsm.period": "2ms", "core.uses": "1us" },)");
}

/// Each names first.core.uses, which the swap to trial/steady takes away.
const std::vector<std::string> kNames = {
    R"("transactions": { "less": [{ "set": "first.core.uses", "value": "2us" }] })",
    R"("rules": [{ "name": "r", "when": "second.core.count < 0",
                   "do": [{ "set": "first.core.uses", "value": "2us" }] }])",
    R"("rules": [{ "name": "r", "when": "first.core.uses > 1h", "do": [{ "stop": "second" }] }])",
    R"("rules": [{ "name": "r", "when": "second.core.count < 0", "until": "first.core.uses < 1s",
                   "do": [{ "stop": "second" }] }])"};

class Startable : public Generations {
 protected:
  /// The system that runs now runs again after a crash.
  void expect_the_same_after_a_crash(TrialDaemon& daemon) const {
    ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
    const auto before = exported(daemon);
    crash(daemon);
    daemon.start();
    EXPECT_EQ(exported(daemon), before) << daemon.errors();
  }
};

TEST_F(Startable, IsASystemWhoseRulesAndTransactionsNameWhatACoreTookWithIt) {
  for (const auto& names : kNames) {
    TrialDaemon daemon(with_names(names), options());

    auto swapped = daemon.ask(
        "core.swap", {{"component", "first"}, {"core", "trial/steady"}, {"probation", "off"}});

    ASSERT_EQ(swapped["saved"], true) << swapped;
    EXPECT_THAT(swapped.value("notes", Json()).dump(), HasSubstr("first.core.uses")) << names;
    expect_the_same_after_a_crash(daemon);
    EXPECT_EQ(daemon.component("first")["core"], "trial/steady") << names;
    EXPECT_TRUE(was_logged(daemon, "connection_doubtful")) << names;
    std::filesystem::remove_all(state());
  }
}

TEST_F(Startable, IsTheSystemOfARuleThatReplacesTheCoreOfItsOwnCondition) {
  TrialDaemon daemon(with_names(R"("rules": [{ "name": "r", "when": "first.core.uses < 1h",
                                   "do": [{ "swap": "first", "core": "trial/steady" }] }])"),
                     options());
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/steady"; }));
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);

  expect_the_same_after_a_crash(daemon);

  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
}

TEST_F(Startable, IsASystemToWhichARollbackLeads) {
  TrialDaemon daemon(with_names(kNames[2]), options());
  const Json to_steady = {{"component", "first"}, {"core", "trial/steady"}, {"probation", "off"}};
  auto swapped = daemon.ask("core.swap", to_steady);
  ASSERT_EQ(swapped["saved"], true) << swapped;
  ASSERT_EQ(
      daemon.ask("core.swap",
                 {{"component", "first"}, {"core", "trial/other"}, {"probation", "off"}})["saved"],
      true);

  auto back = daemon.ask("config.rollback", {{"generation", swapped["generation"]}});

  EXPECT_EQ(back["state"], "applied") << back;
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
}

TEST_F(Startable, IsASystemWhoseTransactionsKeepThePluginsThatTheyName) {
  TrialDaemon daemon(kTrial, options());
  for (const std::string name : {"types", "guidance", "guidance_extra"}) {
    const auto file = name + ".so";
    std::filesystem::copy_file(std::filesystem::path(MAUVE_PLUGIN_DIR) / file,
                               daemon.plugins() / file);
  }
  auto file = exported(daemon);
  for (const char* plugin : {"types", "guidance", "guidance_extra"}) {
    file["plugins"].push_back(plugin);
  }
  file["components"]["control"] = {{"type", "guidance/control"}, {"core", "guidance/stop"}};
  file["transactions"]["gap"] =
      Json::array({{{"swap", "control"}, {"core", "guidance_extra/widest_gap"}}});
  auto applied = daemon.ask("architecture.apply", {{"text", file.dump()}});
  ASSERT_EQ(applied["saved"], true) << applied;

  auto refused = daemon.ask("plugin.unload", {{"plugin", "guidance_extra"}});

  EXPECT_EQ(refused["data"]["id"], "plugin_in_use") << refused;
  EXPECT_THAT(refused["message"].get<std::string>(), HasSubstr("transaction gap"));
  expect_the_same_after_a_crash(daemon);
}

/// As a user takes the system to another machine, or keeps it beside the state directory.
TEST_F(Startable, IsTheExportedFileOfASystemThatLacksANameWithNoOtherNameMissing) {
  for (const auto& names : kNames) {
    TrialDaemon daemon(with_names(names), options());
    ASSERT_FALSE(exported(daemon).contains("lost")) << "nothing is missing";
    ASSERT_EQ(daemon.ask("core.swap", {{"component", "first"},
                                       {"core", "trial/steady"},
                                       {"probation", "off"}})["saved"],
              true);
    const auto file = exported(daemon);
    EXPECT_EQ(file["lost"], Json::array({"first.core.uses"})) << names;
    EXPECT_EQ(daemon.ask("config.check", {{"text", file.dump()}})["errors"], Json::array());

    auto slip = file;
    slip["rules"].push_back({{"name", "slip"},
                             {"when", "first.core.used > 1h"},
                             {"do", Json::array({{{"stop", "second"}}})}});
    const auto refused = daemon.ask("config.check", {{"text", slip.dump()}})["errors"];
    ASSERT_EQ(refused.size(), 1U) << refused;
    EXPECT_THAT(refused[0].dump(), HasSubstr("rules.slip.when"));
    auto needless = file;
    needless["lost"].push_back("first.core.gain");
    EXPECT_THAT(daemon.ask("config.check", {{"text", needless.dump()}})["errors"].dump(),
                HasSubstr("names \\\"first.core.gain\\\""));

    daemon.place().write("trial.json", file.dump());
    daemon.process().signal(SIGTERM);
    ASSERT_EQ(daemon.process().wait(), 0);
    daemon.start({"--fresh"});
    EXPECT_EQ(exported(daemon), file) << daemon.errors();
    std::filesystem::remove_all(state());
  }
}

TEST_F(Startable, IsNoFileWithASlipOfThePenInARule) {
  TrialDaemon daemon(kTrial, options());
  auto file = exported(daemon);
  file["rules"] = Json::array({{{"name", "r"},
                                {"when", "first.core.coumt > 3"},
                                {"do", Json::array({{{"stop", "second"}}})}}});

  auto checked = daemon.ask("config.check", {{"text", file.dump()}});

  ASSERT_EQ(checked["errors"].size(), 1U) << checked;
  EXPECT_THAT(checked["errors"][0].dump(), HasSubstr("first.core.count"));
}

/// The check of a start, asked of the changes that take something away.
TEST_F(Startable, IsEverySystemThatAnAcceptedChangeLeaves) {
  TrialDaemon daemon(with_names(kNames[0]), options());
  const std::vector<std::pair<std::string, Json>> changes = {
      {"component.stop", {{"components", {"second"}}}},
      {"port.disconnect", {{"port", "second.ports.input"}}},
      {"core.swap", {{"component", "first"}, {"core", "trial/other"}, {"probation", "off"}}},
      {"param.set", {{"values", {{"first.core.gain", 2.0}}}, {"probation", "off"}}},
      {"plugin.reload", {{"plugin", "trial"}, {"probation", "off"}}},
      {"component.start", {{"components", {"second"}}}}};
  for (const auto& [method, params] : changes) {
    const auto answer = daemon.ask(method, params);
    ASSERT_FALSE(answer.contains("code")) << method << answer;

    expect_the_same_after_a_crash(daemon);
  }
}

TEST_F(Startable, IsTheConfirmedSystemHoweverOftenItIsKilledFromOutside) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  for (int i = 0; i < 6; ++i) {
    crash(daemon);
    daemon.start();
    EXPECT_EQ(daemon.value("first.core.gain"), 3.0) << "after kill " << i + 1;
  }
}

/// The file and the generation fail alike: the one that failed less often is started.
TEST_F(Startable, IsTheGenerationWhenItsFileFailsToo) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "NOT TESTED: sanitizers handle faults themselves";
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  crash(daemon);
  daemon.start();
  for (int failures = 1; failures <= 3; ++failures) {
    ASSERT_EQ(daemon.value("first.core.gain"), 3.0) << failures;
    fail(daemon);
    daemon.start();
  }
  ASSERT_EQ(daemon.value("first.core.gain"), 1.0) << "the file, which has not failed yet";
  fail(daemon);
  daemon.start();

  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);
}

}  // namespace
}  // namespace mauve::test
