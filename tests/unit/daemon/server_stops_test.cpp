// SPDX-License-Identifier: LGPL-3.0-or-later
// A client that stops is heard, whoever else is connected.
#include "server/server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "fake_dispatcher.h"
#include "support/eventually.h"

namespace mauve::test {
namespace {

using protocol::Json;

TEST(Server, LetsAUserWhoseSlotsAreInUseStopButNothingElse) {
  server::Limits limits;
  limits.clients_per_uid = 2;
  limits.reserved_for_root = 0;
  ServedSocket served(limits);
  const auto first = served.client();
  const auto second = served.client();
  auto third = served.client();

  EXPECT_EQ(third.ask("param.set", {{"values", {{"a.b", 1}}}})["error"]["data"]["name"], "limit");
  EXPECT_EQ(third.ask("status.get")["error"]["data"]["name"], "limit");
  const std::vector<std::pair<std::string, Json>> urgent = {{"component.stop", {{"all", true}}},
                                                            {"change.confirm", Json::object()},
                                                            {"change.undo", Json::object()}};
  for (const auto& [method, params] : urgent) {
    ASSERT_TRUE(third.send(protocol::to_line(protocol::make_request(7, method, params)) + '\n'));
    ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == 1; }));
    served.dispatcher.answer_all();
    EXPECT_EQ(third.json()["result"]["late"], true) << method;
  }
}

/// Of a user whose one ordinary slot is in use.
server::Limits one_slot() {
  server::Limits limits;
  limits.clients_per_uid = 1;
  limits.reserved_for_root = 0;
  return limits;
}

std::string request(const std::string& method, Json params = Json::object()) {
  return protocol::to_line(protocol::make_request(7, method, std::move(params))) + '\n';
}

TEST(Server, NeverRefusesAConnectionThatMayOnlyStop) {
  ServedSocket served(one_slot());
  const auto ordinary = served.client();
  auto before = served.client();  // may only stop, and has not asked yet

  auto after = served.client();

  EXPECT_EQ(after.ask("status.get")["error"]["data"]["name"], "limit");
  EXPECT_EQ(before.ask("ping")["result"]["pong"], true) << "it keeps its place";
  EXPECT_EQ(served.server->clients().size(), 3U);
}

TEST(Server, GreetsAClientThatMayOnlyStopWithTheMethodsThatItMayCall) {
  ServedSocket served(one_slot());
  RawClient ordinary(served.path());
  const auto all = ordinary.json()["params"]["limits"];

  RawClient limited(served.path());
  const auto greeting = limited.json()["params"];

  EXPECT_FALSE(all.contains("only")) << all;
  EXPECT_EQ(greeting["role"], "admin");
  EXPECT_EQ(greeting["limits"]["only"],
            (Json{"ping", "component.stop", "change.confirm", "change.undo"}));
  EXPECT_EQ(greeting["limits"]["since"], "all connection slots are in use");
  const auto clients = served.server->clients();
  ASSERT_EQ(clients.size(), 2U);
  EXPECT_FALSE(clients[0].only_urgent);
  EXPECT_TRUE(clients[1].only_urgent);
}

TEST(Server, TakesThirtyStopsAtOnceBesideFullSlots) {
  constexpr int kStops = 30;
  ServedSocket served(one_slot());
  const auto ordinary = served.client();
  std::vector<RawClient> stops;
  for (int i = 0; i < kStops; ++i) {
    stops.emplace_back(served.path());
    ASSERT_TRUE(stops.back().send(request("component.stop", {{"all", true}})));
  }
  ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == kStops; }));

  served.dispatcher.answer_all();

  for (auto& client : stops) {
    EXPECT_EQ(client.json()["method"], "hello");
    EXPECT_EQ(client.json()["result"]["late"], true);
  }
}

TEST(Server, KeepsTheAnswerOfAStopWhenMoreClientsOfTheUserCome) {
  auto limits = one_slot();
  limits.stops_per_uid = 2;
  ServedSocket served(limits);
  const auto ordinary = served.client();
  auto stop = served.client();
  ASSERT_TRUE(stop.send(request("component.stop", {{"all", true}})));
  ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == 1; }));

  for (int i = 0; i < 5; ++i) {
    auto other = served.client();
    EXPECT_EQ(other.ask("ping")["result"]["pong"], true) << i;
  }
  served.dispatcher.answer_all();

  EXPECT_EQ(stop.json()["result"]["late"], true);
}

TEST(Server, RefusesANewcomerWhenAllWhoMayOnlyStopWaitForAnAnswer) {
  auto limits = one_slot();
  limits.stops_per_uid = 1;
  ServedSocket served(limits);
  const auto ordinary = served.client();
  auto silent = served.client();

  RawClient second(served.path());
  EXPECT_EQ(second.json()["error"]["data"]["id"], "too_many_clients") << "that one has not asked";
  ASSERT_TRUE(silent.send(request("component.stop", {{"all", true}})));
  ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == 1; }));
  RawClient third(served.path());
  EXPECT_EQ(third.json()["error"]["data"]["id"], "too_many_clients") << "it has no answer yet";
  served.dispatcher.answer_all();
  EXPECT_EQ(silent.json()["result"]["late"], true);

  auto fourth = served.client();

  EXPECT_EQ(fourth.ask("ping")["result"]["pong"], true);
  EXPECT_EQ(silent.json()["error"]["data"]["id"], "too_many_clients") << "a last line says why";
  EXPECT_TRUE(silent.closed_by_peer());
}

TEST(Server, ServesStopsOnASocketOfTheirOwn) {
  ServedSocket served;
  RawClient client(served.path_of_stops());

  const auto greeting = client.json()["params"];

  EXPECT_EQ(greeting["limits"]["since"], "this socket is for stop, confirm and undo");
  EXPECT_EQ(client.ask("status.get")["error"]["data"]["id"], "too_many_clients");
  ASSERT_TRUE(client.send(request("component.stop", {{"all", true}})));
  ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == 1; }));
  served.dispatcher.answer_all();
  EXPECT_EQ(client.json()["result"]["late"], true);
}

TEST(Server, TakesThirtyStopsBesideThreeViewersThatConnectInALoop) {
  if (geteuid() != 0) GTEST_SKIP() << "NOT TESTED: needs root, for clients of other users";
  constexpr gid_t kViewers = 50'000;
  server::RoleRules rules;
  rules.viewers = kViewers;
  ServedSocket served({}, rules);
  std::filesystem::permissions(served.path().parent_path(), std::filesystem::perms::all);
  std::filesystem::permissions(served.path(), std::filesystem::perms::all);
  std::atomic<bool> over{false};
  std::atomic<int> looked{0};
  std::vector<std::thread> viewers;
  for (uid_t uid = 50'001; uid < 50'004; ++uid) {
    viewers.emplace_back([&, uid] {
      // Of this thread only: the functions of the C library are of the whole process.
      ASSERT_EQ(syscall(SYS_setgroups, 0, nullptr), 0);
      ASSERT_EQ(syscall(SYS_setresgid, -1, kViewers, -1), 0);
      ASSERT_EQ(syscall(SYS_setresuid, -1, uid, -1), 0);
      EXPECT_FALSE(RawClient(served.path_of_stops()).connected());
      while (!over) {
        looked += RawClient(served.path()).connected() ? 1 : 0;
      }
    });
  }
  ASSERT_TRUE(eventually([&] { return looked >= 10; }));

  int answered = 0;
  for (int i = 0; i < 30; ++i) {
    RawClient client(served.path_of_stops());
    static_cast<void>(client.send(request("component.stop", {{"all", true}})));
    EXPECT_TRUE(eventually([&] { return served.dispatcher.kept() == 1; }));
    served.dispatcher.answer_all();
    static_cast<void>(client.json());
    answered += client.json()["result"]["late"] == true ? 1 : 0;
  }
  over = true;
  for (auto& viewer : viewers) viewer.join();

  EXPECT_EQ(answered, 30);
}

}  // namespace
}  // namespace mauve::test
