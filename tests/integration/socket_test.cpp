// SPDX-License-Identifier: LGPL-3.0-or-later
// The admin socket of the real daemon: what it answers, what it refuses, who has to wait.
#include <sys/stat.h>

#include <random>

#include "support/crowd.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

TEST(Socket, GreetsWithGenerationRoleAndLimits) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());

  RawClient client(daemon.socket());
  const auto hello = client.json()["params"];

  EXPECT_THAT(hello["server"].get<std::string>(), HasSubstr("mauved"));
  EXPECT_EQ(hello["protocol"], Json({1}));
  EXPECT_EQ(hello["generation"], 1);
  EXPECT_EQ(hello["role"], "admin");
  EXPECT_EQ(hello["boot"], daemon.ask("version")["boot"]);
}

TEST(Socket, IsForOwnerAndGroup) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  struct stat status {};

  ASSERT_EQ(stat(daemon.socket().c_str(), &status), 0);

  EXPECT_EQ(status.st_mode & 07777U, 0660U);
}

TEST(Socket, AnswersAClientThatSendsOneLineAndClosesItsSide) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  RawClient client(daemon.socket());

  ASSERT_TRUE(client.send(R"({"jsonrpc":"2.0","id":1,"method":"status"})"
                          "\n"));
  client.half_close();

  EXPECT_EQ(client.json()["method"], "hello");
  const auto status = client.json()["result"];
  EXPECT_EQ(status["architecture"], "trial");
  EXPECT_EQ(status["components"].size(), 2U);
  EXPECT_TRUE(client.closed_by_peer());
}

TEST(Socket, AnswersStatusInTheFormThatIsPromised) {
  TrialDaemon daemon;

  const auto status = daemon.ask("status.get");

  EXPECT_EQ(status["generation"], 1);
  ASSERT_EQ(status["components"].size(), 2U);
  for (const auto& row : status["components"]) {
    for (const auto* key : {"name", "type", "core", "fsm_state", "state", "priority", "releases",
                            "missed", "overruns"}) {
      EXPECT_TRUE(row.contains(key)) << key;
    }
  }
}

TEST(Socket, ServesEveryReadingMethod) {
  TrialDaemon daemon;
  auto client = daemon.client();
  for (const auto* method :
       {"ping", "version", "status.get", "component.list", "resource.list", "core.list",
        "service.list", "fsm.list", "type.list", "port.list", "plugin.list", "client.list",
        "command.list", "config.get", "log.tail"}) {
    EXPECT_TRUE(client.ask(method).contains("result")) << method;
  }
  for (const auto* address : {"first", "signal", "first.core.gain", "first.core.count",
                              "first.ports.output", "signal.read"}) {
    const auto shown = client.ask("object.get", {{"address", address}});
    EXPECT_EQ(shown["result"]["address"], address) << shown;
    EXPECT_FALSE(shown["result"]["kind"].get<std::string>().empty());
  }
  const auto cores = client.ask("core.list", {{"for", "first"}})["result"]["items"];
  EXPECT_EQ(cores.size(), 32U) << "a new core in trial.cpp that fits raises this number: " << cores;
}

TEST(Socket, RefusesBadRequestsAndChangesNothing) {
  TrialDaemon daemon;
  auto client = daemon.client();
  const std::vector<std::pair<std::string, int>> bad = {
      {"hello?", -32700},
      {R"({"jsonrpc":"2.0","id":1,"id":2,"method":"ping"})", -32700},
      {R"({"jsonrpc":"2.0","id":1,"method":"ping","params":{"x":NaN}})", -32700},
      {R"({"jsonrpc":"2.0","method":"ping"})", -32600},
      {R"([{"jsonrpc":"2.0","id":1,"method":"ping"}])", -32600},
      {R"({"jsonrpc":"2.0","id":1,"method":"pign"})", -32601},
      {R"({"jsonrpc":"2.0","id":1,"method":"ping","params":{"x":1}})", -32602},
      {R"({"jsonrpc":"2.0","id":1,"method":"core.swap","params":{"component":"first"}})", -32602},
      {R"({"jsonrpc":"2.0","id":1,"method":"param.get","params":{"address":7}})", -32602},
      {R"({"jsonrpc":"2.0","id":1,"method":"param.get","params":{"address":""}})", -32012},
      {R"({"jsonrpc":"2.0","id":1,"method":"param.get","params":{"address":"a.b.c.d"}})", -32012},
      {R"({"jsonrpc":"2.0","id":1,"method":"param.set","params":{"values":{}}})", -32011},
      {R"({"jsonrpc":"2.0","id":1,"method":"component.stop"})", -32011},
      {R"({"jsonrpc":"2.0","id":1,"method":"plugin.load","params":{"plugin":"../evil"}})", -32011},
      {R"({"jsonrpc":"2.0","id":1,"method":"plugin.load","params":{"plugin":"nothere"}})", -32019},
      {R"({"jsonrpc":"2.0","id":1,"method":"plugin.load","params":{"plugin":"trial"}})", -32013},
      {R"({"jsonrpc":"2.0","id":1,"method":"plugin.unload","params":{"plugin":"trial"}})", -32015},
      {R"({"jsonrpc":"2.0","id":1,"method":"watch.unsubscribe","params":{"sub":9}})", -32012},
      {R"({"jsonrpc":"2.0","id":1,"method":"watch.subscribe","params":{"addresses":[]}})", -32023},
      {R"({"jsonrpc":"2.0","id":1,"method":"log.tail","params":{"level":"loud"}})", -32602},
      {R"({"jsonrpc":"2.0","id":1,"method":"lock.set","params":{"lock":"some"}})", -32602},
  };
  for (const auto& [line, code] : bad) {
    ASSERT_TRUE(client.send(line + "\n"));
    const auto answer = client.json();
    EXPECT_EQ(answer["error"]["code"], code) << line << answer;
    EXPECT_EQ(answer["error"]["data"]["state"], "unchanged") << line;
  }

  EXPECT_EQ(daemon.ask("status.get")["generation"], 1);
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Socket, ChecksAFileAndReportsAllItsErrorsWithTheirPlace) {
  TrialDaemon daemon;

  const auto good = daemon.ask("config.check", {{"text", kTrial}});
  EXPECT_EQ(good["errors"], Json::array()) << good;

  const auto bad = daemon.ask("config.check", {{"text", R"({
    "schema": "mauve/architecture/1", "name": "bad", "plugins": ["trial"],
    "components": {
      "a": { "type": "trial/unti" },
      "b": { "type": "trial/unit", "properties": { "core.gain": 11 } }
    } })"}})["errors"];
  ASSERT_EQ(bad.size(), 2U) << bad;
  EXPECT_EQ(bad[0]["line"], 4);
  EXPECT_THAT(bad[0]["hint"].get<std::string>(), HasSubstr("trial/unit"));
  EXPECT_EQ(bad[1]["at"], "b.core.gain");
  EXPECT_EQ(bad[1]["line"], 5);
}

TEST(Socket, SurvivesRandomBytesFromManyClients) {
  TrialDaemon daemon;
  auto steady = daemon.client();
  std::mt19937 random(7);
  std::uniform_int_distribution<int> byte(0, 255);
  for (int round = 0; round < 100; ++round) {
    RawClient hostile(daemon.socket());
    std::string noise(500, ' ');
    for (auto& c : noise) {
      c = static_cast<char>(byte(random));
    }
    static_cast<void>(hostile.send(noise + (round % 2 == 0 ? "\n" : "")));
  }

  EXPECT_EQ(steady.ask("ping")["result"]["pong"], true);
}

TEST(Watch, ShowsEveryValueThatIsWritten) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/counting"}})["state"],
            "applied");
  auto client = daemon.client();
  ASSERT_TRUE(client.ask("watch.subscribe", {{"addresses", {"signal.read"}}}).contains("result"));

  double before = 0;
  std::int64_t time_before = 0;
  int counts = 0;
  for (int i = 0; i < 100; ++i) {
    const auto params = client.notification("value")["params"];
    EXPECT_EQ(params["address"], "signal.read");
    EXPECT_EQ(params["status"], "new_data");
    const auto value = params["value"].get<double>();
    const auto time = params["t_ns"].get<std::int64_t>();
    // Steady's own write, the gain, comes in between.
    if (value != 1.0) {
      EXPECT_TRUE(before == 0 || value == before + 1) << before << " " << value;
      EXPECT_GT(time, time_before);
      before = value;
      time_before = time;
      ++counts;
    }
  }
  EXPECT_GT(counts, 40) << "every other value is one";
}

TEST(Watch, ShowsPropertiesAndObservablesWhenTheyChange) {
  TrialDaemon daemon;
  auto client = daemon.client();
  ASSERT_TRUE(
      client.ask("watch.subscribe", {{"addresses", {"first.core.gain", "second.ports.input"}}})
          .contains("result"));
  EXPECT_EQ(client.notification("value")["params"]["value"], 1.0);

  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"first.core.gain", 4}}}})["state"], "applied");

  Json seen;
  while (seen != 4.0) {
    const auto message = client.notification("value");
    ASSERT_FALSE(message.is_null());
    if (message["params"]["address"] == "first.core.gain") {
      seen = message["params"]["value"];
    }
  }
}

TEST(Watch, SendsAValueAgainOnlyWhenItChanged) {
  constexpr int kCounts = 10;
  TrialDaemon daemon;
  auto client = daemon.client();
  const Json both = {{"addresses", {"first.core.gain", "first.core.count"}}};
  ASSERT_TRUE(client.ask("watch.subscribe", both).contains("result"));

  int gains = 0;
  for (int counts = 0; counts < kCounts && gains < kCounts;) {
    const auto message = client.notification("value");
    ASSERT_FALSE(message.is_null());
    ++(message["params"]["address"] == "first.core.count" ? counts : gains);
  }

  EXPECT_LE(gains, 1) << "each look that found a new count found the gain as it was";
}

TEST(Watch, EndsWhenItIsUnsubscribed) {
  TrialDaemon daemon;
  auto client = daemon.client();
  const auto sub = client.ask("watch.subscribe", {{"addresses", {"signal.read"}}})["result"]["sub"];
  ASSERT_FALSE(client.notification("value").is_null());

  EXPECT_TRUE(client.ask("watch.unsubscribe", {{"sub", sub}}).contains("result"));

  EXPECT_TRUE(client.ask("ping").contains("result"));
  EXPECT_FALSE(client.line(std::chrono::milliseconds(100)).has_value());
}

TEST(Watch, RefusesAllAddressesWhenOneIsWrong) {
  TrialDaemon daemon;

  const auto error = daemon.ask("watch.subscribe", {{"addresses", {"signal.read", "sgnal.read"}}});

  EXPECT_EQ(error["data"]["name"], "unknown_name");
}

TEST(Watch, DoesNotLetAReaderThatStoppedDisturbAnyone) {
  TrialDaemon daemon;
  std::vector<RawClient> stopped;
  for (int i = 0; i < 4; ++i) {
    stopped.push_back(daemon.client());
    ASSERT_TRUE(stopped.back()
                    .ask("watch.subscribe", {{"addresses", {"signal.read", "first.core.count"}}})
                    .contains("result"));
  }
  const auto before = daemon.component("first")["releases"].get<int>();

  ASSERT_TRUE(
      eventually([&] { return daemon.component("first")["releases"].get<int>() > before + 500; }));
}

TEST(Log, IsFollowed) {
  TrialDaemon daemon;
  auto client = daemon.client();
  ASSERT_TRUE(eventually([&] { return daemon.ask("log.tail")["records"].size() >= 2; }));
  const auto tail = client.ask("log.tail", {{"follow", true}, {"n", 2}})["result"];
  EXPECT_EQ(tail["records"].size(), 2U);
  EXPECT_GT(tail["sub"], 0);

  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"second"}}})["state"], "applied");

  Json record;
  while (record["event"] != "change_applied") {
    const auto message = client.notification("log");
    ASSERT_FALSE(message.is_null());
    record = message["params"];
  }
  EXPECT_THAT(record["text"].get<std::string>(), HasSubstr("component.stop"));
  EXPECT_EQ(record["fields"]["uid"], geteuid());
}

TEST(Socket, OfRootBelongsToTheGroupOfOperators) {
  if (!Crowd::possible()) GTEST_SKIP() << "SKIPPED: needs root and the right to mount";
  const TempDir place;
  const Crowd crowd(place.path(), MAUVE_BIN_DIR "/mauved", "mauve:x:50999:\n");
  TrialDaemon daemon(kTrial, {"--realtime", "off"}, crowd.program());
  static_cast<void>(daemon.client());
  struct stat status {};

  ASSERT_EQ(stat(daemon.socket().c_str(), &status), 0);

  EXPECT_EQ(status.st_gid, 50999U);
}

}  // namespace
}  // namespace mauve::test
