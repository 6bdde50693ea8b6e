// SPDX-License-Identifier: LGPL-3.0-or-later
// Further facts in the answer to a change: components that do not run, values that differ now.
#include <set>

#include "base/duration.h"
#include "kept_daemon.h"
#include "mauve/host/value.h"

namespace mauve::test {
namespace {

Json swap_first(const std::string& core, const std::string& probation = "3000") {
  return {{"component", "first"}, {"core", core}, {"probation", probation}};
}

TEST(Swap, KeepsTheValuesInForceUnlessTheRequestSaysDefaults) {
  TrialDaemon daemon;
  static_cast<void>(daemon.ask("param.set", {{"values", {{"first.core.gain", 3.0}}}}));

  const auto kept = daemon.ask("core.swap", swap_first("trial/other"));
  EXPECT_FALSE(kept.contains("defaults")) << kept;
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);
  auto defaults = swap_first("trial/steady");
  defaults["defaults"] = true;
  const auto answer = daemon.ask("core.swap", defaults);
  EXPECT_EQ(answer["defaults"], Json::array({{{"name", "gain"}, {"before", 3.0}, {"after", 1.0}}}))
      << answer;
  defaults = swap_first("trial/other");
  defaults["defaults"] = true;
  defaults["set"] = {{"gain", 4.0}};
  EXPECT_FALSE(daemon.ask("core.swap", defaults).contains("defaults")) << "it was said";
  const Json in_place = {
      {"component", "first"}, {"core", "trial/steady"}, {"in_place", true}, {"defaults", true}};
  EXPECT_EQ(daemon.ask("core.swap", in_place)["defaults"][0]["before"], 4.0);
}

TEST(Swap, SaysWhichStateItDropsInItsAnswerAndInTheLog) {
  TrialDaemon daemon;
  auto drop = swap_first("trial/other");
  drop["state"] = "drop";

  const auto answer = daemon.ask("core.swap", drop);
  const std::string state = answer["components"][0]["dropped"];
  EXPECT_FALSE(state.empty()) << answer;
  EXPECT_GT(answer["components"][0]["dropped_bytes"], 0);
  EXPECT_TRUE(eventually([&] {
    return daemon.errors().find("first (its state " + state + ", ") != std::string::npos;
  })) << daemon.errors();
  EXPECT_FALSE(
      daemon.ask("core.swap", swap_first("trial/steady"))["components"][0].contains("dropped"));
}

TEST(Swap, WithDefaultsChangesValuesAndSoIsRefusedWhileParamsAreLocked) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"first.core.gain", 2.5}}}})["state"], "applied");
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "params"}})["lock"], "params");
  auto defaults = swap_first("trial/other");
  defaults["defaults"] = true;

  EXPECT_EQ(daemon.ask("core.swap", defaults)["data"]["name"], "conflict");
  EXPECT_EQ(daemon.ask("core.swap", swap_first("trial/other"))["state"], "applied");
}

/// The core fails in its first job, and the fallback core may be in force before the answer.
TEST_F(Generations, AreInTheHistoryWhenTheirAnswerSaysSavedUnlessItNamesTheOneThatFollowed) {
  auto falls_back = Json::parse(std::string(kTrial));
  falls_back["components"]["first"]["task"]["on_fault"] = "fallback";
  falls_back["components"]["first"]["fallback_core"] = "trial/other";
  TrialDaemon daemon(falls_back.dump(), options());

  for (int i = 0; i < 8; ++i) {
    const auto answer = daemon.ask("core.swap", swap_first("trial/throwing_job", "off"));
    ASSERT_TRUE(answer.value("saved", false)) << answer;
    std::set<std::uint64_t> kept;
    const auto history = daemon.ask("config.history");
    for (const auto& row : history["items"]) kept.insert(row["generation"].get<std::uint64_t>());
    const auto said = answer.value("notes", Json::array()).dump();
    const bool named = said.find("so the history has no generation") != std::string::npos;
    EXPECT_NE(kept.contains(answer["generation"]), named) << answer << history;
    // The next swap would be refused while the core fails.
    ASSERT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/other"; }));
  }
}

TEST(Start, OfWhatRunsAndStopOfWhatIsStoppedSayThatItIsSo) {
  TrialDaemon daemon;

  const auto runs = daemon.ask("component.start", {{"components", {"first"}}});
  EXPECT_EQ(runs["changed"], false) << runs;
  EXPECT_EQ(runs["already"], Json::array({"first"}));
  EXPECT_EQ(runs["already_state"], "running");
  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"first"}}})["changed"], true);
  const auto stopped = daemon.ask("component.stop", {{"components", {"first", "second"}}});
  EXPECT_EQ(stopped["already"], Json::array({"first"})) << stopped;
  EXPECT_EQ(stopped["already_state"], "stopped");
}

TEST(Start, TakesNamesAsASet) {
  TrialDaemon daemon;

  const Json twice = {{"components", {"first", "first"}}};
  EXPECT_EQ(daemon.ask("component.stop", twice)["state"], "applied");
  EXPECT_EQ(daemon.ask("component.start", twice)["state"], "applied");
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Start, OfAllStartsWhatDoesNotRun) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"second"}}})["state"], "applied");

  const auto started = daemon.ask("component.start", {{"all", true}});
  EXPECT_EQ(started["components"].size(), 1U) << started;
  EXPECT_EQ(started["components"][0]["name"], "second");
  EXPECT_EQ(started["already"], Json::array({"first"}));
  EXPECT_EQ(daemon.ask("component.start", {{"all", true}})["changed"], false);
  EXPECT_EQ(daemon.ask("component.start", {{"all", true}, {"reset", true}})["changed"], false);
}

TEST(Swap, SaysThatTheComponentDoesNotRun) {
  TrialDaemon daemon;
  static_cast<void>(daemon.ask("core.swap", swap_first("trial/throwing_job", "off")));
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }));
  EXPECT_EQ(daemon.component("first")["hint"], "mauvectl start first");

  const auto swapped = daemon.ask("core.swap", swap_first("trial/other"));
  EXPECT_EQ(swapped["standing"][0]["name"], "first") << swapped;
  EXPECT_EQ(swapped["standing"][0]["state"], "faulted");
  EXPECT_EQ(swapped["standing"][0]["hint"], "mauvectl start first");
  daemon.install(2);
  const auto reloaded = daemon.ask("plugin.reload", {{"plugin", "trial"}, {"probation", "off"}});
  EXPECT_EQ(reloaded["standing"][0]["name"], "first") << reloaded;

  const auto started = daemon.ask("component.start", {{"components", {"first"}}});
  EXPECT_FALSE(started.contains("standing")) << started;
  const auto stopped = daemon.ask("component.stop", {{"components", {"first"}}});
  EXPECT_FALSE(stopped.contains("standing")) << "it was asked for: " << stopped;
  EXPECT_EQ(daemon.ask("core.swap", swap_first("trial/steady"))["standing"][0]["state"], "stopped");
}

TEST(Value, OfAStatisticIsTheOneThatItsComponentShows) {
  TrialDaemon daemon;
  ASSERT_TRUE(eventually([&] { return daemon.value("first.core.count") > 10; }));
  // Nothing changes them any more.
  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"first"}}})["state"], "applied");

  const auto shown = daemon.ask("object.get", {{"address", "first"}})["counters"];

  for (const std::string name : {"late", "lateness_max", "elapsed_max"}) {
    const std::chrono::nanoseconds time(shown[name + "_ns"].get<std::int64_t>());
    EXPECT_EQ(daemon.value("first." + name), format_duration(time)) << name << shown;
  }
}

TEST(Show, OfACoreHasItsTypeItsStateAndItsProperties) {
  TrialDaemon daemon;

  const auto core = daemon.ask("object.get", {{"address", "first.core"}});

  EXPECT_EQ(core["kind"], "core") << core;
  EXPECT_EQ(core["type"], daemon.component("first")["core"]);
  EXPECT_EQ(core["core_state"]["bytes"], 8) << core;
  EXPECT_EQ(core["core_state"], daemon.ask("object.get", {{"address", "first"}})["core_state"]);
  ASSERT_TRUE(core.contains("properties") && !core["properties"].empty()) << core;
  for (const auto& property : core["properties"]) {
    EXPECT_EQ(property["name"].get<std::string>().substr(0, 5), "core.") << property;
  }
  EXPECT_EQ(daemon.ask("object.get", {{"address", "nobody.core"}})["data"]["id"],
            "unknown_element");
}

TEST(Show, OfATypeOfDataHasItsSizeAndItsFields) {
  TrialDaemon daemon;
  std::filesystem::copy_file(MAUVE_PLUGIN_DIR "/types.so", daemon.plugins() / "types.so");
  ASSERT_EQ(daemon.ask("plugin.load", {{"plugin", "types"}})["loaded"], true);

  const auto type = daemon.ask("object.get", {{"address", "velocity/1"}});
  const auto number = daemon.ask("object.get", {{"address", "double"}});
  const auto unknown = daemon.ask("object.get", {{"address", "velocty/1"}});
  const auto brought = daemon.ask("object.get", {{"address", "trial/steady"}});
  EXPECT_EQ(brought["data"]["hint"], "mauvectl explain trial/steady says what this name is");

  EXPECT_EQ(type["kind"], "type") << type;
  EXPECT_EQ(type["bytes"], 16);
  EXPECT_EQ(
      type["fields"][1],
      (Json{
          {"name", "angular"}, {"kind", "double"}, {"unit", "rad/s"}, {"text", "anticlockwise"}}));
  EXPECT_EQ(number["bytes"], 8) << number;
  EXPECT_FALSE(number.contains("fields")) << number;
  EXPECT_EQ(unknown["data"]["name"], "unknown_name") << unknown;
  EXPECT_NE(unknown.dump().find("velocity/1"), std::string::npos) << unknown;
}

TEST(Show, OfACoreOfAResourceHasItsType) {
  TrialDaemon daemon;

  const auto core = daemon.ask("object.get", {{"address", "signal.core"}});

  EXPECT_EQ(core["type"], daemon.ask("object.get", {{"address", "signal"}})["type"]) << core;
}

/// The period of `first` is 2 ms.
TEST(Swap, SaysWhenTheJobsOfAProbationEndItBeforeItsTimeDoes) {
  TrialDaemon daemon;
  for (const bool in_place : {false, true}) {
    Json swap = swap_first("trial/other");
    swap["in_place"] = in_place;
    EXPECT_EQ(daemon.ask("core.swap", swap)["probation"]["jobs_ns"], 6'000'000'000);
    EXPECT_TRUE(eventually([&] {
      const auto one = daemon.ask("status.get")["probations"][0];
      return one["jobs"] == 3000 && one["jobs_left"] < 3000;
    }));
    ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");
  }
  const Json slow = {{"values", {{"second.fsm.period", "5s"}}}};
  EXPECT_FALSE(daemon.ask("param.set", slow)["probation"].contains("jobs_ns"));
}

}  // namespace
}  // namespace mauve::test
