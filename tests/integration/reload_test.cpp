// SPDX-License-Identifier: LGPL-3.0-or-later
// Plugins that come, are rebuilt and go while the daemon runs.
#include <algorithm>

#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// The old code goes at once: reload_probation_test.cpp is about the others.
Json without_probation() { return {{"plugin", "trial"}, {"probation", "off"}}; }
Json dropping() {
  auto params = without_probation();
  params["state"] = "drop";
  return params;
}

TEST(Reload, RunsTheNewCodeOfAFileRebuiltAtTheSamePath) {
  TrialDaemon daemon;
  ASSERT_TRUE(daemon.becomes("first.core.number", 1));
  ASSERT_TRUE(eventually([&] { return daemon.value("first.core.count") > 5; }));
  daemon.install(2);

  const auto result = daemon.ask("plugin.reload", without_probation());

  EXPECT_EQ(result["state"], "applied") << result;
  EXPECT_EQ(result["components"].size(), 2U);
  EXPECT_TRUE(daemon.becomes("first.core.number", 2));
  EXPECT_TRUE(daemon.becomes("second.core.number", 2));
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Reload, SaysThatTheFileHasTheBuildThatRunsAlready) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  const std::string same = "the file has the build that runs already";

  auto planned = without_probation();
  planned["dry_run"] = true;
  EXPECT_THAT(daemon.ask("plugin.reload", planned)["notes"].dump(), testing::HasSubstr(same));
  EXPECT_THAT(daemon.ask("plugin.reload", without_probation())["notes"].dump(),
              testing::HasSubstr(same));
  daemon.install(2);
  EXPECT_THAT(daemon.ask("plugin.reload", without_probation()).value("notes", Json()).dump(),
              testing::Not(testing::HasSubstr(same)));
}

TEST(Reload, UnmapsTheOldCodeAndKeepsTheConnections) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  daemon.install(2);

  const auto result = daemon.ask("plugin.reload", without_probation());

  EXPECT_EQ(result["unmapped"], true) << result;
  EXPECT_EQ(result["why"], "");
  EXPECT_TRUE(daemon.becomes("signal.read", 1.0)) << "connections are kept";
  EXPECT_TRUE(daemon.becomes("second.core.input", 1.0));
  EXPECT_EQ(daemon.ask("param.set", {{"values", {{"first.shell.size", 8}}}})["state"], "applied");
}

TEST(Reload, KeepsTheOldCodeWhenTheNewFileIsDamaged) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  std::filesystem::remove(daemon.plugins() / "trial.so");
  daemon.place().write("plugins/trial.so", "this is no library");

  const auto error = daemon.ask("plugin.reload", without_probation());

  EXPECT_EQ(error["data"]["name"], "plugin_refused") << error;
  EXPECT_EQ(daemon.component("first")["state"], "running");
  EXPECT_EQ(daemon.ask("status.get")["generation"], 1);
  EXPECT_EQ(daemon.ask("param.set", {{"values", {{"first.core.gain", 2}}}})["state"], "applied");
}

TEST(Reload, CanBeDoneOverAndOver) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  for (int round = 0; round < 10; ++round) {
    daemon.install(round % 2 == 0 ? 2 : 1);
    ASSERT_EQ(daemon.ask("plugin.reload", without_probation())["state"], "applied") << round;
    EXPECT_TRUE(daemon.becomes("first.core.number", round % 2 == 0 ? 2 : 1));
  }
  EXPECT_EQ(daemon.ask("param.set", {{"values", {{"first.core.gain", 2}}}})["state"], "applied");
}

TEST(Reload, ConvertsTheStateOfAnOlderRevisionAndUnmapsItsCode) {
  TrialDaemon daemon;
  ASSERT_TRUE(eventually([&] { return daemon.value("first.core.count") > 50; }));
  daemon.install(3);

  const auto result = daemon.ask("plugin.reload", without_probation());

  EXPECT_EQ(result["unmapped"], true) << result;
  EXPECT_EQ(result["components"][0]["bytes"], 8);
  EXPECT_TRUE(daemon.becomes("first.core.number", 3));
  EXPECT_GT(daemon.value("first.core.count"), 50);
}

TEST(Reload, AndUndoSayThatARollbackContinuesWithTheStateBeforeAConversion) {
  TrialDaemon daemon;
  ASSERT_TRUE(daemon.becomes("first.core.number", 1)) << daemon.errors();
  daemon.install(3);

  const auto result = daemon.ask("plugin.reload", {{"plugin", "trial"}});
  const auto plan = daemon.ask("change.undo", {{"dry_run", true}});
  const auto undone = daemon.ask("change.undo");

  EXPECT_EQ(result["components"][0]["converted"], "trial_memory/1 -> trial_memory/2") << result;
  for (const auto& answer : {result, plan, undone}) {
    EXPECT_THAT(answer["notes"].dump(),
                HasSubstr("first: a rollback continues with the state from before the change"))
        << answer;
  }
}

TEST(Reload, RefusesToLoseAStateUnlessTheRequestSaysDrop) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  daemon.install(3);
  ASSERT_EQ(daemon.ask("plugin.reload", without_probation())["state"], "applied");
  daemon.install(1);

  const auto error = daemon.ask("plugin.reload", without_probation());
  EXPECT_EQ(error["data"]["name"], "type_mismatch") << error;
  EXPECT_EQ(daemon.value("first.core.number"), 3);

  EXPECT_EQ(daemon.ask("plugin.reload", dropping())["state"], "applied");
  EXPECT_TRUE(daemon.becomes("first.core.number", 1));
}

/// "first" fails when there is a file "fail", and falls back on a core that makes a file "ready"
/// when it is configured.
std::string with_fallback(const TempDir& place) {
  std::string text(kTrial);
  const std::string first = R"("first":  { "type": "trial/unit", "properties": {)";
  return text.replace(text.find(first), first.size(),
                      R"("first": { "type": "trial/unit",
    "core": "trial/brittle", "task": { "on_fault": "fallback" },
    "fallback_core": { "core": "trial/slow", "properties": { "core.configure_time": "1ms",
                       "core.marker": ")" +
                          (place / "ready").string() + R"(" } },
    "properties": { "core.until_there": ")" +
                          (place / "fail").string() + R"(", )");
}

TEST(Reload, RenewsTheFallbackCores) {
  const TempDir place;
  TrialDaemon daemon(with_fallback(place));
  ASSERT_TRUE(daemon.becomes("first.core.number", 1)) << daemon.errors();
  std::filesystem::remove(place / "ready");
  daemon.install(2);

  const auto result = daemon.ask("plugin.reload", without_probation());

  EXPECT_EQ(result["unmapped"], true) << result;
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(place / "ready"); }));
  // It is served when the fallback core stands by.
  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"second.core.gain", 2}}}})["state"], "applied");
  place.write("fail", "");
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/slow"; }));
  EXPECT_TRUE(daemon.becomes("first.core.number", 2));
  EXPECT_EQ(daemon.errors().find("no core stands by"), std::string::npos) << daemon.errors();
}

TEST(Reload, FallsBackWhenTheNewCodeFailsInItsFirstJob) {
  std::string text(kTrial);
  const std::string first = R"("first":  { "type": "trial/unit",)";
  text.replace(text.find(first), first.size(), first + R"(
    "core": "trial/regressing", "fallback_core": "trial/other",
    "task": { "on_fault": "fallback" },)");
  TrialDaemon daemon(text);
  ASSERT_TRUE(daemon.becomes("first.core.number", 1)) << daemon.errors();

  for (int round = 0; round < 3; ++round) {
    daemon.install(2);
    ASSERT_EQ(daemon.ask("plugin.reload", without_probation())["state"], "applied");
    ASSERT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/other"; }))
        << daemon.component("first");
    EXPECT_EQ(daemon.component("first")["state"], "running");
    daemon.install(1);
    ASSERT_EQ(daemon.ask("plugin.reload", without_probation())["state"], "applied");
    const Json back = {{"component", "first"}, {"core", "trial/regressing"}, {"probation", "off"}};
    ASSERT_EQ(daemon.ask("core.swap", back)["state"], "applied");
  }
}

/// "first" writes into a resource of the plugin, "second" reads shared data as before.
std::string with_tally() {
  std::string text(kTrial);
  const std::string resources = R"("resources": {)";
  text.insert(text.find(resources) + resources.size(), R"(
    "tally": { "type": "trial/tally", "lock_budget": "1ms",
               "properties": { "core.gain": 3.5 } },)");
  const std::string output = R"("output": "signal.write")";
  return text.replace(text.find(output), output.size(), R"("output": "tally.note")");
}

class ReloadOfResources : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(daemon.becomes("tally.core.number", 1)) << daemon.errors();
    ASSERT_TRUE(eventually([&] { return daemon.value("tally.core.count") > 50; }));
  }

  TrialDaemon daemon{with_tally()};
};

TEST_F(ReloadOfResources, RunsTheNewCodeWithTheOldStateAndUnmapsTheOldCode) {
  daemon.install(2);

  const auto result = daemon.ask("plugin.reload", without_probation());

  EXPECT_EQ(result["state"], "applied") << result;
  EXPECT_EQ(result["unmapped"], true) << result;
  EXPECT_EQ(result["sync"], "barrier");
  EXPECT_EQ(result["components"].size(), 3U) << result;
  EXPECT_TRUE(daemon.becomes("tally.core.number", 2));
  EXPECT_TRUE(daemon.becomes("first.core.number", 2));
  EXPECT_GT(daemon.value("tally.core.count"), 50);
  EXPECT_EQ(daemon.value("tally.core.gain"), 3.5);
  EXPECT_EQ(daemon.ask("object.get", {{"address", "tally"}})["lock_budget"], "1ms");
  EXPECT_EQ(daemon.ask("status.get")["generation"], 2);
}

TEST_F(ReloadOfResources, ConvertsTheirStateOrRefusesToLoseIt) {
  daemon.install(3);
  ASSERT_EQ(daemon.ask("plugin.reload", without_probation())["state"], "applied");
  EXPECT_TRUE(daemon.becomes("tally.core.number", 3));
  EXPECT_GT(daemon.value("tally.core.count"), 50);
  daemon.install(1);

  const auto error = daemon.ask("plugin.reload", without_probation());

  EXPECT_EQ(error["data"]["name"], "type_mismatch") << error;
  EXPECT_EQ(daemon.value("tally.core.number"), 3);
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST_F(ReloadOfResources, CanBeDoneOverAndOver) {
  for (int round = 0; round < 6; ++round) {
    const int build = round % 2 == 0 ? 2 : 1;
    daemon.install(build);
    const auto result = daemon.ask("plugin.reload", without_probation());
    ASSERT_EQ(result["unmapped"], true) << result;
    ASSERT_TRUE(daemon.becomes("tally.core.number", build));
  }
}

TEST_F(ReloadOfResources, TheirShellPropertiesCanBeSet) {
  const auto result = daemon.ask("param.set", {{"values", {{"tally.shell.size", 8}}}});

  EXPECT_EQ(result["state"], "applied") << result;
  EXPECT_EQ(result["sync"], "barrier");
  EXPECT_TRUE(daemon.becomes("tally.core.size", 8));
  EXPECT_GT(daemon.value("tally.core.count"), 50);
  EXPECT_EQ(daemon.value("tally.core.gain"), 3.5);
}

/// The texts that "first" has logged so far: "one says 7".
std::vector<std::string> said(TrialDaemon& daemon) {
  std::vector<std::string> texts;
  const auto tail = daemon.ask("log.tail", {{"component", "first"}, {"n", 4096}});
  for (const auto& record : tail["records"]) {
    const auto text = record["text"].get<std::string>();
    if (text.find(" says ") != std::string::npos) {
      texts.push_back(text);
    }
  }
  return texts;
}

TEST(Reload, KeepsWhatTheOldCodeLoggedUpToItsLastJob) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/talking"}})["state"],
            "applied");
  ASSERT_TRUE(eventually([&] { return !said(daemon).empty(); }));
  daemon.install(2);

  const auto result = daemon.ask("plugin.reload", without_probation());

  ASSERT_EQ(result["unmapped"], true) << result;
  ASSERT_TRUE(eventually([&] { return said(daemon).back().starts_with("two"); }));
  const auto texts = said(daemon);
  const auto number = [](const std::string& text) { return std::stoi(text.substr(9)); };
  for (std::size_t i = 1; i < texts.size(); ++i) {
    EXPECT_EQ(number(texts[i]), number(texts[i - 1]) + 1) << texts[i];
  }
  EXPECT_TRUE(texts.front().starts_with("one"));
}

TEST(Load, BringsAPluginThatWasNotThereAtTheStart) {
  TrialDaemon daemon(R"({ "schema": "mauve/architecture/1", "name": "empty", "components": {} })");
  EXPECT_EQ(daemon.ask("plugin.list")["items"].size(), 0U);

  const auto loaded = daemon.ask("plugin.load", {{"plugin", "trial"}});

  EXPECT_EQ(loaded["loaded"], true) << loaded;
  EXPECT_EQ(daemon.ask("plugin.list")["items"][0]["name"], "trial");
}

TEST(Reload, OfAPluginThatNothingUsesTakesTheNewFile) {
  TrialDaemon daemon(
      R"({ "schema": "mauve/architecture/1", "name": "idle", "plugins": ["trial"] })");
  daemon.install(2);

  const auto reloaded = daemon.ask("plugin.reload", without_probation());

  EXPECT_EQ(reloaded["state"], "applied") << reloaded;
  EXPECT_EQ(reloaded["unmapped"], true) << reloaded;
}

TEST(Watch, OutlivesTheResourceItLooksAt) {
  TrialDaemon daemon;
  auto file = daemon.ask("config.get")["architecture"];
  auto watcher = daemon.client();
  const auto watched = watcher.ask("watch.subscribe", {{"addresses", {"count.read"}}})["result"];
  ASSERT_TRUE(watched.contains("sub")) << watched;

  const auto with_it = file.dump();
  file["resources"].erase("count");
  const auto apply = [&](const std::string& text) {
    return daemon.ask("architecture.apply", {{"text", text}, {"probation", "off"}})["state"];
  };
  ASSERT_EQ(apply(file.dump()), "applied");
  Json value = 0;
  while (!value.is_null()) value = watcher.notification("value")["params"]["value"];
  ASSERT_EQ(apply(with_it), "applied");
  const auto replaced = watcher.notification("replaced")["params"];
  EXPECT_EQ(replaced, (Json{{"sub", watched["sub"]}, {"address", "count.read"}}));
  EXPECT_TRUE(watcher.ask("watch.unsubscribe", {{"sub", watched["sub"]}}).contains("result"));

  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Watch, GoesOnAtAResourceThatComputesItsValue) {
  TrialDaemon daemon;
  auto file = daemon.ask("config.get")["architecture"];
  auto watcher = daemon.client();
  const auto watched = watcher.ask("watch.subscribe", {{"addresses", {"count.read"}}})["result"];
  ASSERT_TRUE(watched.contains("sub")) << watched;

  file["resources"]["count"] = {{"type", "trial/meter"}, {"properties", {{"core.breaks_at", 7.5}}}};
  const Json apply = {{"text", file.dump()}, {"probation", "off"}};
  const auto applied = daemon.ask("architecture.apply", apply);
  ASSERT_EQ(applied["state"], "applied") << applied;

  const auto value = watcher.notification("value")["params"];
  EXPECT_EQ(value["value"], 7.5) << value;
  EXPECT_EQ(watcher.notification("replaced")["params"]["address"], "count.read");
}

/// Its calls are few, so that they do not come to ten times those of the one before.
TEST(LockBudgetOfAResource, IsCountedAnewForOneThatTakesTheNameOfAnother) {
  auto held = Json::parse(with_tally());
  held["resources"]["tally"]["lock_budget"] = "1ns";
  TrialDaemon daemon(held.dump());
  const auto counts = [&] {
    std::vector<std::int64_t> all;
    const auto tail = daemon.ask("log.tail", {{"n", 1000}});
    for (const auto& record : tail["records"]) {
      if (record["event"] == "lock_budget_exceeded") all.push_back(record["fields"]["count"]);
    }
    return all;
  };
  ASSERT_TRUE(eventually([&] { return !counts().empty() && counts().back() >= 100; }));

  ASSERT_EQ(daemon.ask("architecture.apply", {{"text", kTrial}})["state"], "applied");
  held["components"]["first"]["properties"]["fsm.period"] = "100ms";
  ASSERT_EQ(daemon.ask("architecture.apply", {{"text", held.dump()}})["state"], "applied");

  EXPECT_TRUE(eventually([&] { return !std::ranges::is_sorted(counts()); }));
}

}  // namespace
}  // namespace mauve::test
