// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <future>
#include <set>

#include "arch/compare/describe.h"
#include "commands/audit.h"
#include "commands/lock.h"
#include "support/eventually.h"
#include "support/ramp.h"
#include "support/temp_dir.h"
#include "unit/daemon/front.h"

namespace mauve::daemon {
namespace {

using server::Role;

using protocol::methods;

TEST(Commands, AreServedByOneFunctionEachAsTheirLaneAsks) {
  std::set<const Command*> commands;
  for (const auto& method : methods()) {
    const auto& command = command_of(method);
    EXPECT_TRUE(commands.insert(&command).second) << method.name;
    EXPECT_NE(command.at_once == nullptr, command.later == nullptr) << method.name;
    EXPECT_EQ(answers_later(method.lane), command.later != nullptr) << method.name;
  }
  EXPECT_EQ(command_of(*protocol::find_method("component.stop")).later, stop);
  EXPECT_EQ(command_of(*protocol::find_method("status.get")).at_once, status);
}

TEST(Commands, ThatArePromisedOutOfBandDoNotWaitForChanges) {
  for (const auto& method : methods()) {
    if (method.out_of_band()) {
      EXPECT_TRUE(method.lane == Lane::any || method.lane == Lane::urgent) << method.name;
    }
    if (method.name.starts_with("plugin.") && method.mutation()) {
      EXPECT_EQ(method.role, Role::admin) << "who loads code can do anything";
    }
  }
}

TEST(Commands, ThatOnlyLookNeverGoBeforeAStop) {
  for (const auto& method : methods()) {
    if (method.lane == Lane::urgent) {
      EXPECT_TRUE(method.mutation()) << method.name;
    }
  }
}

struct Empty : Architecture {
  Empty() : Architecture("empty") {}
};

class TableTest : public Front<Empty> {
 protected:
  void SetUp() override {
    running.generation = 7;
    Front::SetUp();
  }
};

TEST_F(TableTest, GreetsWithTheRunningGeneration) {
  const auto hello = table.hello();

  EXPECT_EQ(hello["generation"], 7);
  EXPECT_EQ(hello["boot"], "b007");
}

/// The arguments that a method must have, of the right type and without a meaning.
Json arguments_of(const protocol::Method& method) {
  using protocol::Type;
  const auto sample = [](const Type& type) {
    Json one = type.kind == Type::Kind::count ? Json(1) : Json("none");
    if (type.shape == Type::Shape::list) return Json::array({std::move(one)});
    return type.shape == Type::Shape::map ? Json::object() : one;
  };
  auto params = Json::object();
  for (const auto& param : method.params) {
    if (!param.optional) params[param.name] = sample(param.type);
  }
  EXPECT_FALSE(protocol::check_params(method, params)) << method.name << params;
  return params;
}

/// For each method that [control] answers at once. Those of traces and rules need a thread that
/// this test has not.
TEST_F(TableTest, AnswersAnOperatorBeforeAllThatViewersHaveQueued) {
  const server::Caller viewer{1, {100, 1000, {}}, Role::viewer, outbox};
  int tried = 0;
  for (const auto& method : methods()) {
    const bool elsewhere = method.name.starts_with("trace.") || method.name == "rules.list";
    if (method.lane != Lane::read || elsewhere) continue;
    ++tried;
    std::promise<void> release;
    control.urgent([&] { release.get_future().wait(); });
    std::atomic<int> viewed{0};
    for (int i = 0; i < 8; ++i) {
      table.dispatch(viewer, *protocol::find_method("status.get"),
                     {1, "status.get", Json::object()}, [&](const server::Outcome&) { ++viewed; });
    }
    const server::Caller caller{2, {101, 1001, {}}, Role::admin, outbox};
    std::promise<int> before;
    table.dispatch(caller, method, {1, std::string(method.name), arguments_of(method)},
                   [&](const server::Outcome&) { before.set_value(viewed); });

    release.set_value();

    EXPECT_EQ(before.get_future().get(), 0) << method.name;
    EXPECT_TRUE(test::eventually([&] { return viewed == 8; })) << method.name;
  }
  EXPECT_GT(tried, 5);
}

TEST_F(TableTest, LetsAViewerLookAndNothingElse) {
  EXPECT_TRUE(std::holds_alternative<Json>(ask(Role::viewer, "status.get")));
  for (const auto* method : {"component.stop", "param.set", "plugin.load"}) {
    const auto fault = refused(Role::viewer, method, {{"plugin", "a"}, {"all", true}});
    EXPECT_EQ(fault.name, "not_permitted") << method;
    EXPECT_EQ(fault.exit, 5);
    EXPECT_THAT(fault.hint, testing::StartsWith("ask to be added to the group 'mauve"));
  }
}

TEST_F(TableTest, LetsAnOperatorChangeButNotLoadCode) {
  EXPECT_TRUE(
      std::holds_alternative<Json>(ask(Role::operator_, "component.stop", {{"all", true}})));
  EXPECT_EQ(refused(Role::operator_, "plugin.load", {{"plugin", "a"}}).name, "not_permitted");
  EXPECT_EQ(refused(Role::admin, "plugin.load", {{"plugin", "a"}}).name, "plugin_refused");
}

constexpr const char* kEmpty = R"({"schema": "mauve/architecture/1", "name": "empty"})";

TEST_F(TableTest, LetsAnAdminApplyAFileAndAViewerCompareOne) {
  EXPECT_EQ(refused(Role::operator_, "architecture.apply", {{"text", kEmpty}}).name,
            "not_permitted");
  const auto applied = ask(Role::admin, "architecture.apply", {{"text", kEmpty}});
  ASSERT_TRUE(std::holds_alternative<Json>(applied));
  EXPECT_EQ(std::get<Json>(applied)["state"], "unchanged");

  const auto same = ask(Role::viewer, "architecture.diff", {{"text", kEmpty}});
  ASSERT_TRUE(std::holds_alternative<Json>(same));
  EXPECT_EQ(std::get<Json>(same)["same"], true);
}

/// A viewer's file runs no code that no admin let in.
TEST_F(TableTest, LooksForAdminsOnlyAtPluginsThatAreNotLoaded) {
  const Json params = {
      {"text", R"({"schema": "mauve/architecture/1", "name": "empty", "plugins": ["a"]})"}};

  for (const auto role : {Role::viewer, Role::operator_}) {
    const auto checked = ask(role, "config.check", params);
    ASSERT_TRUE(std::holds_alternative<Json>(checked));
    const auto& errors = std::get<Json>(checked)["errors"];
    ASSERT_EQ(errors.size(), 1U) << errors;
    EXPECT_EQ(errors[0]["code"], "not_permitted");
    EXPECT_EQ(errors[0]["at"], "plugins.a");
    EXPECT_EQ(refused(role, "architecture.diff", params).errors, errors);
  }
  const auto errors = std::get<Json>(ask(Role::admin, "config.check", params))["errors"];
  EXPECT_EQ(errors[0]["code"], "plugin_refused");
}

TEST_F(TableTest, ReportsEveryErrorOfAFileThatIsRefused) {
  const std::string text =
      R"({"schema": "mauve/architecture/1", "name": "empty", "plugins": ["a", "a", "B"]})";

  const auto fault = refused(Role::admin, "architecture.apply", {{"text", text}, {"file", "f"}});

  EXPECT_EQ(fault.where, "f");
  EXPECT_EQ(fault.errors.size(), 3U) << fault.errors;
  EXPECT_EQ(fault.state, "unchanged");
}

TEST_F(TableTest, StatesTheGenerationWithEveryRefusal) {
  const auto fault = refused(Role::admin, "param.get", {{"address", "nothing.here"}});

  EXPECT_EQ(fault.generation, 7U);
  EXPECT_EQ(fault.state, "unchanged");
}

TEST_F(TableTest, WritesAnAuditLineForEveryChangeAndEveryRefusedOne) {
  static_cast<void>(ask(Role::admin, "component.stop", {{"all", true}, {"reason", "lunch"}}));
  static_cast<void>(refused(Role::viewer, "component.stop", {{"all", true}}));
  static_cast<void>(ask(Role::viewer, "status.get"));
  log.flush();

  const auto records = log.history().tail(10, {});

  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].event, logging::Event::change_applied);
  EXPECT_THAT(logging::to_json_line(records[0]), testing::HasSubstr("\"reason\":\"lunch\""));
  EXPECT_THAT(records[0].text, testing::StartsWith("component.stop by uid 1000 (lunch): "));
  EXPECT_EQ(records[1].event, logging::Event::change_refused);
  EXPECT_THAT(records[1].text, testing::HasSubstr("uid 1000"));
}

TEST_F(TableTest, NamesTheObjectOfARefusedChangeAndADryRunInTheLog) {
  const Json values = {{"a.core.w", 1}, {"a.core.x", 1}, {"a.core.y", 1}, {"a.core.z", 1}};
  const std::vector<std::tuple<const char*, Json, const char*>> requests = {
      {"param.set", {{"values", {{"a.core.x", 1}}}}, "param.set a.core.x by"},
      {"param.set", {{"values", values}}, "param.set a.core.w, a.core.x, a.core.y and 1 more by"},
      {"component.start", {{"components", {"a", "b"}}}, "component.start a, b by"},
      {"port.disconnect", {{"port", "a.ports.in"}}, "port.disconnect a.ports.in by"},
      {"architecture.apply", {{"text", "{"}, {"file", "robot.json"}}, "architecture.apply robot"},
      {"change.apply", {{"text", "["}}, "change.apply by"},
      {"architecture.apply",
       {{"text", "{"}, {"dry_run", true}},
       "dry run of architecture.apply by"}};

  for (const auto& [method, params, text] : requests) {
    EXPECT_NE(refused(Role::admin, method, params).name, "") << method;
    log.flush();
    EXPECT_THAT(log.history().tail(1, {}).front().text, testing::StartsWith(text));
  }
}

TEST_F(TableTest, LogsAConfirmationOfNothingAsUnchanged) {
  static_cast<void>(ask(Role::operator_, "change.confirm"));
  static_cast<void>(ask(Role::admin, "lock.set", {{"lock", "none"}}));
  log.flush();

  const auto records = log.history().tail(2, {});

  ASSERT_EQ(records.size(), 2U);
  EXPECT_THAT(records[0].text, testing::AllOf(testing::StartsWith("change.confirm"),
                                              testing::EndsWith("unchanged")));
  EXPECT_THAT(records[1].text, testing::EndsWith("unchanged none"));
}

TEST_F(TableTest, WritesWhoItWasOnceIntoTheAuditLog) {
  Call call;
  call.caller = {1, {100, 1000, {}}, Role::admin, outbox};
  call.method = protocol::find_method("lock.set");
  call.params = {{"lock", "all"}};

  const auto line = audit_refused(running, call, {});

  ASSERT_TRUE(line);
  EXPECT_EQ((*line)["uid"], 1000);
  EXPECT_FALSE(line->contains("by")) << *line;
}

TEST_F(TableTest, LimitsTheSubscriptionsOfAClient) {
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(std::holds_alternative<Json>(ask(Role::viewer, "log.tail", {{"follow", true}})));
  }

  EXPECT_EQ(refused(Role::viewer, "log.tail", {{"follow", true}}).name, "limit");
}

TEST_F(TableTest, ForgetsTheSubscriptionsOfAClientThatHasGone) {
  static_cast<void>(ask(Role::viewer, "log.tail", {{"follow", true}}));
  ASSERT_EQ(outbox->subscriptions(), 1U);
  log.write(logging::Event::accept_paused);
  log.flush();
  ASSERT_GT(outbox->bytes(), 0U) << "it follows the log";

  table.gone(1);
  static_cast<void>(ask(Role::viewer, "status.get"));  // behind it on [control]
  log.flush();
  const auto before = outbox->bytes();
  log.write(logging::Event::accept_resumed);
  log.flush();

  EXPECT_EQ(outbox->bytes(), before);
  EXPECT_EQ(outbox->dropped(), 0U);
}

TEST_F(TableTest, LocksForAdministratorsOnly) {
  EXPECT_EQ(refused(Role::operator_, "lock.set", {{"lock", "all"}}).name, "not_permitted");
  EXPECT_EQ(refused(Role::admin, "lock.set", {{"lock", "some"}}).name, "invalid_value");
  EXPECT_EQ(running.lock, Lock::none);
}

TEST_F(TableTest, RefusesWhatIsLockedButNeverAStop) {
  ASSERT_TRUE(std::holds_alternative<Json>(ask(Role::admin, "lock.set", {{"lock", "all"}})));

  const auto fault = refused(Role::operator_, "param.set", {{"values", {{"a.core.b", 1}}}});

  EXPECT_EQ(fault.name, "conflict");
  EXPECT_EQ(fault.exit, 6);
  EXPECT_TRUE(
      std::holds_alternative<Json>(ask(Role::operator_, "component.stop", {{"all", true}})));
}

TEST_F(TableTest, ListsNoGenerationsWhenNoneAreKept) {
  auto outcome = ask(Role::viewer, "config.history");

  EXPECT_EQ(std::get<Json>(outcome)["state_dir"], nullptr);
  EXPECT_EQ(refused(Role::admin, "config.rollback", {{"generation", 1}}).name, "unsupported");
}

TEST_F(TableTest, ShowsAViewerWhatItsProcessWasGranted) {
  const auto outcome = ask(Role::viewer, "daemon.doctor");

  ASSERT_TRUE(std::holds_alternative<Json>(outcome));
  const auto& answer = std::get<Json>(outcome);
  EXPECT_EQ(answer["pid"], getpid());
  EXPECT_EQ(answer["state_dir"], nullptr);
  EXPECT_FALSE(answer["threads"].empty());
}

TEST_F(TableTest, FindsRecordsByTimeTextAndLevel) {
  log.write(logging::Event::accept_paused);
  log.write(logging::Event::accept_resumed);
  log.flush();

  auto found = ask(Role::viewer, "log.tail", {{"grep", "AGAIN"}});
  ASSERT_EQ(std::get<Json>(found)["records"].size(), 1U);
  EXPECT_EQ(std::get<Json>(found)["records"][0]["event"], "accept_resumed");
  EXPECT_EQ(std::get<Json>(found)["dropped"], (Json{{"lost", 0}, {"gone", 0}}));
  auto later = ask(Role::viewer, "log.tail", {{"since", "2199-01-01"}});
  EXPECT_EQ(std::get<Json>(later)["records"], Json::array());
  auto loud = ask(Role::viewer, "log.tail", {{"level", "error"}});
  EXPECT_EQ(std::get<Json>(loud)["records"], Json::array());
  EXPECT_EQ(refused(Role::viewer, "log.tail", {{"level", "loud"}}).name, "invalid_value");
  EXPECT_EQ(refused(Role::viewer, "log.tail", {{"since", "soon"}}).name, "invalid_value");
  EXPECT_EQ(refused(Role::viewer, "log.tail", {{"grep", std::string(300, 'x')}}).name, "limit");
}

TEST_F(TableTest, SetsTheLogLevelForATimeAlsoWhenAllIsLocked) {
  running.lock = Lock::all;
  EXPECT_EQ(refused(Role::viewer, "log.set_level", {{"level", "debug"}}).name, "not_permitted");
  EXPECT_EQ(refused(Role::operator_, "log.set_level", {{"level", "loud"}}).name, "invalid_value");
  EXPECT_EQ(refused(Role::operator_, "log.set_level", {{"level", "debug"}, {"for", "2d"}}).name,
            "invalid_value");
  EXPECT_EQ(
      refused(Role::operator_, "log.set_level", {{"level", "debug"}, {"component", "a"}}).name,
      "unknown_name");

  auto set = ask(Role::operator_, "log.set_level", {{"level", "error"}, {"for", "10min"}});
  ASSERT_TRUE(std::holds_alternative<Json>(set));
  EXPECT_EQ(std::get<Json>(set)["level"], "error");

  auto shown = ask(Role::viewer, "log.level");
  EXPECT_EQ(std::get<Json>(shown)["level"], "error");
  EXPECT_EQ(std::get<Json>(shown)["default"], "debug");
  auto status = ask(Role::viewer, "status.get");
  EXPECT_EQ(std::get<Json>(status)["log_levels"][0]["level"], "error");
  EXPECT_GT(std::get<Json>(status)["log_levels"][0]["left_s"], 0);
  log.flush();
  const auto records = log.history().tail(1, {logging::Level::debug, {}, {}, "log level"});
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(records[0].text, "the log level is error now, for 10min");

  static_cast<void>(ask(Role::operator_, "log.set_level", {{"level", "default"}}));
  EXPECT_EQ(std::get<Json>(ask(Role::viewer, "log.level"))["items"], Json::array());
}

using TwoTable = Front<ramp::Two<ramp::Up>>;

TEST_F(TwoTable, StopsAComponentInWhichAnAbandonedThreadMayBe) {
  running.abandoned_in["left"] = "left.core on_configure";

  const auto stopped = ask(Role::operator_, "change.apply", {{"text", R"([{"stop": "left"}])"}});
  const auto set = refused(Role::operator_, "change.apply",
                           {{"text", R"([{"set": "left.core.step", "value": 2.0}])"}});

  ASSERT_TRUE(std::holds_alternative<Json>(stopped));
  EXPECT_EQ(deployer.status("left").state, ComponentState::stopped);
  EXPECT_EQ(set.id, "component_abandoned");
}

using RampTable = Front<ramp::Architecture>;

TEST_F(RampTable, NamesThePortsThatAreConnectedToAResource) {
  const auto users = [this](const char* resource) {
    return std::get<Json>(ask(Role::viewer, "object.get", {{"address", resource}}))["users"];
  };

  EXPECT_EQ(users("position"), Json({"control.ports.out"}));
  EXPECT_EQ(users("speed"), Json::array()) << "no port is connected to it";
}

TEST_F(RampTable, ShowsEveryAttributeOfATask) {
  const auto shown = std::get<Json>(ask(Role::viewer, "object.get", {{"address", "control"}}));
  for (const auto& [name, value] : arch::describe_task(TaskAttributes{})) {
    EXPECT_TRUE(shown["task"].contains(name)) << name;
  }
}

TEST_F(RampTable, LeadsFromShowToGetWhereAnAddressHasAValueOnly) {
  for (const std::string address : {"control.task.watchdog", "control.missed"}) {
    const Fault fault = refused(Role::viewer, "object.get", {{"address", address}});
    EXPECT_EQ(fault.name, "unknown_name");
    EXPECT_EQ(fault.hint, "mauvectl get " + address +
                              " prints its value; mauvectl show control shows the whole component");
  }
}

}  // namespace
}  // namespace mauve::daemon
