// SPDX-License-Identifier: LGPL-3.0-or-later
// What may not be changed, and what may be changed only if nobody was quicker.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;
using Json = protocol::Json;

Json gain(double value) { return {{"values", {{"first.core.gain", value}}}}; }

TEST(Freeze, RefusesEveryChangeButAStop) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "all"}})["lock"], "all");
  const std::vector<std::pair<std::string, Json>> changes = {
      {"param.set", gain(3.0)},
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
  EXPECT_EQ(daemon.ask("param.set", gain(3.0))["state"], "applied");
}

TEST(Freeze, LetsTheChangeOnProbationBeConfirmedAndNotBeUndoneByHand) {
  TrialDaemon daemon;
  const auto change_and_lock = [&] {
    Json values = gain(3.0);
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

TEST(Freeze, OfParamsRefusesPropertiesOnly) {
  TrialDaemon daemon;
  Json swap = {{"component", "first"}, {"core", "trial/other"}};
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "params"}})["lock"], "params");

  EXPECT_EQ(daemon.ask("param.set", gain(3.0))["data"]["name"], "conflict");
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

TEST(Freeze, OfParamsHoldsEveryWayToSetAProperty) {
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

TEST(Freeze, OfTopologyLeavesTuningStartsAndStopsFree) {
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

  EXPECT_EQ(daemon.ask("param.set", gain(3.0))["state"], "applied");
  EXPECT_EQ(daemon.ask("architecture.apply", {{"text", with_property("core.gain", 4.0)}})["state"],
            "applied");
  EXPECT_EQ(daemon.ask("component.stop", {{"components", {"second"}}})["state"], "applied");
  EXPECT_EQ(daemon.ask("component.start", {{"components", {"second"}}})["state"], "applied");
}

TEST(Freeze, StopsAChangeThatIsPrepared) {
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

TEST(Generation, IsAskedForByEveryChange) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["generation"], 2);
  std::vector<std::pair<std::string, Json>> changes = {
      {"param.set", gain(3.0)},
      {"component.start", {{"components", {"first"}}}},
      {"component.stop", {{"components", {"first"}}}},
      {"core.swap", {{"component", "first"}, {"core", "trial/other"}}},
      {"port.connect", {{"port", "second.ports.input"}, {"service", "signal.read"}}},
      {"port.disconnect", {{"port", "second.ports.input"}}},
      {"plugin.load", {{"plugin", "trial"}}},
      {"plugin.unload", {{"plugin", "trial"}}},
      {"plugin.reload", {{"plugin", "trial"}}},
      {"config.rollback", {{"generation", 1}}},
      {"lock.set", {{"lock", "all"}}}};

  for (auto& [method, params] : changes) {
    params["if_generation"] = 1;
    const auto error = daemon.ask(method, params);
    EXPECT_EQ(error["data"]["exit"], 6) << method << error;
    EXPECT_THAT(
        error["message"].get<std::string>(),
        HasSubstr("2 is running, made by uid " + std::to_string(geteuid()) + " with param.set"));
  }
  EXPECT_EQ(daemon.ask("status.get")["generation"], 2);
}

}  // namespace
}  // namespace mauve::test
