// SPDX-License-Identifier: LGPL-3.0-or-later
// A lock judges the change that would happen, never the method that asked for it. One table has
// every method that can change something, with the kind of difference that it makes. The test calls
// each method under every lock.
#include <unistd.h>

#include <set>

#include "kept_daemon.h"
#include "locked_ways.h"
#include "protocol/methods.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

class Locks : public Generations {
 protected:
  /// Each way under this lock: a way that the lock holds is refused and changes nothing.
  void walk(const std::string& lock) {
    bool as_after_start = false;
    for (const Way& way : all_ways()) {
      SCOPED_TRACE(way.name + " (" + way.method + ") under lock " + lock);
      daemon_.ask("lock.set", {{"lock", "none"}});
      if (!as_after_start) {
        ASSERT_NO_FATAL_FAILURE(begin_anew());
      }
      as_after_start = is_held(way, lock) && way.before.empty();
      auto params = way.params;
      if (params.contains("generation")) params["generation"] = runs()["generation"];
      for (const auto& [method, asked] : way.before) {
        const auto done = daemon_.ask(method, asked);
        ASSERT_FALSE(done.contains("code")) << method << done;
      }
      ASSERT_EQ(daemon_.ask("lock.set", {{"lock", lock}})["lock"], lock);
      const auto before = runs();
      const auto answer = daemon_.ask(way.method, params);
      if (is_held(way, lock)) {
        expect_held(answer);
        EXPECT_EQ(runs(), before) << "a refused change changes nothing";
      } else {
        EXPECT_THAT(answer.value("message", ""), testing::Not(HasSubstr("locked"))) << answer;
      }
      if (lock == "none") expect_effect(way, answer);
      if (HasFailure()) return;
    }
  }

  static void expect_held(const Json& answer) {
    ASSERT_TRUE(answer.contains("data")) << answer;
    EXPECT_EQ(answer["data"]["name"], "conflict") << answer;
    EXPECT_EQ(answer["data"]["state"], "unchanged") << answer;
    EXPECT_NE(answer["data"].value("where", ""), "") << answer;
    EXPECT_THAT(answer["data"].value("hint", ""), HasSubstr("mauvectl lock none")) << answer;
    EXPECT_THAT(answer["message"].get<std::string>(), HasSubstr("locked")) << answer;
  }

  /// The table says what the way does.
  static void expect_effect(const Way& way, const Json& answer) {
    if (way.effect == kUnreported || way.effect == kNothing) return;
    ASSERT_TRUE(answer.contains("lines")) << answer;
    unsigned effect = 0;
    for (const auto& line : answer["lines"]) effect |= effect_of(line);
    EXPECT_EQ(effect, way.effect) << answer["lines"];
  }

  /// The architecture, the plugins and the generation that run.
  Json runs() {
    return {{"architecture", exported(daemon_)},
            {"plugins", daemon_.ask("plugin.list")["items"].size()},
            {"generation", daemon_.ask("status.get")["generation"]}};
  }

  /// As after the start, with nothing on probation.
  void begin_anew() {
    daemon_.ask("change.confirm");
    const auto back =
        daemon_.ask("architecture.apply", {{"text", walked().dump()}, {"probation", "off"}});
    ASSERT_FALSE(back.contains("code")) << back;
    // No file starts what a user stopped.
    daemon_.ask("component.start", {{"components", {"first", "second"}}});
    if (runs()["plugins"] != 1) daemon_.ask("plugin.unload", {{"plugin", "demo"}});
  }

  TrialDaemon daemon_{walked().dump(), options()};

  void SetUp() override {
    std::filesystem::copy_file(MAUVE_PLUGIN_DIR "/demo.so", daemon_.plugins() / "demo.so");
    daemon_.install(2);
    ASSERT_EQ(daemon_.ask("change.confirm")["saved"], true);
  }
};

TEST_F(Locks, HaveEveryMethodThatChangesSomethingInTheTableOfThisTest) {
  std::set<std::string_view> walked;
  const auto ways = all_ways();
  for (const Way& way : ways) walked.insert(way.method);
  for (const auto& method : protocol::methods()) {
    if (!method.mutation() || method.harmless()) continue;
    EXPECT_TRUE(walked.contains(method.name))
        << method.name << " can change something, so locked_ways.h needs a way for it";
  }
}

TEST_F(Locks, OfNothingLetEveryMethodMakeTheDifferencesThatTheTableNames) { walk("none"); }

TEST_F(Locks, OfParamsHoldEveryMethodThatWouldSetAProperty) { walk("params"); }

TEST_F(Locks, OfTopologyFreeTuningAndHoldEveryMethodThatWouldChangeMore) { walk("topology"); }

TEST_F(Locks, OfAllHoldEveryMethodThatWouldDoMoreThanStopOrConfirm) { walk("all"); }

/// One rule for each kind of step; none of them fires.
Json with_rules_of_every_step() {
  Json wanted = walked();
  const std::vector<std::pair<std::string, Json>> steps = {
      {"sets", {{"set", "first.core.gain"}, {"value", 3.0}}},
      {"swaps", {{"swap", "first"}, {"core", "trial/other"}}},
      {"connects", {{"connect", "first.ports.input"}, {"to", "signal.read"}}},
      {"disconnects", {{"disconnect", "second.ports.input"}}},
      {"starts", {{"start", "third"}}},
      {"stops", {{"stop", "first"}}}};
  wanted["rules"] = Json::array();
  for (const auto& [name, step] : steps) {
    wanted["rules"].push_back(
        {{"name", name}, {"when", "second.core.count < 0"}, {"do", Json::array({step})}});
  }
  return wanted;
}

TEST(LocksAndRules, HoldARuleByTheDifferencesOfItsSteps) {
  TrialDaemon daemon(with_rules_of_every_step().dump());
  const auto held = [&](const std::string& lock) {
    return daemon.ask("lock.set", {{"lock", lock}})["rules_held"];
  };

  EXPECT_EQ(held("none"), 0);
  EXPECT_EQ(held("params"), 1) << "the rule that sets";
  EXPECT_EQ(held("topology"), 3) << "those that swap, connect and disconnect";
  EXPECT_EQ(held("all"), 5) << "all but the rule that stops";
  const auto answer = daemon.ask("lock.set", {{"lock", "params"}});
  ASSERT_EQ(answer["held_rules"].size(), 1U) << answer;
  const auto rules = daemon.ask("rules.list")["items"];
  ASSERT_EQ(rules.size(), 6U) << rules;
  for (const auto& rule : rules) {
    const bool named = rule["name"] == answer["held_rules"].front();
    EXPECT_EQ(rule["held"], named ? "params are locked" : "") << rule;
  }
}

TEST(LocksAndRules, NameTheRulesThatMayFireUnderTheNextLock) {
  TrialDaemon daemon(with_rules_of_every_step().dump());
  const auto released = [&](const std::string& lock) {
    const auto answer = daemon.ask("lock.set", {{"lock", lock}});
    return answer.contains("notes") ? answer["notes"].back().get<std::string>() : "no note";
  };

  EXPECT_EQ(released("all"), "no note");
  EXPECT_EQ(released("topology"), "rules sets and starts were held and may fire now");
  EXPECT_EQ(released("params"), "rules connects, disconnects and swaps were held and may fire now");
  EXPECT_EQ(released("none"), "rule sets was held and may fire now");
  EXPECT_EQ(released("none"), "no note");
}

TEST(LocksAndRules, LetARuleStopAComponentUnderEveryLock) {
  Json wanted = walked();
  wanted["rules"] = {
      {{"name", "together"}, {"when", "second.state == stopped"}, {"do", {{{"stop", "first"}}}}}};
  TrialDaemon daemon(wanted.dump());
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["rules_held"], 0);

  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"second"}}})["state"], "applied");

  EXPECT_TRUE(eventually([&] { return daemon.component("first")["state"] == "stopped"; }))
      << daemon.ask("rules.list");
}

/// `third` asks for the transaction in every job, as soon as it is started.
TEST(LocksAndRules, HoldWhatAComponentRequestsAsWhatAClientAsksFor) {
  Json wanted = walked();
  wanted["transactions"]["wish"] = {{{"set", "second.core.gain"}, {"value", 3.0}}};
  auto& third = wanted["components"]["third"];
  third.update({{"core", "trial/nagging"}, {"may_request", {"wish"}}});
  third["properties"] = {{"core.transaction", "wish"}};
  TrialDaemon daemon(wanted.dump());
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "params"}})["lock"], "params");
  ASSERT_EQ(daemon.ask("component.start", {{"components", {"third"}}})["state"], "applied");

  ASSERT_TRUE(eventually([&] {
    return daemon.errors().find("params are locked") != std::string::npos;
  })) << daemon.errors();
  EXPECT_EQ(daemon.value("second.core.gain"), 1.0);

  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "none"}})["lock"], "none");
  EXPECT_TRUE(daemon.becomes("second.core.gain", 3.0));
}

/// `first` fails as soon as the file "fail" is there.
Json brittle(const TrialDaemon& daemon) {
  return {{"component", "first"},
          {"core", "trial/brittle"},
          {"set", {{"until_there", (daemon.place() / "fail").string()}}}};
}

TEST(LocksAndFailures, HoldNoRollbackThatAFailureOnProbationCauses) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", brittle(daemon))["state"], "applied");
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["lock"], "all");

  static_cast<void>(daemon.place().write("fail", ""));

  EXPECT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/steady"; }));
  EXPECT_EQ(daemon.ask("status.get")["lock"], "all");
}

TEST(LocksAndFailures, HoldNoRollbackThatAMissingConfirmationCauses) {
  TrialDaemon daemon;
  const Json change = {{"values", {{"first.core.gain", 3.0}}}, {"confirm_within", "1s"}};
  ASSERT_EQ(daemon.ask("param.set", change)["state"], "applied");

  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["lock"], "all");

  EXPECT_TRUE(daemon.becomes("first.core.gain", 1.0));
}

TEST(LocksAndFailures, HoldNoStandbyCoreOfAComponentThatFails) {
  auto wanted = walked();
  wanted["components"]["first"]["task"] = {{"on_fault", "fallback"}};
  wanted["components"]["first"]["fallback_core"] = "trial/other";
  TrialDaemon daemon(wanted.dump());
  auto swap = brittle(daemon);
  swap["probation"] = "off";
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["lock"], "all");

  static_cast<void>(daemon.place().write("fail", ""));

  EXPECT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/other"; }));
}

Json values_with_gain(double value) { return {{"values", {{"first.core.gain", value}}}}; }

TEST(Lock, RefusesEveryChangeButAStop) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["lock"], "all");
  const std::vector<std::pair<std::string, Json>> changes = {
      {"param.set", values_with_gain(3.0)},
      {"core.swap", {{"component", "first"}, {"core", "trial/other"}}},
      {"port.disconnect", {{"port", "second.ports.input"}}},
      {"component.start", {{"components", {"first"}}}},
      {"plugin.reload", {{"plugin", "trial"}}}};

  for (const auto& [method, params] : changes) {
    const auto error = daemon.ask(method, params);
    EXPECT_EQ(error["data"]["name"], "conflict") << method << error;
    EXPECT_EQ(error["data"]["exit"], 6);
    EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("everything that runs is locked"));
  }

  EXPECT_EQ(daemon.ask("status.get")["lock"], "all");
  EXPECT_EQ(daemon.ask("component.stop", {{"all", true}})["state"], "applied");
  EXPECT_EQ(daemon.ask("lock.set", {{"lock", "none"}})["lock"], "none");
  EXPECT_EQ(daemon.ask("param.set", values_with_gain(3.0))["state"], "applied");
}

TEST(Lock, IsShownWithItsUserAndItsReason) {
  TrialDaemon daemon;
  EXPECT_EQ(daemon.ask("status.get")["locked"], nullptr);
  for (const char* lock : {"all", "params"}) {
    daemon.ask("lock.set", {{"lock", lock}, {"reason", "mission"}});

    const auto refused = daemon.ask("param.set", values_with_gain(3.0));
    const auto locked = daemon.ask("status.get")["locked"];

    const auto user = std::to_string(getuid());
    EXPECT_EQ(refused["data"]["hint"], "uid " + user +
                                           " set the lock (mission); an administrator "
                                           "ends it: mauvectl lock none");
    EXPECT_EQ(locked["uid"], getuid());
    EXPECT_EQ(locked["reason"], "mission");
  }
  daemon.ask("lock.set", {{"lock", "none"}});
  EXPECT_EQ(daemon.ask("status.get")["locked"], nullptr);
}

TEST(Lock, LetsTheChangeOnProbationBeConfirmedAndNotBeUndoneByHand) {
  TrialDaemon daemon;
  const auto change_and_lock = [&] {
    Json values = values_with_gain(3.0);
    values["confirm_within"] = "600s";
    ASSERT_EQ(daemon.ask("param.set", values)["state"], "applied");
    ASSERT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["lock"], "all");
  };

  change_and_lock();
  EXPECT_EQ(daemon.ask("change.undo")["data"]["name"], "conflict");
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);

  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "none"}})["lock"], "none");
  EXPECT_EQ(daemon.ask("change.undo")["state"], "applied");
  EXPECT_EQ(daemon.value("first.core.gain"), 1.0);

  change_and_lock();
  EXPECT_EQ(daemon.ask("change.confirm")["changed"], true);
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);
  EXPECT_EQ(daemon.ask("status.get")["lock"], "all");
}

TEST(Lock, OfParamsRefusesPropertiesOnly) {
  TrialDaemon daemon;
  Json swap = {{"component", "first"}, {"core", "trial/other"}};
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "params"}})["lock"], "params");

  EXPECT_EQ(daemon.ask("param.set", values_with_gain(3.0))["data"]["name"], "conflict");
  EXPECT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  swap["set"] = {{"gain", 3.0}};
  EXPECT_EQ(daemon.ask("core.swap", swap)["data"]["name"], "conflict");
}

/// `architecture` with another value of this property of `first`.
std::string with_property(const std::string& name, const Json& value) {
  auto file = Json::parse(std::string(kTrial));
  file["components"]["first"]["properties"][name] = value;
  return file.dump();
}

TEST(Lock, OfParamsHoldsEveryWayToSetAProperty) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "params"}})["lock"], "params");

  const std::vector<std::pair<std::string, Json>> changes = {
      {"architecture.apply", {{"text", with_property("core.gain", 3.0)}}},
      {"change.apply", {{"text", R"([ { "set": "first.core.gain", "value": 3.0 } ])"}}},
      {"core.swap", {{"component", "first"}, {"core", "trial/other"}, {"set", {{"gain", 3.0}}}}}};
  for (const auto& [method, params] : changes) {
    const auto error = daemon.ask(method, params);
    EXPECT_EQ(error["data"]["name"], "conflict") << method << error;
    EXPECT_EQ(error["data"]["where"], "first.core.gain") << method;
    EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("first.core.gain")) << method;
  }
  EXPECT_EQ(daemon.value("first.core.gain"), 1.0);
  EXPECT_EQ(daemon.ask("status.get")["generation"], 1);
}

TEST(Lock, OfTopologyLeavesTuningStartsAndStopsFree) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "topology"}})["lock"], "topology");
  const std::vector<std::pair<std::string, Json>> held = {
      {"core.swap", {{"component", "first"}, {"core", "trial/other"}}},
      {"port.disconnect", {{"port", "second.ports.input"}}},
      {"param.set", {{"values", {{"first.task.budget", "900us"}}}}},
      {"plugin.reload", {{"plugin", "trial"}}},
      {"change.apply", {{"text", R"([ { "disconnect": "second.ports.input" } ])"}}}};

  for (const auto& [method, params] : held) {
    const auto error = daemon.ask(method, params);
    EXPECT_EQ(error["data"]["name"], "conflict") << method << error;
    EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("topology is locked")) << method;
  }

  EXPECT_EQ(daemon.ask("param.set", values_with_gain(3.0))["state"], "applied");
  EXPECT_EQ(daemon.ask("architecture.apply", {{"text", with_property("core.gain", 4.0)}})["state"],
            "applied");
  EXPECT_EQ(daemon.ask("component.stop", {{"components", {"second"}}})["state"], "applied");
  EXPECT_EQ(daemon.ask("component.start", {{"components", {"second"}}})["state"], "applied");
}

TEST(Lock, StopsAChangeThatIsPrepared) {
  TrialDaemon daemon;
  auto changing = daemon.client();
  const auto marker = daemon.place() / "configuring";
  const auto request = protocol::make_request(
      1, "core.swap",
      {{"component", "first"}, {"core", "trial/slow"}, {"set", {{"marker", marker.string()}}}});
  ASSERT_TRUE(changing.send(request.dump() + "\n"));
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(marker); }));

  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["state"], "applied");

  EXPECT_EQ(changing.json()["error"]["data"]["name"], "conflict");
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
}

}  // namespace
}  // namespace mauve::test
