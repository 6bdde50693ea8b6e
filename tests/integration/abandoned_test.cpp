// SPDX-License-Identifier: LGPL-3.0-or-later
// Hooks that do not return: the change is dropped, its thread is abandoned, and the next one works.
#include <cstdlib>

#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

/// Gives up after three seconds, which no hook that returns takes. While the file `gate` is there,
/// the stuck cores of "trial" are stuck.
class Abandoned : public testing::Test {
 protected:
  void begin(const std::string& within = "3s", const std::string& architecture = kTrial) {
    setenv("MAUVE_TRIAL_WAITS", gate_.c_str(), 1);
    daemon_ = std::make_unique<TrialDaemon>(
        architecture, std::vector<std::string>{"--realtime", "off", "--prepare-within", within});
    unsetenv("MAUVE_TRIAL_WAITS");
    static_cast<void>(daemon_->client());
    close();
  }
  void close() const { static_cast<void>(files_.write("gate", "closed")); }
  void open() const { std::filesystem::remove(gate_); }

  Json ask(const std::string& method, Json params = Json::object()) {
    return daemon_->ask(method, std::move(params));
  }
  Json swap(const std::string& core, Json more = Json::object()) {
    Json params = {{"component", "first"}, {"core", core}};
    params.update(more);
    return ask("core.swap", params);
  }
  Json swap_to_stuck(const Json& more = Json::object()) {
    Json params = {{"set", {{"while_there", gate_}, {"cleaned", cleaned_}}}};
    params.update(more);
    return swap("trial/stuck", params);
  }
  Json abandoned_threads() { return ask("status.get")["abandoned_threads"]; }
  /// The next change, of another component, goes through.
  void expect_next_change_works(double gain) {
    const auto next = ask("param.set", {{"values", {{"second.core.gain", gain}}}});
    EXPECT_EQ(next["state"], "applied") << next;
  }

  TempDir files_;
  const std::string gate_ = (files_ / "gate").string();
  const std::string cleaned_ = (files_ / "cleaned").string();
  std::unique_ptr<TrialDaemon> daemon_;
};

TEST_F(Abandoned, TheOldCoreRunsOnAndTheNextChangeGoesThrough) {
  begin();
  const auto before = daemon_->component("first");

  const auto error = swap_to_stuck();

  EXPECT_EQ(error["data"]["name"], "timed_out") << error;
  EXPECT_EQ(error["data"]["where"], "first.core");
  EXPECT_EQ(error["data"]["state"], "unchanged");
  EXPECT_EQ(error["data"]["generation"], 1);
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("on_configure did not return"));
  EXPECT_THAT(error["data"]["hint"].get<std::string>(), HasSubstr("abandoned"));
  const auto after = daemon_->component("first");
  EXPECT_EQ(after["core"], "trial/steady");
  EXPECT_EQ(after["state"], "running");
  EXPECT_GE(after["releases"].get<int>() + after["missed"].get<int>(),
            before["releases"].get<int>() + before["missed"].get<int>() + 400)
      << "a second of its grid";
  EXPECT_GT(after["releases"], before["releases"]);
  expect_next_change_works(2.0);
  EXPECT_EQ(ask("status.get")["generation"], 2);
}

TEST_F(Abandoned, WhatReturnsLateIsCleanedUpAndNeverInForce) {
  begin();
  ASSERT_EQ(swap_to_stuck()["data"]["name"], "timed_out");
  ASSERT_EQ(abandoned_threads().size(), 1U);
  EXPECT_FALSE(std::filesystem::exists(cleaned_));

  open();

  EXPECT_TRUE(eventually([&] { return abandoned_threads().empty(); }));
  EXPECT_TRUE(std::filesystem::exists(cleaned_));
  EXPECT_EQ(daemon_->component("first")["core"], "trial/steady");
  EXPECT_EQ(ask("status.get")["generation"], 1);
  EXPECT_EQ(swap_to_stuck()["state"], "applied") << "it does not hang any more";
  daemon_->process().signal(SIGTERM);
  EXPECT_EQ(daemon_->process().wait(), 0) << "no thread is abandoned";
}

TEST_F(Abandoned, IsReportedInStatusAndLog) {
  begin();
  ASSERT_EQ(swap_to_stuck()["data"]["name"], "timed_out");

  EXPECT_EQ(abandoned_threads()[0]["hook"], "first.core on_configure");
  EXPECT_THAT(abandoned_threads()[0]["since"].get<std::string>(), HasSubstr("T"));
  EXPECT_THAT(daemon_->ctl({"status"}).out,
              HasSubstr("abandoned thread: first.core on_configure since "));
  EXPECT_TRUE(eventually([&] {
    const auto records = ask("log.tail", {{"level", "error"}})["records"];
    return !records.empty() && records[0]["event"] == "hook_abandoned";
  }));
  const auto unload = ask("plugin.unload", {{"plugin", "trial"}});
  EXPECT_THAT(unload["message"].get<std::string>(), HasSubstr("trial/stuck"));
}

/// Each try would leave one more thread behind, until nobody could change anything.
TEST_F(Abandoned, ARuleDoesNotTryAgain) {
  std::string supervised(kTrial);
  const std::string resources = "\"resources\"";
  supervised.insert(supervised.find(resources), R"("rules": [{ "name": "alone",
      "when": "second.state == stopped", "cool_down": "1ms",
      "do": [{ "swap": "first", "core": "trial/stuck_constructor" }] }],
    )");
  begin("3s", supervised);
  const auto rule = [this] { return ask("rules.list")["items"][0]; };

  ask("component.stop", {{"components", {"second"}}});

  ASSERT_TRUE(eventually([&] {
    return rule()["answer"].get<std::string>().find("did not return") != std::string::npos;
  })) << rule();
  EXPECT_EQ(rule()["state"], "fired") << rule();
  EXPECT_EQ(abandoned_threads().size(), 1U);
  EXPECT_EQ(ask("param.set", {{"values", {{"second.core.gain", 2.0}}}})["state"], "applied");
}

TEST_F(Abandoned, EndsInBoundedTimeWithAnAbandonedThread) {
  begin();
  ASSERT_EQ(swap_to_stuck()["data"]["name"], "timed_out");

  daemon_->process().signal(SIGTERM);

  EXPECT_EQ(daemon_->process().wait(), 1) << "a thread was abandoned";
  EXPECT_THAT(daemon_->errors(), testing::Not(HasSubstr("without waiting any longer")));
  EXPECT_TRUE(daemon_->says("first.core on_configure did not return in time")) << daemon_->errors();
  EXPECT_TRUE(
      daemon_->says("ends with code 1, since threads did not come back: the hook "
                    "first.core on_configure"))
      << daemon_->errors();
  EXPECT_TRUE(daemon_->says("info    stopped")) << daemon_->errors();
}

TEST_F(Abandoned, IsAConstructorThatDoesNotReturn) {
  begin();

  const auto error = swap("trial/stuck_constructor");

  EXPECT_EQ(error["data"]["name"], "timed_out") << error;
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("constructor did not return"));
  expect_next_change_works(2.0);
}

TEST_F(Abandoned, IsADestructorThatDoesNotReturnAfterTheAnswer) {
  begin();
  ASSERT_EQ(swap("trial/stuck_destructor", {{"probation", "off"}})["state"], "applied");

  ASSERT_EQ(swap("trial/steady", {{"probation", "off"}})["state"], "applied");

  expect_next_change_works(2.0);
  EXPECT_EQ(abandoned_threads()[0]["hook"], "first destructor");
}

TEST_F(Abandoned, InPlaceLeavesTheComponentSafeAndClosedToChanges) {
  begin();
  ASSERT_TRUE(daemon_->becomes("signal.read", 1.0));

  const auto error = swap_to_stuck({{"in_place", true}});

  EXPECT_EQ(error["data"]["name"], "timed_out") << error;
  EXPECT_EQ(error["data"]["state"], "safe");
  EXPECT_EQ(daemon_->component("first")["state"], "stopped");
  EXPECT_TRUE(daemon_->becomes("signal.read", -1.0)) << "its safe value";
  const auto refused = ask("component.start", {{"components", {"first"}}});
  EXPECT_EQ(refused["data"]["name"], "wrong_state") << refused;
  EXPECT_THAT(refused["message"].get<std::string>(), HasSubstr("abandoned"));
  EXPECT_EQ(ask("plugin.reload", {{"plugin", "trial"}, {"probation", "off"}})["data"]["name"],
            "wrong_state");
  expect_next_change_works(2.0);
  open();
  EXPECT_TRUE(eventually([&] { return abandoned_threads().empty(); }));
  EXPECT_EQ(daemon_->component("first")["state"], "stopped");
}

TEST_F(Abandoned, IsAFileWhoseElementsAreNotMadeInTime) {
  begin();
  std::string text(kTrial);
  const std::string name = "\"trial/unit\",";
  text.replace(text.find(name), name.size(), name + " \"core\": \"trial/stuck_constructor\",");

  const auto error = ask("architecture.apply", {{"text", text}});

  EXPECT_EQ(error["data"]["name"], "timed_out") << error;
  EXPECT_EQ(error["data"]["where"], "first.core");
  EXPECT_EQ(abandoned_threads(), Json::array()) << "it was another process that hung";
  expect_next_change_works(2.0);
}

TEST_F(Abandoned, IsAReloadWhoseNewCoresAreNotReady) {
  begin();
  open();
  ASSERT_EQ(swap_to_stuck()["state"], "applied");
  close();
  daemon_->install(2);

  const auto error = ask("plugin.reload", {{"plugin", "trial"}, {"probation", "off"}});

  EXPECT_EQ(error["data"]["name"], "timed_out") << error;
  EXPECT_TRUE(daemon_->becomes("first.core.number", 1)) << "the old code runs on";
  open();
  ASSERT_TRUE(eventually([&] { return abandoned_threads().empty(); }));
  const auto reloaded = ask("plugin.reload", {{"plugin", "trial"}, {"probation", "off"}});
  EXPECT_EQ(reloaded["unmapped"], true) << reloaded;
  EXPECT_TRUE(daemon_->becomes("first.core.number", 2));
}

TEST_F(Abandoned, IsAChangeWhoseStandbyCoreIsNotReady) {
  std::string text(kTrial);
  const std::string first = R"("first":  { "type": "trial/unit",)";
  open();
  begin("3s", text.replace(text.find(first), first.size(),
                           first + R"( "task": { "on_fault": "fallback" }, "fallback_core":
                           { "core": "trial/stuck", "properties": { "core.while_there": ")" +
                               gate_ + R"(" } },)"));

  const auto error = swap("trial/other", {{"probation", "off"}});

  EXPECT_EQ(error["data"]["name"], "timed_out") << "it comes with the change: " << error;
  EXPECT_EQ(error["data"]["state"], "unchanged");
  EXPECT_EQ(abandoned_threads()[0]["hook"], "first.core on_configure");
  expect_next_change_works(2.0);
  expect_next_change_works(3.0);
  EXPECT_EQ(abandoned_threads().size(), 1U) << "it is not tried again";
}

TEST_F(Abandoned, TooOftenRefusesWhatIsNewButNeverAStop) {
  begin("1s");
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(swap_to_stuck()["data"]["name"], "timed_out");
  }

  const auto refused = swap("trial/other");

  EXPECT_EQ(refused["data"]["name"], "wrong_state") << refused;
  EXPECT_THAT(refused["message"].get<std::string>(), HasSubstr("2 hooks of changes of yours"));
  EXPECT_EQ(ask("architecture.apply", {{"text", kTrial}})["data"]["name"], "wrong_state");
  EXPECT_EQ(daemon_->component("first")["state"], "running");
  EXPECT_EQ(ask("change.apply", {{"text", R"([{"stop": "first"}])"}})["state"], "applied");
  EXPECT_EQ(ask("component.stop", {{"all", true}})["state"], "applied");
  open();
  ASSERT_TRUE(eventually([&] { return abandoned_threads().empty(); }));
  EXPECT_TRUE(eventually([&] { return swap("trial/other")["state"] == "applied"; }));
}

/// `first` writes into a resource that never lets it go.
std::string with_meter() {
  std::string text(kTrial);
  const std::string count = R"("count": {)";
  text.insert(text.find(count), R"("meter": { "type": "trial/meter" }, )");
  const std::string output = R"("output": "signal.write")";
  text.replace(text.find(output), output.size(), R"("output": "meter.write")");
  const std::string period = R"("fsm.period": "2ms" })";
  return text.replace(text.find(period), period.size(),
                      period + R"(, "task": { "watchdog": "500ms" })");
}

TEST(Show, StatesWhatHappensWhenAJobDoesNotReturnOrFaults) {
  std::string text(kTrial);
  const std::string first = R"("first":  { "type": "trial/unit",)";
  TrialDaemon daemon(
      text.replace(text.find(first), first.size(), first + R"( "fallback_core": "trial/other",
                                  "task": { "on_fault": "fallback", "watchdog": "700ms" },)"));
  const auto show = [&](const char* name) { return daemon.ask("object.get", {{"address", name}}); };

  EXPECT_EQ(show("first")["task"]["watchdog"], "700ms");
  EXPECT_EQ(show("first")["task"]["on_fault"], "fallback");
  EXPECT_EQ(show("first")["fallback_core"], "trial/other");
  EXPECT_EQ(show("second")["task"]["watchdog"], "500ms") << "the least of an ordinary thread";
  EXPECT_EQ(show("second")["task"]["on_fault"], "stop");
  EXPECT_EQ(show("second")["fallback_core"], nullptr);
}

TEST(PlaceProbation, DoesNotBlameTheNewCoreForAResourceThatFailsIt) {
  TrialDaemon daemon(with_meter());

  const auto swapped = daemon.ask("core.swap", {{"component", "first"},
                                                {"core", "trial/other"},
                                                {"set", {{"gain", 4.0}}},
                                                {"in_place", true}});
  ASSERT_EQ(swapped["state"], "applied") << swapped;

  ASSERT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/steady"; }));
  EXPECT_TRUE(daemon.ask("quarantine.list")["cores"].empty()) << daemon.errors();
  EXPECT_THAT(daemon.ask("component.why", {{"component", "first"}}).dump(),
              HasSubstr("its job ran longer than"));
}

TEST(Poisoned, IsAResourceInWhichACallerWasAborted) {
  TrialDaemon daemon(with_meter());
  const auto show = [&] { return daemon.ask("object.get", {{"address", "meter"}})["poisoned"]; };
  EXPECT_EQ(daemon.ask("status.get")["poisoned"], Json::array());
  EXPECT_EQ(show(), false);

  daemon.ask("param.set", {{"values", {{"first.core.gain", 4.0}}}, {"probation", "off"}});

  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }));
  EXPECT_EQ(daemon.ask("status.get")["poisoned"], Json({"meter"}));
  EXPECT_EQ(show(), true);
  EXPECT_THAT(daemon.ctl({"status"}).out, HasSubstr("meter: is poisoned: "));

  const auto healed =
      daemon.ask("param.set", {{"values", {{"meter.core.breaks_at", 5.0}}}, {"state", "drop"}});
  EXPECT_EQ(healed["state"], "applied") << healed;
  EXPECT_EQ(daemon.ask("status.get")["poisoned"], Json::array());
  EXPECT_EQ(show(), false);
}

}  // namespace
}  // namespace mauve::test
