// SPDX-License-Identifier: LGPL-3.0-or-later
// The changes that a running daemon makes by itself: rules, and transactions that components
// request.
#include <filesystem>

#include "rules_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

constexpr const char* kLoud = R"({ "name": "loud", "when": "second.core.input > 5",
    "until": "second.core.input < 2", "do": "deaf", "cool_down": "1ms" })";

TEST(Rules, DisconnectAndAreArmedAgain) {
  RulesDaemon daemon(supervised(kLoud));
  EXPECT_TRUE(eventually([&] { return daemon.rule("loud")["state"] == "armed"; }));
  EXPECT_EQ(daemon.rule("loud")["fired"], 0);
  EXPECT_TRUE(daemon.becomes("second.core.input", 1.0));
  EXPECT_THAT(daemon.rule("loud")["why_not"].get<std::string>(), HasSubstr("condition is false"));

  daemon.set("first.core.gain", 6.0);

  ASSERT_TRUE(daemon.fired("loud", 1)) << daemon.rule("loud");
  EXPECT_THAT(daemon.answer("loud"), HasSubstr("applied, generation 3"));
  EXPECT_EQ(daemon.service("second.ports.input"), nullptr);
  EXPECT_TRUE(daemon.becomes("second.core.input", 0.5));
  EXPECT_TRUE(eventually([&] { return daemon.rule("loud")["state"] == "armed"; }));
  EXPECT_TRUE(
      eventually([&] { return daemon.events("transaction_applied", "by rule loud") == 1; }));
  EXPECT_TRUE(daemon.logs(1, "transaction_applied",
                          "deaf by rule loud (second.core.input is 6): applied, generation 3"));
  EXPECT_EQ(daemon.events("change_applied", "loud"), 0U) << "one event reports all of it";

  daemon.ask("port.connect", {{"port", "second.ports.input"}, {"service", "signal.read"}});
  EXPECT_TRUE(daemon.fired("loud", 2)) << daemon.rule("loud");
}

TEST(Rules, SayOnceThatAValueBecameNanAndFireOnlyWhenTheySaySo) {
  RulesDaemon daemon(supervised(
      R"({ "name": "loud", "when": "second.core.input > 5", "do": "deaf" },
         { "name": "safe", "when": "second.core.input > 5", "when_unknown": "fire",
           "for": "100ms", "do": "rest" })"));
  ASSERT_TRUE(daemon.becomes("second.core.input", 1.0));
  EXPECT_TRUE(daemon.ask("status.get")["unknown_values"].empty());

  daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/undefined"}});

  ASSERT_TRUE(daemon.fired("safe", 1)) << daemon.rule("safe");
  EXPECT_EQ(daemon.rule("loud")["fired"], 0);
  EXPECT_EQ(daemon.rule("safe")["when_unknown"], "fire");
  EXPECT_EQ(daemon.rule("loud")["why_not"], "condition is unknown: second.core.input is nan");
  EXPECT_EQ(daemon.ask("param.get", {{"address", "second.core.input"}})["value"], "nan");
  EXPECT_EQ(daemon.ask("param.get", {{"address", "signal.read"}})["value"], "nan");
  EXPECT_TRUE(
      daemon.logs(1, "value_unknown", "second.core.input is nan: rule loud cannot be judged"));
  const auto unknown = daemon.ask("status.get")["unknown_values"];
  ASSERT_EQ(unknown.size(), 1U) << unknown;
  EXPECT_EQ(unknown[0]["address"], "second.core.input");
  EXPECT_EQ(unknown[0]["value"], "nan");
  EXPECT_EQ(unknown[0]["rules"], Json({"loud", "safe"}));

  daemon.set("first.core.gain", 2.0);
  daemon.ask("component.start", {{"components", {"second"}}});
  EXPECT_TRUE(eventually([&] { return daemon.events("value_known", "second.core.input") == 1; }));
  EXPECT_TRUE(daemon.ask("status.get")["unknown_values"].empty());
  EXPECT_TRUE(daemon.logs(1, "value_unknown"));
}

TEST(Rules, AreOnProbationOnlyWhenTheyBringSomethingThatMustProveItself) {
  RulesDaemon daemon(supervised(
      R"({ "name": "loud", "when": "second.core.input > 5", "do": "deaf", "cool_down": "1ms" },
         { "name": "quiet", "when": "first.core.gain == 3", "do": "calm", "cool_down": "1ms" })"));

  daemon.ask("param.set", {{"values", {{"first.core.gain", 6.0}}}, {"probation", "off"}});
  ASSERT_TRUE(daemon.fired("loud", 1)) << daemon.rule("loud");
  const auto refused = daemon.ask("change.undo");
  EXPECT_EQ(refused["data"]["name"], "wrong_state") << refused;

  daemon.ask("port.connect", {{"port", "second.ports.input"}, {"service", "signal.read"}});
  daemon.set("first.core.gain", 3.0);
  ASSERT_TRUE(daemon.fired("quiet", 1)) << daemon.rule("quiet");
  const auto undone = daemon.ask("change.undo");
  EXPECT_TRUE(undone.contains("generation")) << undone;
}

TEST(Rules, ThatAreRefusedChangeNothingAndTryAgainWhileTheirConditionHolds) {
  RulesDaemon daemon(supervised(R"({ "name": "loud", "when": "second.core.input > 5",
                                     "do": "worse", "cool_down": "1ms" })"));
  const auto before = daemon.set("first.core.gain", 6.0);

  ASSERT_TRUE(daemon.fired("loud", 1)) << daemon.rule("loud");

  EXPECT_THAT(daemon.answer("loud"), HasSubstr("refused: "));
  EXPECT_THAT(daemon.answer("loud"), HasSubstr("is not to its liking"));
  EXPECT_EQ(daemon.service("second.ports.input"), "signal.read") << "all steps or none";
  EXPECT_EQ(daemon.ask("status.get")["generation"], before["generation"]);
  EXPECT_TRUE(eventually([&] { return daemon.events("transaction_refused", "liking") >= 1; }));
  Json waits;
  EXPECT_TRUE(eventually([&] { return (waits = daemon.rule("loud"))["state"] == "cooling_down"; }));
  EXPECT_THAT(waits["why_not"].get<std::string>(), HasSubstr("tries again in"));
  const auto refused = daemon.ask("status.get")["blocked_rules"];
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0]["rule"], "loud");
  EXPECT_THAT(daemon.ctl({"status"}).out,
              HasSubstr("rule loud has no effect although its condition holds: refused: "));
  EXPECT_TRUE(daemon.fired("loud", 2)) << daemon.rule("loud");

  daemon.set("first.core.gain", 1.0);
  EXPECT_TRUE(eventually([&] { return daemon.rule("loud")["state"] == "armed"; }));
  EXPECT_THAT(daemon.ask("status.get")["blocked_rules"], testing::IsEmpty());
}

/// The file has a core with a state, and the rule puts one in place that has no place for it.
TEST(Rules, ThatWouldLoseAStateAreNamedWhenTheirFileIsCheckedStartedOrApplied) {
  const auto lossy = supervised(R"({ "name": "loud", "when": "second.core.input > 5",
      "do": [{ "swap": "second", "core": "trial/forgetful" }] })");
  const auto note = HasSubstr(
      "rules.loud.do is refused when it fires while second has the core of this file: "
      "the new core has no place for the state");

  RulesDaemon started(lossy);
  EXPECT_TRUE(eventually([&] { return started.events("connection_doubtful", "rules.loud") == 1; }));
  EXPECT_TRUE(started.logs(1, "connection_doubtful", "has no place for the state"));

  RulesDaemon daemon(supervised(kLoud));
  for (const bool dry_run : {true, false}) {
    const auto answer = daemon.ask("architecture.apply", {{"text", lossy}, {"dry_run", dry_run}});
    EXPECT_THAT(answer["notes"].dump(), note) << answer;
  }
  const auto checked = daemon.ask("config.check", {{"text", lossy}});
  EXPECT_THAT(checked["notes"].dump(), note) << checked;
  for (const char* method : {"architecture.diff", "config.check"}) {
    const auto back = daemon.ask(method, {{"text", supervised(kLoud)}});
    EXPECT_THAT(back.value("notes", Json()).dump(), Not(HasSubstr("rules."))) << back;
  }
}

/// Its condition comes true by itself, which no lock keeps it from.
TEST(Rules, AreHeldByALockOfAllAndFireWhenItEnds) {
  RulesDaemon daemon(
      supervised(R"({ "name": "busy", "when": "second.core.count > 400", "do": "deaf" })"));
  EXPECT_EQ(daemon.ask("lock.set", {{"lock", "params"}})["rules_held"], 0);
  EXPECT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["rules_held"], 1);
  ASSERT_TRUE(eventually([&] { return daemon.rule("busy")["state"] == "held"; }))
      << daemon.rule("busy");
  EXPECT_EQ(daemon.rule("busy")["why_not"], "everything is locked");
  EXPECT_EQ(daemon.rule("busy")["fired"], 0);

  EXPECT_EQ(daemon.ask("lock.set", {{"lock", "none"}})["rules_held"], 0);

  EXPECT_TRUE(daemon.fired("busy", 1)) << daemon.rule("busy");
  EXPECT_EQ(daemon.service("second.ports.input"), nullptr);
}

TEST(Rules, ThatFireWhileAChangeIsUnderWayWaitForIt) {
  RulesDaemon daemon(
      supervised(R"({ "name": "alone", "when": "second.state == stopped", "do": "deaf" })"));
  const auto marker = daemon.place() / "begun";
  auto client = daemon.client();
  ASSERT_TRUE(client.send(protocol::to_line(protocol::make_request(
                              "slow", "core.swap",
                              {{"component", "first"},
                               {"core", "trial/slow"},
                               {"set", {{"configure_time", "3s"}, {"marker", marker.string()}}}})) +
                          '\n'));
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(marker); }));

  daemon.ask("component.stop", {{"components", {"second"}}});
  ASSERT_TRUE(eventually([&] { return daemon.rule("alone")["fired"] == 1; }));

  const auto swapped = client.json();
  EXPECT_EQ(swapped["result"]["state"], "applied") << swapped;
  ASSERT_TRUE(daemon.fired("alone", 1));
  EXPECT_THAT(daemon.answer("alone"), HasSubstr("applied, generation"));
  EXPECT_EQ(daemon.service("second.ports.input"), nullptr);
  EXPECT_EQ(daemon.component("first")["core"], "trial/slow");
}

TEST(Rules, ThatOnlyStopWaitForNoChangeUnderWay) {
  RulesDaemon daemon(supervised(
      R"({ "name": "halt", "when": "first.state == stopped", "do": [{ "stop": "second" }] })"));
  const auto marker = daemon.place() / "begun";
  auto client = daemon.client();
  ASSERT_TRUE(client.send(protocol::to_line(protocol::make_request(
                              "slow", "core.swap",
                              {{"component", "second"},
                               {"core", "trial/slow"},
                               {"set", {{"configure_time", "3s"}, {"marker", marker.string()}}}})) +
                          '\n'));
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(marker); }));

  daemon.ask("component.stop", {{"components", {"first"}}});

  ASSERT_TRUE(daemon.fired("halt", 1)) << daemon.rule("halt");
  EXPECT_THAT(daemon.answer("halt"), HasSubstr("applied, generation"));
  const auto second = daemon.component("second");
  EXPECT_EQ(second["state"], "stopped");
  EXPECT_NE(second["core"], "trial/slow") << "that change is prepared still";
  EXPECT_FALSE(second.contains("stopped_by")) << "a rule is no user";
}

TEST(Rules, ThatFireDuringAnApplyWaitForIt) {
  const auto rules = R"({ "name": "alone", "when": "second.state == stopped", "do": "deaf" })";
  RulesDaemon daemon(supervised(rules));
  const auto marker = daemon.place() / "begun";
  auto wanted = supervised(rules);
  const std::string period = R"({ "fsm.period": "2ms" })";
  wanted.replace(wanted.find(period), period.size(),
                 R"({ "fsm.period": "2ms", "core.configure_time": "3s", "core.marker": ")" +
                     marker.string() + R"(" }, "core": "trial/slow")");
  auto client = daemon.client();
  ASSERT_TRUE(client.send(
      protocol::to_line(protocol::make_request("slow", "architecture.apply", {{"text", wanted}})) +
      '\n'));
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(marker); }));

  daemon.ask("component.stop", {{"components", {"second"}}});
  ASSERT_TRUE(eventually([&] { return daemon.rule("alone")["fired"] == 1; }));
  EXPECT_EQ(daemon.service("second.ports.input"), "signal.read") << "it waits";

  const auto applied = client.json()["result"];
  EXPECT_EQ(applied["state"], "applied") << applied;
  ASSERT_TRUE(daemon.fired("alone", 1));
  EXPECT_THAT(daemon.answer("alone"), HasSubstr("applied, generation"));
  EXPECT_EQ(daemon.service("second.ports.input"), nullptr);
  EXPECT_EQ(daemon.component("first")["core"], "trial/slow");
  EXPECT_EQ(daemon.component("second")["state"], "stopped") << "a stop is never undone";
}

TEST(Rules, StopAndStartComponents) {
  RulesDaemon daemon(supervised(
      R"({ "name": "loud", "when": "second.core.input > 5", "do": "rest" },
         { "name": "quiet", "when": "signal.read < 2 and second.state == stopped", "for": "20ms",
           "do": [{ "start": "second" }] })"));

  daemon.set("first.core.gain", 6.0);
  ASSERT_TRUE(daemon.fired("loud", 1)) << daemon.rule("loud");
  EXPECT_EQ(daemon.component("second")["state"], "stopped");

  daemon.set("first.core.gain", 1.0);
  ASSERT_TRUE(daemon.fired("quiet", 1)) << daemon.rule("quiet");
  EXPECT_EQ(daemon.component("second")["state"], "running");
}

TEST(Rules, DoNothingWhereEverythingIsSoAlready) {
  RulesDaemon daemon(
      supervised(R"({ "name": "same", "when": "second.state == running", "do": "wake" })"));

  ASSERT_TRUE(daemon.fired("same", 1)) << daemon.rule("same");

  EXPECT_EQ(daemon.answer("same"), "unchanged, generation 1");
}

TEST(Rules, AreListedByNameAndExported) {
  RulesDaemon daemon(supervised(kLoud, R"(["deaf"])"));

  EXPECT_EQ(daemon.ask("rules.list")["items"].size(), 1U);
  const auto unknown = daemon.ask("rules.list", {{"rule", "luod"}});
  EXPECT_EQ(unknown["data"]["name"], "unknown_name");
  EXPECT_THAT(unknown["data"]["hint"].get<std::string>(), HasSubstr("loud"));
  const auto exported = daemon.ask("config.get")["architecture"];
  EXPECT_EQ(exported["rules"][0]["until"], "second.core.input < 2");
  EXPECT_EQ(exported["transactions"]["rest"][0]["stop"], "second");
  EXPECT_EQ(exported["components"]["first"]["may_request"][0], "deaf");
  EXPECT_EQ(daemon.value("second.state"), "running") << "get knows what conditions know";
  EXPECT_EQ(daemon.value("second.ports.input.status"), "new_data");
}

TEST(Rules, DoNotDifferByTheirOrderInAFile) {
  RulesDaemon daemon(supervised(kLoud, R"(["deaf"])"));
  auto exported = daemon.ask("config.get")["architecture"];  // its keys are sorted

  const auto same = daemon.ask("architecture.diff", {{"text", exported.dump()}});
  EXPECT_EQ(same["same"], true) << same;

  exported["transactions"]["calm"][0]["value"] = 2.0;
  exported["rules"][0]["for"] = "3s";
  const auto other = daemon.ask("architecture.diff", {{"text", exported.dump()}});
  ASSERT_EQ(other["lines"].size(), 2U) << other;
  EXPECT_EQ(other["lines"][0]["address"], "transactions.calm");
  EXPECT_EQ(other["lines"][1]["address"], "rules.loud");
}

Json requesting(const std::string& component, const std::string& transaction) {
  return {{"component", component},
          {"core", "trial/requesting"},
          {"set", {{"transaction", transaction}}}};
}

TEST(Requests, ArePermittedByTheFile) {
  RulesDaemon daemon(supervised("", R"(["deaf"])"));

  daemon.ask("core.swap", requesting("first", "deaf"));

  EXPECT_TRUE(eventually([&] { return daemon.service("second.ports.input") == nullptr; }));
  EXPECT_TRUE(daemon.becomes("first.core.asked", true));
  EXPECT_TRUE(eventually(
      [&] { return daemon.events("transaction_applied", "deaf requested by first") == 1; }));
  EXPECT_TRUE(daemon.logs(1, "transaction_requested", "requests deaf"));
}

TEST(Requests, AreRefusedWhereTheFileDoesNotPermitThem) {
  RulesDaemon daemon(supervised("", R"(["deaf"])"));

  daemon.ask("core.swap", requesting("first", "rest"));
  daemon.ask("core.swap", requesting("second", "rest"));
  EXPECT_TRUE(eventually(
      [&] { return daemon.events("transaction_refused", "may not request this") == 2; }));
  daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/steady"}});
  daemon.ask("core.swap", requesting("first", "daef"));

  EXPECT_TRUE(eventually([&] { return daemon.events("transaction_refused", "deaf") == 1; }));
  EXPECT_EQ(daemon.service("second.ports.input"), "signal.read");
  EXPECT_EQ(daemon.component("second")["state"], "running");
}

TEST(Requests, InEveryJobFloodNeitherLogNorChanges) {
  RulesDaemon daemon(supervised("", R"(["calm"])"));
  daemon.ask("core.swap", {{"component", "first"},
                           {"core", "trial/nagging"},
                           {"probation", "off"},
                           {"set", {{"transaction", "calm"}}}});
  const auto ignored = [&] { return daemon.said("asks too often"); };
  ASSERT_TRUE(eventually([&] { return ignored() >= 4; })) << "the 1st, 10th, 100th and 1000th";

  EXPECT_LE(ignored(), 5U);
  EXPECT_GE(daemon.said("requests calm"), 10U);
  EXPECT_LE(daemon.said("requests calm"), 10U + 60U);
  EXPECT_EQ(daemon.set("second.core.gain", 2.0)["state"], "applied");
}

TEST(RoverRules, DisconnectTheReceiverWhileItSeesTooFewSatellites) {
  DaemonProcess rover(MAUVE_ETC_DIR "/rover.json");
  ASSERT_TRUE(rover.up()) << rover.errors();
  const auto service = [&] { return rover.ask({"show", "gnss.ports.fix"})["service"]; };
  ASSERT_TRUE(eventually([&] { return rover.value("gnss.core.satellites") == 9; }));
  const auto fired = [&](const std::string& rule) {
    return rover.ask({"rules", rule})["items"][0]["fired"].get<int>();
  };
  ASSERT_TRUE(eventually([&] { return fired("gnss_back") > 0; }));
  EXPECT_EQ(service(), "gnss_to_utm.fix");

  ASSERT_EQ(rover.ask({"set", "world.core.satellites=3"})["state"], "applied");
  EXPECT_TRUE(eventually([&] { return service() == nullptr; })) << rover.ask({"rules"});

  ASSERT_EQ(rover.ask({"set", "world.core.satellites=9"})["state"], "applied");
  EXPECT_TRUE(eventually([&] { return service() == "gnss_to_utm.fix"; })) << rover.ask({"rules"});
  EXPECT_GE(fired("gnss_lost"), 1);
}

/// Its driver goes on with the satellites that it saw last.
TEST(RoverRules, DisconnectAReceiverThatIsSilentAndTakeItBack) {
  DaemonProcess rover(MAUVE_ETC_DIR "/rover.json");
  ASSERT_TRUE(rover.up()) << rover.errors();
  const auto service = [&] { return rover.ask({"show", "gnss.ports.fix"})["service"]; };
  const auto fired = [&](const std::string& rule) {
    return rover.ask({"rules", rule})["items"][0]["fired"].get<int>();
  };
  ASSERT_TRUE(eventually([&] { return fired("gnss_back") > 0; }));

  ASSERT_EQ(rover.ask({"stop", "receiver"})["state"], "applied");
  EXPECT_TRUE(eventually([&] { return service() == nullptr; })) << rover.ask({"rules"});
  EXPECT_EQ(rover.value("gnss.core.satellites"), 9);
  EXPECT_THAT(rover.ask({"status"})["unknown_values"].dump(), HasSubstr("gnss.core.satellites"))
      << "the silence is seen";

  const int back = fired("gnss_back");
  ASSERT_EQ(rover.ask({"start", "receiver"})["state"], "applied");
  EXPECT_TRUE(eventually([&] { return service() == "gnss_to_utm.fix"; })) << rover.ask({"rules"});
  EXPECT_GT(fired("gnss_back"), back);
}

TEST(Rules, SayWhenTheyFiredAndHowLongAgo) {
  RulesDaemon daemon(
      supervised(R"({ "name": "same", "when": "second.state == running", "do": "wake" })"));
  ASSERT_TRUE(daemon.fired("same", 1)) << daemon.rule("same");

  const auto before = daemon.ask("status.get")["t_ns"].get<std::int64_t>();
  const auto row = daemon.rule("same");
  const auto after = daemon.ask("status.get")["t_ns"].get<std::int64_t>();

  const auto reported = row["fired_ns"].get<std::int64_t>() + row["ago_ns"].get<std::int64_t>();
  EXPECT_LE(before, reported) << row;
  EXPECT_LE(reported, after) << row;
}

}  // namespace
}  // namespace mauve::test
