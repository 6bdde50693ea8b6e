// SPDX-License-Identifier: LGPL-3.0-or-later
// Why a component failed, what was done, and what to do next.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::AnyOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// "first" runs with this core, and with these attributes.
std::string trial_with(const std::string& core, const std::string& task,
                       const std::string& more = {}) {
  std::string file = kTrial;
  const std::string begin = R"("first":  { "type": "trial/unit",)";
  file.replace(file.find(begin), begin.size(),
               begin + R"( "core": ")" + core + R"(", "task": )" + task + "," + more);
  return file;
}

std::vector<std::string> hints(const Json& why) {
  return why["hints"].get<std::vector<std::string>>();
}

/// Its answer once a failure has its outcome, and the log says what that is.
Json why(TrialDaemon& daemon, const std::string& cause) {
  Json said;
  EXPECT_TRUE(eventually([&] {
    said = daemon.ask("component.why", {{"component", "first"}});
    return said["failure"].is_object() && said["failure"]["cause"] == cause &&
           said["failure"]["fsm_state"] != "" && said["failure"]["did"] != "recovers";
  })) << said;
  return said;
}

std::string why_first(TrialDaemon& daemon) { return daemon.ctl({"why", "first"}).out; }

TEST(Why, NothingFailedSaysSince) {
  TrialDaemon daemon;

  const auto said = daemon.ask("component.why", {{"component", "first"}});

  EXPECT_EQ(said["failure"], nullptr) << said;
  EXPECT_EQ(said["change"], nullptr);
  const bool late = said["missed"] != 0 || said["overruns"] != 0;  // of a machine that stood still
  EXPECT_EQ(said["hints"].empty(), !late) << said;
  EXPECT_THAT(said["since"].get<std::string>(), HasSubstr("T"));
  EXPECT_THAT(why_first(daemon), AnyOf(HasSubstr("nothing failed since mauved began"),
                                       HasSubstr("did not fail, but is late")));
  EXPECT_EQ(daemon.ask("component.why", {{"component", "frst"}})["data"]["name"], "unknown_name");
}

TEST(Why, ACoreThrewAndItsComponentWasParked) {
  TrialDaemon daemon(trial_with("trial/throwing_job", "{}"));

  const auto said = why(daemon, "threw");

  const auto& failure = said["failure"];
  EXPECT_EQ(said["state"], "faulted");
  EXPECT_EQ(failure["text"], "division by something");
  EXPECT_EQ(failure["core"], "trial/throwing_job");
  EXPECT_NE(failure["build_id"], "");
  EXPECT_EQ(failure["fsm_state"], "update");
  EXPECT_EQ(failure["did"], "parked");
  EXPECT_EQ(failure["times"], 1);
  EXPECT_EQ(said["change"], nullptr) << "it began so";
  EXPECT_THAT(hints(said), Contains(HasSubstr("mauvectl start first --reset")));
  EXPECT_THAT(why_first(daemon),
              HasSubstr("threw: division by something, in state update, job 1, core "
                        "trial/throwing_job (build "));

  ASSERT_EQ(
      daemon.ask("component.start", {{"components", {"first"}}, {"reason", "again"}})["state"],
      "applied");
  EXPECT_TRUE(eventually([&] {
    const auto again = daemon.ask("component.why", {{"component", "first"}});
    return again["failure"]["times"] == 2 && again["change"]["reason"] == "again";
  })) << daemon.ask("component.why", {{"component", "first"}});
}

TEST(Why, AComponentThatWaitsForItsRestartSaysWhenAndHowManyAreLeft) {
  TrialDaemon daemon(
      trial_with("trial/throwing_job", R"({"on_fault": {"restart": 3, "back_off": "1h"}})"));

  Json waits;
  ASSERT_TRUE(eventually([&] {
    waits = daemon.component("first");
    return waits["state"] == "recovering";
  })) << waits;

  EXPECT_EQ(waits["recovery"]["by"], "restart");
  EXPECT_EQ(waits["recovery"]["restarts_left"], 3);
  EXPECT_GT(waits["recovery"]["in_ns"].get<std::int64_t>(), 3'000'000'000'000) << "of an hour";
  EXPECT_EQ(waits["fault"], "division by something");
  EXPECT_THAT(daemon.ctl({"status"}).out, HasSubstr("restarts with a fresh core"));
  const auto said = why_first(daemon);
  EXPECT_THAT(said, HasSubstr("3 restarts left"));
  EXPECT_THAT(said, Not(HasSubstr("did not fail")));
  EXPECT_THAT(said, Not(HasSubstr("nothing failed")));
  EXPECT_THAT(said, HasSubstr("threw: division by something"));
  EXPECT_THAT(said, HasSubstr("another core takes over by itself"));
  EXPECT_EQ(daemon.ask("object.get", {{"address", "first"}})["state"], "recovering");
}

TEST(Why, AFreshCoreThatFailsAtOnceIsRestartedUntilItsBudgetIsUsedUp) {
  TrialDaemon daemon(
      trial_with("trial/throwing_job", R"({"on_fault": {"restart": 3, "back_off": "200ms"}})"));

  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }));
  EXPECT_EQ(daemon.component("first")["releases"], 4) << "one job of each core";
  EXPECT_GE(daemon.ask("status.get")["generation"], 4) << "each restart is a generation";
  const auto said = why(daemon, "threw");
  EXPECT_EQ(said["failure"]["did"], "parked") << said;
  EXPECT_THAT(said["failure"]["text"].get<std::string>(),
              HasSubstr("all 3 restarts within 60s are used up"));
  EXPECT_EQ(said["failure"]["times"], 4);
}

TEST(Why, ASwapInPlaceToACoreThatFailsAtOnceReachesItsFallbackCore) {
  TrialDaemon daemon(trial_with("trial/steady", R"({"on_fault": "fallback"})",
                                R"("fallback_core": "trial/other",)"));

  ASSERT_EQ(daemon.ask("core.swap", {{"component", "first"},
                                     {"core", "trial/throwing_job"},
                                     {"in_place", true},
                                     {"probation", "off"}})["state"],
            "applied");

  EXPECT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/other"; }))
      << daemon.component("first");
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Why, AStartWithAFreshCoreKeepsTheRestartPolicy) {
  TrialDaemon daemon(
      trial_with("trial/throwing_job", R"({"on_fault": {"restart": 1, "back_off": "1ms"}})"));
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }));
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["releases"] == 2; }));

  const auto started = daemon.ask("component.start", {{"components", {"first"}}, {"reset", true}});

  EXPECT_EQ(started.value("state", ""), "applied") << started;
  EXPECT_FALSE(started.contains("probation")) << "a rollback would only stop it again";
  EXPECT_TRUE(eventually([&] { return daemon.component("first")["releases"] == 3; }));
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }))
      << daemon.component("first");
  EXPECT_EQ(daemon.ask("component.why", {{"component", "first"}})["failure"]["did"], "parked");
}

TEST(Why, ACoreHungAndItsFallbackTookOver) {
  TrialDaemon daemon(trial_with("trial/hanging", R"({"on_fault": "fallback", "watchdog": "1s"})",
                                R"("fallback_core": "trial/other",)"));

  const auto said = why(daemon, "hung");

  const auto& failure = said["failure"];
  EXPECT_EQ(said["state"], "running");
  EXPECT_EQ(said["core"], "trial/other");
  EXPECT_EQ(failure["core"], "trial/hanging");
  EXPECT_EQ(failure["did"], "fell_back");
  EXPECT_EQ(failure["core_after"], "trial/other");
  EXPECT_EQ(failure["fsm_state"], "update");
  EXPECT_THAT(hints(said), Contains(HasSubstr("mauvectl swap-core first trial/hanging")));
  EXPECT_THAT(hints(said), Contains(HasSubstr("mauvectl show first")));
  EXPECT_THAT(hints(said), Contains(HasSubstr("mauvectl explain hung")));
  EXPECT_THAT(why_first(daemon), HasSubstr("its fallback core trial/other took over"));
}

TEST(Why, AChangeWasRolledBackAndItsCoreIsKeptOut) {
  TrialDaemon daemon;
  const auto receipt = daemon.ask(
      "core.swap", {{"component", "first"}, {"core", "trial/throwing_job"}, {"reason", "try it"}});
  ASSERT_EQ(receipt["state"], "applied") << receipt;

  const auto said = why(daemon, "threw");

  const auto& failure = said["failure"];
  EXPECT_EQ(failure["did"], "rolled_back");
  EXPECT_EQ(failure["core"], "trial/throwing_job");
  EXPECT_EQ(failure["core_after"], "trial/steady");
  EXPECT_EQ(failure["generation"], 2);
  EXPECT_EQ(failure["generation_after"], 3);
  EXPECT_EQ(said["change"]["generation"], 2) << said;
  EXPECT_EQ(said["change"]["method"], "core.swap");
  EXPECT_EQ(said["change"]["reason"], "try it");
  EXPECT_EQ(said["quarantine"][0]["core"], "trial/throwing_job");
  EXPECT_THAT(hints(said), Contains(HasSubstr("mauvectl quarantine release trial/throwing_job")));
  EXPECT_TRUE(eventually([&] {  // the log comes to its thread's records some time later
    const auto now = daemon.ask("component.why", {{"component", "first"}});
    return now["records"].dump().find("component_faulted") != std::string::npos;
  })) << said;
}

TEST(Why, NamesALaterChangeThatMadeItLateBeforeItsFailure) {
  TrialDaemon daemon;
  ASSERT_EQ(
      daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/throwing_job"}})["state"],
      "applied");
  EXPECT_EQ(why(daemon, "threw")["late_after"], false);
  const auto late = daemon.ask("core.swap", {{"component", "first"},
                                             {"core", "trial/hungry"},
                                             {"set", {{"uses", "15ms"}}},
                                             {"probation", "off"}});
  ASSERT_EQ(late["state"], "applied") << late;

  Json said;
  ASSERT_TRUE(eventually([&] {
    said = daemon.ask("component.why", {{"component", "first"}});
    return said["late_after"] == true;
  })) << said;
  EXPECT_EQ(said["change_after"]["generation"], late["generation"]);
  EXPECT_EQ(said["failure"]["cause"], "threw");
  EXPECT_EQ(said["change"]["generation"], 2) << "the one that failed";
  const std::string text = why_first(daemon);
  EXPECT_THAT(text, HasSubstr("failed before, and is late now"));
  EXPECT_LT(text.find("generation 4 by core.swap"), text.find("threw: "));
}

/// The second core writes nothing into the log of the component when it fails.
TEST(Why, TwoFailuresWithinASecondAreNotMixed) {
  TrialDaemon daemon;
  ASSERT_EQ(
      daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/throwing_job"}})["state"],
      "applied");
  static_cast<void>(why(daemon, "threw"));
  const Json swap = {{"component", "first"},
                     {"core", "trial/hungry"},
                     {"set", {{"uses", "15ms"}}},
                     {"misses", "1/8"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied") << daemon.ask("core.swap", swap);

  const auto said = why(daemon, "overran too often");

  const auto& failure = said["failure"];
  EXPECT_EQ(failure["text"], "");
  EXPECT_EQ(failure["core"], "trial/hungry");
  EXPECT_EQ(failure["times"], 2);
  EXPECT_GT(failure["job"].get<int>(), 0);
  EXPECT_GT(failure["time"].get<std::string>(), said["change"]["time"].get<std::string>())
      << "it failed after its own swap";
}

TEST(Why, NamesTheResourceInWhoseCallTheJobFailed) {
  auto file = Json::parse(std::string(kTrial));
  file["resources"]["broken"] = {{"type", "trial/failing"},
                                 {"properties", {{"core.how", "throws"}}}};
  file["components"]["first"]["ports"]["input"] = "broken.read";
  TrialDaemon daemon(file.dump());

  const auto said = why(daemon, "threw");

  EXPECT_EQ(said["failure"]["resource"], "broken") << said;
  EXPECT_THAT(hints(said)[0], HasSubstr("mauvectl show broken: the job failed in a call of this "));
  EXPECT_THAT(why_first(daemon), HasSubstr("threw: no bearing, in a call of broken, in state "));
}

}  // namespace
}  // namespace mauve::test
