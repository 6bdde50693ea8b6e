// SPDX-License-Identifier: LGPL-3.0-or-later
// Changes of a running daemon, over its socket.
#include <algorithm>

#include "mauve/host/change.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;
Json swap(const std::string& core, const std::string& probation = "3000") {
  return {{"component", "first"}, {"core", core}, {"probation", probation}};
}

TEST(Swap, ReplacesACoreAndKeepsItsState) {
  TrialDaemon daemon;
  ASSERT_TRUE(eventually([&] { return daemon.value("first.core.count") > 10; }));

  const auto receipt = daemon.ask(
      "core.swap", {{"component", "first"}, {"core", "trial/other"}, {"set", {{"gain", 3.0}}}});

  EXPECT_EQ(receipt["generation"], 2) << receipt;
  EXPECT_EQ(receipt["changed"], true);
  EXPECT_EQ(receipt["state"], "applied");
  EXPECT_GT(receipt["commit"], 0);
  ASSERT_EQ(receipt["components"].size(), 1U);
  EXPECT_EQ(receipt["components"][0]["name"], "first");
  EXPECT_TRUE(receipt["components"][0]["missed"].is_number());
  EXPECT_GT(receipt["components"][0]["bytes"], 0);
  EXPECT_EQ(daemon.component("first")["core"], "trial/other");
  EXPECT_TRUE(daemon.becomes("signal.read", 3.0));
  EXPECT_TRUE(eventually([&] { return daemon.value("first.core.count") > 10; }));
}

TEST(Swap, ChangesNothingWhenItIsRefused) {
  TrialDaemon daemon;
  const std::vector<std::pair<Json, std::string>> refused = {
      {swap("trial/refusing"), "invalid_value"},
      {swap("trial/throwing_hook"), "hook_threw"},
      {swap("trial/another"), "type_mismatch"},
      {swap("trial/othr"), "unknown_name"},
      {swap("nothere/core"), "unknown_name"},
      {{{"component", "frist"}, {"core", "trial/other"}}, "unknown_name"},
      {{{"component", "signal"}, {"core", "trial/other"}}, "type_mismatch"},
      {{{"component", "first"}, {"core", "trial/other"}, {"set", {{"gain", 11}}}}, "invalid_value"},
      {{{"component", "first"}, {"core", "trial/other"}, {"set", {{"gian", 1}}}}, "unknown_name"},
      {{{"component", "first"}, {"core", "trial/other"}, {"set", {{"gain", "x"}}}},
       "invalid_value"},
      {{{"component", "first"}, {"core", "trial/other"}, {"if_generation", 7}}, "conflict"},
  };
  for (const auto& [params, name] : refused) {
    const auto error = daemon.ask("core.swap", params);
    EXPECT_EQ(error["data"]["name"], name) << params << error;
    EXPECT_EQ(error["data"]["state"], "unchanged");
    EXPECT_EQ(error["data"]["generation"], 1);
    EXPECT_FALSE(error["message"].get<std::string>().empty());
  }

  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Swap, SuggestsTheNearestName) {
  TrialDaemon daemon;

  EXPECT_THAT(daemon.ask("core.swap", swap("trial/othr"))["data"]["hint"].get<std::string>(),
              HasSubstr("trial/other"));
  EXPECT_THAT(
      daemon.ask("param.get", {{"address", "first.core.gian"}})["data"]["hint"].get<std::string>(),
      HasSubstr("first.core.gain"));
}

TEST(Set, ChangesSeveralPropertiesAtOneInstant) {
  TrialDaemon daemon;

  const auto receipt = daemon.ask(
      "param.set", {{"values", {{"first.core.gain", 2.5}, {"second.fsm.period", "10ms"}}}});

  EXPECT_EQ(receipt["generation"], 2) << receipt;
  EXPECT_EQ(receipt["components"].size(), 2U);
  EXPECT_TRUE(daemon.becomes("signal.read", 2.5));
  EXPECT_EQ(daemon.value("second.fsm.period"), "10ms");
}

TEST(Set, RefusesAllWhenOneIsWrong) {
  TrialDaemon daemon;

  const auto error =
      daemon.ask("param.set", {{"values", {{"first.core.gain", 2.5}, {"second.core.gain", 99}}}});

  EXPECT_EQ(error["data"]["where"], "second.core.gain") << error;
  EXPECT_EQ(daemon.value("first.core.gain"), 1.0);
}

TEST(Set, RefusesToForgetAStateThatIsNotDeclared) {
  TrialDaemon daemon;
  Json forgetful = swap("trial/forgetful");
  const auto lost = daemon.ask("core.swap", forgetful);
  EXPECT_THAT(lost["data"]["hint"].get<std::string>(), HasSubstr("--state drop"));
  forgetful["state"] = "drop";
  ASSERT_EQ(daemon.ask("core.swap", forgetful)["state"], "applied");

  const auto refused = daemon.ask("param.set", {{"values", {{"first.core.gain", 2}}}});
  EXPECT_THAT(refused["data"]["hint"].get<std::string>(), HasSubstr("--state drop"));

  EXPECT_EQ(
      daemon.ask("param.set", {{"values", {{"first.core.gain", 2}}}, {"state", "drop"}})["state"],
      "applied");
}

TEST(Connect, TakesEffectAndSoDoesDisconnect) {
  TrialDaemon daemon;
  ASSERT_TRUE(daemon.becomes("second.core.input", 1.0));

  ASSERT_EQ(daemon.ask("port.disconnect", {{"port", "second.ports.input"}})["state"], "applied");
  EXPECT_TRUE(daemon.becomes("second.core.input", 0.5));  // the default of the port

  ASSERT_EQ(daemon.ask("port.connect",
                       {{"port", "second.ports.input"}, {"service", "signal.read"}})["state"],
            "applied");
  EXPECT_TRUE(daemon.becomes("second.core.input", 1.0));
}

TEST(Connect, WritesTheSafeValueWhenAWriterIsDisconnected) {
  TrialDaemon daemon;
  ASSERT_TRUE(daemon.becomes("signal.read", 1.0));

  ASSERT_EQ(daemon.ask("port.disconnect", {{"port", "first.ports.output"}})["state"], "applied");

  EXPECT_TRUE(daemon.becomes("signal.read", -1.0));
}

TEST(Connect, ChangesNothingWhenItIsRefused) {
  TrialDaemon daemon;
  const auto connecting = [&](const char* port, const char* service) {
    return daemon.ask("port.connect", {{"port", port}, {"service", service}})["data"]["name"];
  };

  EXPECT_EQ(connecting("first.ports.input", "signal.write"), "type_mismatch");
  EXPECT_EQ(connecting("first.ports.input", "count.read"), "type_mismatch");
  EXPECT_EQ(connecting("first.ports.inptu", "signal.read"), "unknown_name");
  EXPECT_EQ(connecting("first.ports.input", "signal.raed"), "unknown_name");
  EXPECT_EQ(connecting("first.input", "signal.read"), "invalid_value");
  EXPECT_NE(daemon.ask("port.disconnect", {{"port", "first.ports.input"}})["data"], Json());
  EXPECT_EQ(daemon.ask("status.get")["generation"], 1);
}

/// `second` reads what `first` wrote, which may not be older than 50 ms.
Json connect_limited(TrialDaemon& daemon) {
  static_cast<void>(daemon.ask("port.disconnect", {{"port", "second.ports.input"}}));
  return daemon.ask(
      "port.connect",
      {{"port", "second.ports.input"}, {"service", "signal.read"}, {"max_age", "50ms"}});
}

TEST(Connect, WithALimitOnTheAgeSaysWhenValuesAreStale) {
  TrialDaemon daemon;
  ASSERT_TRUE(daemon.becomes("signal.read", 1.0));
  ASSERT_EQ(connect_limited(daemon)["state"], "applied");
  auto watching = daemon.client();
  ASSERT_TRUE(
      watching.ask("watch.subscribe", {{"addresses", {"second.ports.input"}}}).contains("result"));
  const auto get = [&] { return daemon.ask("param.get", {{"address", "second.ports.input"}}); };
  EXPECT_TRUE(eventually([&] { return get()["status"] == "new_data"; }));

  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"first"}}})["state"], "applied");

  EXPECT_TRUE(eventually([&] { return get()["status"] == "stale"; }));
  const auto now = get();
  EXPECT_EQ(now["value"], -1.0) << "a stale value is delivered";
  EXPECT_GT(now["age_ns"], 50'000'000);
  EXPECT_EQ(now["max_age"], "50ms");
  EXPECT_NE(daemon.ask("param.get", {{"address", "signal.read"}})["status"], "stale");
  EXPECT_EQ(daemon.ask("object.get", {{"address", "second.ports.input"}})["status"], "stale");
  const auto rows = daemon.ask("object.get", {{"address", "second"}})["ports"];
  EXPECT_EQ(rows[0]["status"], "stale") << rows;
  EXPECT_TRUE(eventually([&] { return watching.json()["params"]["status"] == "stale"; }));
}

TEST(Show, SaysOfWritePortsOnlyWhetherTheyHaveASafeValue) {
  TrialDaemon daemon;

  const auto ports = daemon.ask("object.get", {{"address", "first"}})["ports"];
  EXPECT_EQ(ports.size(), 2U);
  for (const auto& row : ports) {
    EXPECT_EQ(row.value("safe_value", Json()), row["name"] == "output" ? Json(true) : Json())
        << row;
  }
}

TEST(Connect, RefusesALimitThatMeansNothing) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("port.disconnect", {{"port", "first.ports.output"}})["state"], "applied");
  const auto connecting = [&](const char* port, const char* service, const char* max_age) {
    return daemon.ask("port.connect",
                      {{"port", port}, {"service", service}, {"max_age", max_age}})["data"];
  };

  EXPECT_EQ(connecting("first.ports.input", "signal.read", "50")["where"], "max_age");
  EXPECT_EQ(connecting("first.ports.input", "signal.read", "0ms")["where"], "max_age");
  EXPECT_EQ(connecting("first.ports.output", "signal.write", "50ms")["where"],
            "first.ports.output");
  EXPECT_EQ(daemon.ask("status.get")["generation"], 2);
}

TEST(Status, SaysHowLateAJobIsThatDoesNotEnd) {
  TrialDaemon daemon(unguarded());
  EXPECT_TRUE(eventually([&] { return daemon.component("second")["late_ns"] == 0; }));

  static_cast<void>(daemon.ask("core.swap", swap("trial/hanging")));

  EXPECT_TRUE(eventually([&] { return daemon.component("first")["late_ns"] > 100'000'000; }));
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Plugins, ForAComponentAreTheCoresThatFitIt) {
  TrialDaemon daemon;

  const auto items = daemon.ask("plugin.list", {{"for", "first"}})["items"];

  ASSERT_EQ(items.size(), 1U) << items;
  EXPECT_EQ(items[0]["name"], "trial");
  const auto& cores = items[0]["cores"];
  EXPECT_NE(std::find(cores.begin(), cores.end(), "trial/other"), cores.end());
  EXPECT_EQ(std::find(cores.begin(), cores.end(), "trial/another"), cores.end())
      << "another contract";
}

TEST(Stop, ParksWithSafeValuesAndStartGoesOn) {
  TrialDaemon daemon;
  ASSERT_TRUE(daemon.becomes("signal.read", 1.0));

  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"first"}}})["state"], "applied");
  EXPECT_EQ(daemon.component("first")["state"], "stopped");
  EXPECT_TRUE(daemon.becomes("signal.read", -1.0));
  EXPECT_EQ(daemon.ask("component.stop", {{"components", {"first"}}})["changed"], false);

  ASSERT_EQ(daemon.ask("component.start", {{"components", {"first"}}})["state"], "applied");
  EXPECT_TRUE(daemon.becomes("signal.read", 1.0));
}

TEST(Stop, OfAllIsServedWhileALongChangeIsPrepared) {
  TrialDaemon daemon;
  auto slow = daemon.client();
  ASSERT_TRUE(slow.send(R"({"jsonrpc":"2.0","id":7,"method":"core.swap","params":)"
                        R"({"component":"first","core":"trial/slow"}})"
                        "\n"));
  auto other = daemon.client();
  EXPECT_EQ(other.ask("ping")["result"]["pong"], true);

  EXPECT_EQ(other.ask("component.stop", {{"all", true}})["result"]["state"], "applied");

  EXPECT_FALSE(slow.line(std::chrono::milliseconds(0)).has_value());
  EXPECT_EQ(daemon.component("first")["state"], "stopped");
  EXPECT_EQ(daemon.component("second")["state"], "stopped");
  // A change that was prepared before the stop must not start any component again.
  EXPECT_EQ(slow.json()["id"], 7);
  EXPECT_EQ(daemon.component("first")["state"], "stopped");
}

TEST(Stop, IsNotUndoneByASwapInPlaceThatBeganBeforeIt) {
  TrialDaemon daemon;
  auto slow = daemon.client();
  ASSERT_TRUE(slow.send(R"({"jsonrpc":"2.0","id":7,"method":"core.swap","params":)"
                        R"({"component":"first","core":"trial/slow","in_place":true}})"
                        "\n"));
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "stopped"; }));

  static_cast<void>(daemon.ask("component.stop", {{"all", true}}));

  EXPECT_TRUE(slow.json().contains("result"));
  EXPECT_EQ(daemon.component("first")["core"], "trial/slow");
  EXPECT_EQ(daemon.component("first")["state"], "stopped");
}

TEST(Stop, OfAllIsServedWhileAChangeWaitsForACoreThatHangs) {
  TrialDaemon daemon(unguarded());
  static_cast<void>(daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/hanging"}}));
  ASSERT_TRUE(daemon.becomes("signal.read", 9.0)) << "it hangs";
  auto waiting = daemon.client();
  ASSERT_TRUE(waiting.send(R"({"jsonrpc":"2.0","id":7,"method":"core.swap","params":)"
                           R"({"component":"first","core":"trial/other"}})"
                           "\n"));
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["changing"] == true; }));
  auto stopping = daemon.client();
  ASSERT_TRUE(stopping.send(R"({"jsonrpc":"2.0","id":8,"method":"component.stop","params":)"
                            R"({"all":true}})"
                            "\n"));

  EXPECT_TRUE(eventually([&] { return daemon.component("second")["state"] == "stopped"; }));
  EXPECT_EQ(waiting.json()["error"]["data"]["name"], "timed_out");
  const auto partly = stopping.json()["error"];
  EXPECT_EQ(partly["data"]["name"], "partly") << partly;
  EXPECT_EQ(partly["data"]["state"], "safe");
  EXPECT_TRUE(daemon.becomes("signal.read", -1.0)) << "its safe value";
}

TEST(Change, WaitsForTheOneUnderWayWhileReadsAreServed) {
  TrialDaemon daemon;
  auto slow = daemon.client();
  ASSERT_TRUE(slow.send(R"({"jsonrpc":"2.0","id":7,"method":"core.swap","params":)"
                        R"({"component":"first","core":"trial/slow"}})"
                        "\n"));
  auto second = daemon.client();
  ASSERT_TRUE(second.send(R"({"jsonrpc":"2.0","id":8,"method":"param.set","params":)"
                          R"({"values":{"second.core.gain":2}}})"
                          "\n"));
  EXPECT_EQ(daemon.ask("status.get")["generation"], 1);
  EXPECT_FALSE(second.line(std::chrono::milliseconds(0)).has_value());

  EXPECT_EQ(slow.json()["result"]["generation"], 2);
  EXPECT_EQ(second.json()["result"]["generation"], 3);
}

TEST(Change, IsRefusedWhenItsDeadlinePassesBeforeItBegins) {
  TrialDaemon daemon;

  const auto error = daemon.ask(
      "core.swap", {{"component", "first"}, {"core", "trial/slow"}, {"deadline_ms", 100}});

  EXPECT_EQ(error["data"]["name"], "timed_out") << error;
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
  const Json in_time = {{"values", {{"first.core.gain", 2.0}}}, {"deadline_ms", 60'000}};
  EXPECT_EQ(daemon.ask("param.set", in_time)["state"], "applied");
}

TEST(Fault, StopsItsOwnComponentOnly) {
  TrialDaemon daemon;
  ASSERT_TRUE(daemon.becomes("signal.read", 1.0));

  ASSERT_EQ(daemon.ask("core.swap", swap("trial/throwing_job", "off"))["state"], "applied");

  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }));
  EXPECT_THAT(daemon.component("first")["fault"].get<std::string>(), HasSubstr("division"));
  EXPECT_EQ(daemon.component("second")["state"], "running");
  EXPECT_TRUE(daemon.becomes("signal.read", -1.0));
  Json records;
  ASSERT_TRUE(eventually([&] {
    records = daemon.ask("log.tail", {{"level", "error"}})["records"];
    return !records.empty();
  }));
  EXPECT_EQ(records[0]["event"], "component_faulted");
  EXPECT_EQ(records[0]["component"], "first");
}

TEST(Fault, IsOverAfterASwapToASoundCoreAndAStart) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap("trial/throwing_job", "off"))["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }));

  EXPECT_EQ(daemon.ask("core.swap", swap("trial/steady"))["state"], "applied");
  EXPECT_EQ(daemon.ask("component.start", {{"components", {"first"}}})["state"], "applied");

  EXPECT_EQ(daemon.component("first")["state"], "running");
  EXPECT_TRUE(daemon.becomes("signal.read", 1.0));
}

TEST(Export, GivesTheSameSystemWhenItIsLoaded) {
  Json exported;
  {
    TrialDaemon daemon;
    ASSERT_EQ(daemon.ask("core.swap", {{"component", "first"},
                                       {"core", "trial/other"},
                                       {"set", {{"gain", 3.0}}}})["state"],
              "applied");
    ASSERT_EQ(daemon.ask("port.disconnect", {{"port", "second.ports.input"}})["state"], "applied");
    ASSERT_EQ(daemon.ask("component.stop", {{"components", {"second"}}})["state"], "applied");
    ASSERT_EQ(daemon.ask("port.connect", {{"port", "first.ports.input"},
                                          {"service", "signal.read"},
                                          {"max_age", "50ms"}})["state"],
              "applied");
    exported = daemon.ask("config.get")["architecture"];
  }
  EXPECT_EQ(exported["components"]["first"]["ports"]["input"],
            Json({{"connect", "signal.read"}, {"max_age", "50ms"}}));
  TrialDaemon again(exported.dump());

  EXPECT_EQ(again.ask("config.get")["architecture"], exported);
  EXPECT_EQ(again.component("first")["core"], "trial/other");
  EXPECT_EQ(again.component("second")["state"], "stopped");
  EXPECT_EQ(again.value("first.core.gain"), 3.0);
}

}  // namespace
}  // namespace mauve::test
