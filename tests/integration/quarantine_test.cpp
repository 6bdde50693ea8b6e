// SPDX-License-Identifier: LGPL-3.0-or-later
// Quarantine of a core holds for every way by which a core gets in force.
#include "kept_daemon.h"

namespace mauve::test {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

constexpr const char* kFailing = "trial/throwing_job";

/// Fails on probation, so that it is in quarantine.
void quarantine(TrialDaemon& daemon, const std::string& component, Json swap = Json::object()) {
  if (!swap.contains("core")) swap["core"] = kFailing;
  swap["component"] = component;
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.ask("quarantine.list")["cores"].size() == 1U; }));
}

class Quarantine : public Generations {
 protected:
  [[nodiscard]] std::filesystem::path failure() const { return place_ / "fail"; }
  void fail() const { static_cast<void>(place_.write("fail", "")); }
  void end_failure() const { std::filesystem::remove(failure()); }
  /// A core that fails as soon as that file is there.
  [[nodiscard]] Json brittle() const {
    return {{"core", "trial/brittle"}, {"set", {{"until_there", failure().string()}}}};
  }

  static Json plain() { return Json::parse(std::string(kTrial)); }
};

Json file_with(const std::string& path, const Json& value) {
  Json file = Json::parse(std::string(kTrial));
  file[Json::json_pointer(path)] = value;
  return {{"text", file.dump()}};
}

TEST_F(Quarantine, HoldsForEveryMethodThatPutsACoreInForce) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_NO_FATAL_FAILURE(quarantine(daemon, "first"));
  const Json joining = {{"type", "trial/unit"}, {"core", kFailing}};
  const Json joining_with_fallback = {{"type", "trial/unit"}, {"fallback_core", kFailing}};
  const Json steps = {{"text", R"([{ "swap": "second", "core": "trial/throwing_job" }])"}};
  const std::vector<std::pair<std::string, Json>> ways = {
      {"core.swap", {{"component", "second"}, {"core", kFailing}}},
      {"core.swap", {{"component", "second"}, {"core", kFailing}, {"in_place", true}}},
      {"change.apply", steps},
      {"architecture.apply", file_with("/components/second/core", kFailing)},
      {"architecture.apply", file_with("/components/third", joining)},
      {"architecture.apply", file_with("/components/second/fallback_core", kFailing)},
      {"architecture.apply", file_with("/components/third", joining_with_fallback)}};
  const auto before = exported(daemon);

  for (const auto& [method, params] : ways) {
    const auto refused = daemon.ask(method, params);
    ASSERT_TRUE(refused.contains("data")) << method << params << refused;
    EXPECT_EQ(refused["data"]["name"], "wrong_state") << method << refused;
    EXPECT_EQ(refused["data"]["state"], "unchanged") << method << refused;
    EXPECT_THAT(refused["data"]["where"].get<std::string>(), EndsWith("core")) << method;
    EXPECT_THAT(refused["message"].get<std::string>(), HasSubstr("is in quarantine")) << method;
    EXPECT_THAT(refused["data"]["hint"].get<std::string>(), HasSubstr("quarantine release"));
  }
  EXPECT_EQ(exported(daemon), before);
}

TEST_F(Quarantine, OfTheCoreOfAFaultedComponentHasOneNextStepEverywhere) {
  TrialDaemon daemon(kTrial, options());
  auto swap = brittle();
  swap.update({{"component", "second"}, {"probation", "off"}});
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  Json other = brittle();
  const auto own = place_.write("own", "");
  other["set"]["until_there"] = own.string();
  ASSERT_NO_FATAL_FAILURE(quarantine(daemon, "first", other));
  fail();
  ASSERT_TRUE(eventually([&] { return daemon.component("second")["state"] == "faulted"; }));
  const std::string step =
      "mauvectl reload trial: a corrected build of trial/brittle, which is in quarantine; or "
      "mauvectl quarantine release trial/brittle, then mauvectl start second --reset";

  EXPECT_EQ(daemon.component("second")["hint"], step);
  EXPECT_TRUE(eventually([&] {  // the log comes to its records some time later
    return daemon.ask("component.why", {{"component", "second"}})["hints"][0] == step;
  })) << daemon.ask("component.why", {{"component", "second"}});
  const auto started = daemon.ask("component.start", {{"components", {"second"}}});
  EXPECT_EQ(started["notes"][0], "second may fail again: " + step) << started;

  ASSERT_TRUE(eventually([&] { return daemon.component("second")["state"] == "faulted"; }));
  ASSERT_EQ(daemon.ask("quarantine.release", {{"core", "trial/brittle"}})["changed"], true);
  end_failure();
  EXPECT_EQ(daemon.component("second")["hint"], "mauvectl start second") << "it may run again";
  const Json again = {{"components", {"second"}}, {"reset", true}};
  EXPECT_EQ(daemon.ask("component.start", again)["state"], "applied");
}

TEST_F(Quarantine, IsNotForACoreThatARuleBrings) {
  Json wanted = plain();
  wanted["rules"] = {{{"name", "tries"},
                      {"when", "second.core.gain > 5"},
                      {"do", {{{"swap", "second"}, {"core", kFailing}}}}}};
  TrialDaemon daemon(wanted.dump(), options());
  ASSERT_EQ(daemon.ask("core.swap", {{"component", "first"}, {"core", kFailing}})["state"],
            "applied");
  ASSERT_TRUE(was_logged(daemon, "quarantine_spared")) << daemon.errors();
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady") << "it failed on probation";
  EXPECT_EQ(daemon.ask("quarantine.list")["cores"], Json::array());

  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"second.core.gain", 6.0}}}})["state"], "applied");

  EXPECT_TRUE(eventually([&] { return daemon.component("second")["core"] == kFailing; }));
  EXPECT_TRUE(eventually([&] { return daemon.component("second")["state"] == "faulted"; }))
      << "no failure leads back to what the rule removed";
}

TEST_F(Quarantine, EndsForACoreThatANewRuleBrings) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_NO_FATAL_FAILURE(quarantine(daemon, "first"));
  Json wanted = plain();
  wanted["transactions"]["stand"] = {{{"swap", "second"}, {"core", kFailing}}};

  ASSERT_EQ(daemon.ask("architecture.apply", {{"text", wanted.dump()}})["state"], "applied");

  EXPECT_TRUE(eventually([&] { return daemon.ask("quarantine.list")["cores"].empty(); }));
  EXPECT_TRUE(was_logged(daemon, "quarantine_spared"));
}

TEST_F(Quarantine, HoldsForARollbackToAGenerationThatWasWell) {
  TrialDaemon daemon(kTrial, options());
  auto swap = brittle();
  swap.update({{"component", "second"}, {"probation", "off"}});
  const auto well = daemon.ask("core.swap", swap)["generation"];
  ASSERT_EQ(daemon.ask(
                "core.swap",
                {{"component", "second"}, {"core", "trial/steady"}, {"probation", "off"}})["state"],
            "applied");
  fail();
  ASSERT_NO_FATAL_FAILURE(quarantine(daemon, "first", brittle()));

  const auto refused = daemon.ask("config.rollback", {{"generation", well}});

  ASSERT_TRUE(refused.contains("data")) << refused;
  EXPECT_EQ(refused["data"]["name"], "wrong_state") << refused;
  EXPECT_EQ(refused["data"]["where"], "second.core") << refused;
  EXPECT_EQ(daemon.component("second")["core"], "trial/steady");
}

TEST_F(Quarantine, HoldsForAReloadToTheBuildThatFailed) {
  Json wanted = plain();
  wanted["components"]["first"]["core"] = "trial/regressing";
  TrialDaemon daemon(wanted.dump(), options());
  ASSERT_EQ(daemon.component("first")["state"], "running");
  daemon.install(2);
  ASSERT_EQ(daemon.ask("plugin.reload", {{"plugin", "trial"}})["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.ask("quarantine.list")["cores"].size() == 1U; }));

  const auto refused = daemon.ask("plugin.reload", {{"plugin", "trial"}});

  ASSERT_TRUE(refused.contains("data")) << refused;
  EXPECT_EQ(refused["data"]["where"], "first.core") << refused;
  EXPECT_THAT(refused["message"].get<std::string>(), HasSubstr("is in quarantine")) << refused;
}

TEST_F(Quarantine, HoldsForAFileThatLoadsThePluginOfTheCoreAgain) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_NO_FATAL_FAILURE(quarantine(daemon, "first"));
  // All that uses the plugin leaves, so that it can be unloaded.
  const Json empty = {{"schema", "mauve/architecture/1"}, {"name", "trial"}};
  ASSERT_EQ(
      daemon.ask("architecture.apply", {{"text", empty.dump()}, {"probation", "off"}})["state"],
      "applied");
  ASSERT_TRUE(eventually([&] {
    return daemon.ask("plugin.unload", {{"plugin", "trial"}}).contains("unmapped");
  }));

  const auto refused =
      daemon.ask("architecture.apply", file_with("/components/second/core", kFailing));

  ASSERT_TRUE(refused.contains("data")) << refused;
  EXPECT_EQ(refused["data"]["where"], "second.core") << refused;
  EXPECT_THAT(refused["message"].get<std::string>(), HasSubstr("is in quarantine")) << refused;
}

TEST_F(Quarantine, HoldsForAStartFromASavedGeneration) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  auto swap = brittle();
  swap.update({{"component", "second"}, {"probation", "off"}});
  ASSERT_EQ(daemon.ask("core.swap", swap)["saved"], true);
  // Another component fails with the core that goes on well in this one.
  Json other = brittle();
  const auto own = place_.write("own", "");
  other["set"]["until_there"] = own.string();
  ASSERT_NO_FATAL_FAILURE(quarantine(daemon, "first", other));
  ASSERT_EQ(daemon.component("second")["core"], "trial/brittle") << "it is in force already";
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "none"}})["saved"], true) << "and what came before";

  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.component("second")["core"], "trial/steady") << daemon.errors();
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0) << "the newest generation without that core";
  EXPECT_TRUE(was_logged(daemon, "generation_unusable"));
}

TEST_F(Quarantine, OfACoreThatTheFileNamesIsReportedAtTheStart) {
  TrialDaemon daemon(kTrial, options());
  fail();
  ASSERT_NO_FATAL_FAILURE(quarantine(daemon, "first", brittle()));
  end_failure();
  Json wanted = plain();
  wanted["components"]["second"]["core"] = "trial/brittle";
  static_cast<void>(daemon.place().write("trial.json", wanted.dump()));

  end_and_start(daemon);

  EXPECT_EQ(daemon.component("second")["core"], "trial/brittle");
  EXPECT_TRUE(was_logged(daemon, "quarantine_started"));
}

TEST_F(Quarantine, IsNotForAFallbackCore) {
  Json wanted = plain();
  auto& first = wanted["components"]["first"];
  first["core"] = "trial/brittle";
  first["properties"]["core.until_there"] = failure().string();
  first["fallback_core"] = kFailing;
  first["task"] = {{"on_fault", "fallback"}};
  TrialDaemon daemon(wanted.dump(), options());
  ASSERT_EQ(daemon.ask("core.swap", {{"component", "second"}, {"core", kFailing}})["state"],
            "applied");
  ASSERT_TRUE(was_logged(daemon, "quarantine_spared")) << daemon.errors();

  fail();

  EXPECT_TRUE(was_logged(daemon, "fell_back")) << daemon.errors();
}

}  // namespace
}  // namespace mauve::test
