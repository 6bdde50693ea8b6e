// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "fake_dispatcher.h"
#include "support/eventually.h"

namespace mauve::test {
namespace {

using protocol::Json;
using std::chrono::milliseconds;

TEST(Server, GreetsWithRoleAndLimits) {
  ServedSocket served;
  ASSERT_TRUE(served.opened);

  RawClient client(served.path());
  const auto hello = client.json();

  EXPECT_EQ(hello["method"], "hello");
  EXPECT_EQ(hello["params"]["role"], "admin");
  EXPECT_EQ(hello["params"]["limits"]["line"], 1048576);
  EXPECT_EQ(hello["params"]["limits"]["inflight"], 8);
}

TEST(Server, AnswersARequestWithItsId) {
  ServedSocket served;
  auto client = served.client();

  const auto answer = client.ask("ping");

  EXPECT_EQ(answer["id"], 1);
  EXPECT_EQ(answer["result"]["pong"], true);
}

TEST(Server, RefusesAnUnknownMethodWithTheNearestName) {
  ServedSocket served;
  auto client = served.client();

  const auto answer = client.ask("component.stopp");

  EXPECT_EQ(answer["error"]["code"], -32601);
  EXPECT_THAT(answer["error"]["data"]["hint"].get<std::string>(),
              testing::HasSubstr("component.stop"));
}

TEST(Server, RefusesAnUnknownArgumentBeforeTheDispatcherSeesIt) {
  ServedSocket served;
  auto client = served.client();

  const auto answer = client.ask("component.stop", {{"componentz", {"a"}}});

  EXPECT_EQ(answer["error"]["code"], -32602);
  EXPECT_EQ(served.dispatcher.served(), 0U);
}

TEST(Server, ReportsToTheDispatcherWhichChangesItRefusedItself) {
  const ServedSocket served;
  auto client = served.client();

  static_cast<void>(client.ask("param.get", {{"adress", "a.b"}}));
  static_cast<void>(client.ask("param.set", {{"valeus", Json::object()}}));
  static_cast<void>(client.ask("ping"));

  EXPECT_EQ(served.dispatcher.refused_ones(),
            (std::vector<std::string>{"param.set: invalid_params"}));
}

TEST(Server, LetsAQuickAnswerOvertakeASlowOne) {
  ServedSocket served;
  auto client = served.client();
  ASSERT_TRUE(client.send(R"({"jsonrpc":"2.0","id":"slow","method":"status"})"
                          "\n"));
  ASSERT_TRUE(client.send(R"({"jsonrpc":"2.0","id":"quick","method":"ping"})"
                          "\n"));

  EXPECT_EQ(client.json()["id"], "quick");
  served.dispatcher.answer_all();
  EXPECT_EQ(client.json()["id"], "slow");
}

TEST(Server, StopsReadingAClientWithEightRequestsInFlight) {
  ServedSocket served;
  auto client = served.client();
  for (int i = 0; i < 12; ++i) {
    ASSERT_TRUE(client.send(R"({"jsonrpc":"2.0","id":1,"method":"status"})"
                            "\n"));
  }
  ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == 8; }));
  auto other = served.client();
  EXPECT_EQ(other.ask("ping")["result"]["pong"], true);
  EXPECT_EQ(served.dispatcher.kept(), 8U);

  served.dispatcher.answer_all();

  ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == 4; }));
  served.dispatcher.answer_all();
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(client.json()["result"]["late"], true) << i;
  }
}

TEST(Server, AnswersAClientThatHasClosedItsSendingSide) {
  ServedSocket served;
  auto client = served.client();
  ASSERT_TRUE(client.send(R"({"jsonrpc":"2.0","id":7,"method":"status"})"
                          "\n"));
  client.half_close();
  ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == 1; }));

  served.dispatcher.answer_all();

  EXPECT_EQ(client.json()["id"], 7);
  EXPECT_TRUE(client.closed_by_peer());
}

TEST(Server, KeepsSendingToAHalfClosedSubscriberUntilItIsGone) {
  ServedSocket served;
  auto client = served.client();
  const auto sub = client.ask("watch.subscribe", {{"addresses", {"a"}}})["result"]["sub"];
  client.half_close();
  const auto outbox = served.dispatcher.outbox(0);

  ASSERT_TRUE(outbox->push(sub, "a", "value", protocol::NotificationText(Json{{"value", 1}})));
  EXPECT_EQ(client.notification("value")["params"]["value"], 1);
  client.close();

  EXPECT_TRUE(eventually([&] { return served.server->clients().empty(); }));
  EXPECT_FALSE(outbox->push(sub, "a", "value", protocol::NotificationText(Json{{"value", 2}})));
}

TEST(Server, SendsAnAnswerLargerThanTheHardLimit) {
  ServedSocket served;
  served.dispatcher.big_answer = 3 * 1024 * 1024;
  auto client = served.client();

  const auto answer = client.ask("config.get");

  EXPECT_EQ(answer["result"]["architecture"].get<std::string>().size(), 3U * 1024 * 1024);
}

TEST(Server, ReportsToTheDispatcherOnceThatAClientHasGone) {
  ServedSocket served;
  {
    auto client = served.client();
    EXPECT_EQ(client.ask("ping")["result"]["pong"], true);
  }

  ASSERT_TRUE(eventually([&] { return served.server->clients().empty(); }));
  EXPECT_EQ(served.dispatcher.gone_clients(), std::vector<std::uint64_t>{1});
}

TEST(Server, ForgetsTheAnswerForAClientThatDiedMeanwhile) {
  ServedSocket served;
  {
    auto client = served.client();
    ASSERT_TRUE(client.send(R"({"jsonrpc":"2.0","id":7,"method":"component.start",)"
                            R"("params":{"components":["a"]}})"
                            "\n"));
    ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == 1; }));
  }

  served.dispatcher.answer_all();

  auto other = served.client();
  EXPECT_EQ(other.ask("ping")["result"]["pong"], true);
}

TEST(Server, GivesClientsTheirLastAnswersWhenItStops) {
  ServedSocket served;
  auto client = served.client();
  ASSERT_TRUE(client.send(R"({"jsonrpc":"2.0","id":7,"method":"status"})"
                          "\n"));
  ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == 1; }));
  std::thread stopper([&] { served.server->stop(std::chrono::seconds(10)); });

  served.dispatcher.answer_all();

  EXPECT_EQ(client.json()["id"], 7);
  EXPECT_TRUE(client.closed_by_peer());
  stopper.join();
  EXPECT_FALSE(RawClient(served.path()).connected());
}

TEST(Server, ClosesTheRestWhenTheGraceIsOver) {
  ServedSocket served;
  auto client = served.client();
  ASSERT_TRUE(client.send(R"({"jsonrpc":"2.0","id":7,"method":"status"})"
                          "\n"));
  ASSERT_TRUE(eventually([&] { return served.dispatcher.kept() == 1; }));

  served.server->stop(milliseconds(30));

  EXPECT_TRUE(client.closed_by_peer());
}

TEST(Server, KnowsAGroupThatWasMadeAfterItsStart) {
  if (geteuid() != 0) GTEST_SKIP() << "NOT TESTED: needs root, for a client of another user";
  server::RoleRules later;
  later.viewers = getegid();
  ServedSocket served({}, {}, [later] { return later; });
  std::filesystem::permissions(served.path().parent_path(), std::filesystem::perms::all);
  std::filesystem::permissions(served.path(), std::filesystem::perms::all);

  ASSERT_EQ(seteuid(50'001), 0);
  RawClient client(served.path());
  ASSERT_EQ(seteuid(0), 0);

  EXPECT_EQ(client.json()["params"]["role"], "viewer");
}

TEST(Server, GivesAnAdminTheSlotOfTheOldestViewerWhenAllAreInUse) {
  if (geteuid() != 0) GTEST_SKIP() << "NOT TESTED: needs root, for clients of another user";
  server::Limits limits;
  limits.clients = 2;
  limits.reserved_for_root = 0;
  server::RoleRules rules;
  rules.viewers = getegid();
  ServedSocket served(limits, rules);
  const auto viewer = [&] {
    std::filesystem::permissions(served.path().parent_path(), std::filesystem::perms::all);
    std::filesystem::permissions(served.path(), std::filesystem::perms::all);
    EXPECT_EQ(seteuid(50'001), 0);
    RawClient client(served.path());
    EXPECT_EQ(seteuid(0), 0);
    EXPECT_EQ(client.json()["params"]["role"], "viewer");
    return client;
  };
  auto oldest = viewer();
  auto other = viewer();

  auto admin = served.client();

  EXPECT_EQ(admin.ask("ping")["result"]["pong"], true);
  EXPECT_TRUE(oldest.closed_by_peer());
  EXPECT_EQ(other.ask("ping")["result"]["pong"], true);
  EXPECT_THAT(served.log_text(), testing::HasSubstr("a client of role admin got this one"));
}

TEST(Server, WritesTwentyRefusedConnectionsOfAUserASecondAndCountsTheOthers) {
  if (geteuid() != 0) GTEST_SKIP() << "NOT TESTED: needs root, for a client of another user";
  constexpr std::int64_t kRefused = 300;
  ServedSocket served;
  std::filesystem::permissions(served.path().parent_path(), std::filesystem::perms::all);
  std::filesystem::permissions(served.path(), std::filesystem::perms::all);
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(seteuid(50'001), 0) << "a user without a role";
  for (int i = 0; i < kRefused; ++i) {
    RawClient client(served.path());
    EXPECT_EQ(client.json()["error"]["data"]["name"], "not_permitted");
  }
  ASSERT_EQ(seteuid(0), 0);

  std::int64_t written = 0;
  std::int64_t counted = 0;
  EXPECT_TRUE(eventually([&] {
    written = counted = 0;
    for (const auto& record : served.log.history().tail(1000, {})) {
      written += record.event == logging::Event::client_refused ? 1 : 0;
      if (record.event != logging::Event::clients_refused) continue;
      for (const auto& field : record.fields) {
        if (field.name == "count") counted += std::get<std::int64_t>(field.value);
      }
    }
    return written + counted == kRefused;
  })) << written
      << " written, " << counted << " counted";
  const auto seconds =
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::steady_clock::now() - begin);
  EXPECT_LE(written, 20 * (seconds.count() + 1));
}

TEST(Server, ListsItsClients) {
  ServedSocket served;
  auto client = served.client();
  EXPECT_EQ(client.ask("ping")["result"]["pong"], true);

  const auto clients = served.server->clients();

  ASSERT_EQ(clients.size(), 1U);
  EXPECT_EQ(clients[0].peer.uid, geteuid());
  EXPECT_EQ(clients[0].peer.pid, getpid());
  EXPECT_EQ(clients[0].role, server::Role::admin);
}

}  // namespace
}  // namespace mauve::test
