// SPDX-License-Identifier: LGPL-3.0-or-later
// Clients that do everything wrong. The server stays up, serves others, and stays small.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <random>
#include <vector>

#include "fake_dispatcher.h"
#include "support/eventually.h"

namespace mauve::test {
namespace {

/// The [log] thread writes a little later than the event.
bool logs(ServedSocket& served, std::string_view words) {
  return eventually([&] { return served.log_text().find(words) != std::string::npos; });
}

using protocol::Json;
using std::chrono::milliseconds;

constexpr std::string_view kPing = R"({"jsonrpc":"2.0","id":1,"method":"ping"})"
                                   "\n";

server::Limits impatient() {
  server::Limits limits;
  limits.first_byte = milliseconds(60);
  limits.idle = milliseconds(60);
  limits.half_request = milliseconds(60);
  limits.stalled = milliseconds(60);
  return limits;
}

bool serves_others(ServedSocket& served) {
  auto client = served.client();
  return client.ask("ping")["result"]["pong"] == true;
}

/// A request that nests this deeply: the envelope, params, arrays.
std::string nested(std::size_t depth) {
  const auto arrays = depth - 2;
  return R"({"jsonrpc":"2.0","id":1,"method":"param.set","params":{"values":)" +
         std::string(arrays, '[') + std::string(arrays, ']') + "}}\n";
}

TEST(HostileClient, SendsMoreValuesThanAnybodyNeeds) {
  ServedSocket served;
  auto client = served.client();
  std::string numbers = "1";
  for (std::size_t i = 0; i < protocol::kMaxValues; ++i) numbers += ",1";
  ASSERT_TRUE(client.send(R"({"jsonrpc":"2.0","id":1,"method":"param.set","params":{"values":[)" +
                          numbers + "]}}\n"));

  const auto answer = client.json();
  EXPECT_EQ(answer["error"]["code"], -32700);
  EXPECT_EQ(answer["error"]["message"], "has more than 20000 values");
  EXPECT_TRUE(serves_others(served));
}

TEST(HostileClient, SendsRandomBytes) {
  ServedSocket served;
  std::mt19937 random(42);
  std::uniform_int_distribution<int> byte(0, 255);
  for (int round = 0; round < 50; ++round) {
    auto client = served.client();
    std::string noise(2000, ' ');
    std::generate(noise.begin(), noise.end(), [&] { return static_cast<char>(byte(random)); });
    static_cast<void>(client.send(noise + "\n"));
    EXPECT_EQ(client.json()["error"]["code"], -32700);
  }

  EXPECT_TRUE(serves_others(served));
}

TEST(HostileClient, SendsTenThousandBadRequests) {
  ServedSocket served;
  auto client = served.client();
  const std::vector<std::string> bad = {"[]\n",
                                        "{}\n",
                                        "null\n",
                                        "{\"jsonrpc\":\"2.0\"}\n",
                                        "\"\n",
                                        "{\"a\":1,\"a\":2}\n",
                                        R"({"jsonrpc":"2.0","id":1,"method":"nothing"})"
                                        "\n",
                                        "\xff\xfe\n",
                                        "[[]]\n",
                                        "1e999\n"};
  for (int round = 0; round < 1000; ++round) {
    std::string all;
    for (const auto& one : bad) {
      all += one;
    }
    ASSERT_TRUE(client.send(all));
    for (std::size_t i = 0; i < bad.size(); ++i) {
      ASSERT_TRUE(client.json().contains("error"));
    }
  }

  EXPECT_EQ(client.ask("ping")["result"]["pong"], true);
  EXPECT_EQ(served.dispatcher.served(), 1U);
}

TEST(HostileClient, SendsByteAfterByte) {
  ServedSocket served;
  auto client = served.client();

  for (const char c : kPing) {
    ASSERT_TRUE(client.send({&c, 1}));
  }

  EXPECT_EQ(client.json()["result"]["pong"], true);
}

TEST(HostileClient, SendsALineBeyondTheLimit) {
  ServedSocket served;
  auto client = served.client();

  static_cast<void>(client.send(std::string(protocol::kMaxLine + 100, 'x')));

  EXPECT_EQ(client.json()["error"]["code"], -32700);
  EXPECT_TRUE(client.closed_by_peer());
  EXPECT_TRUE(serves_others(served));
}

TEST(HostileClient, GetsTheAnswersBeforeAnOverlongLine) {
  ServedSocket served;
  auto client = served.client();

  static_cast<void>(client.send(std::string(kPing) + std::string(protocol::kMaxLine + 100, 'x')));

  EXPECT_EQ(client.json()["result"]["pong"], true);
  EXPECT_EQ(client.json()["error"]["code"], -32700);
}

TEST(HostileClient, SendsALineOfExactlyTheLimit) {
  ServedSocket served;
  auto client = served.client();
  std::string line = R"({"jsonrpc":"2.0","id":1,"method":"ping"})";
  line += std::string(protocol::kMaxLine - line.size(), ' ');

  ASSERT_TRUE(client.send(line + "\n"));

  EXPECT_EQ(client.json()["result"]["pong"], true);
}

TEST(HostileClient, NestsTooDeeply) {
  ServedSocket served;
  auto client = served.client();

  ASSERT_TRUE(client.send(nested(32)));
  ASSERT_TRUE(client.send(nested(33)));
  ASSERT_TRUE(client.send(std::string(100'000, '[') + "\n"));

  EXPECT_EQ(client.json()["error"]["code"], -32602);  // deep enough, but not an object
  EXPECT_EQ(client.json()["error"]["code"], -32700);
  EXPECT_EQ(client.json()["error"]["code"], -32700);
}

TEST(HostileClient, SaysNothingAtAll) {
  ServedSocket served(impatient());
  RawClient client(served.path());

  EXPECT_TRUE(client.closed_by_peer());
  EXPECT_TRUE(logs(served, "silent from the start"));
}

TEST(HostileClient, SendsHalfARequest) {
  ServedSocket served(impatient());
  RawClient client(served.path());
  ASSERT_TRUE(client.send(kPing.substr(0, 20)));

  EXPECT_TRUE(client.closed_by_peer());
  EXPECT_TRUE(logs(served, "half a request"));
}

TEST(HostileClient, EndsItsInputWithALineThatHasNoEnd) {
  ServedSocket served;
  for (const std::string_view line : {kPing.substr(0, kPing.find('\n')), kPing.substr(0, 20)}) {
    RawClient client(served.path());
    ASSERT_TRUE(client.json().contains("params")) << "the greeting";
    ASSERT_TRUE(client.send(line));
    client.half_close();

    const auto answer = client.json();

    EXPECT_EQ(answer.contains("result"), line.ends_with('}')) << answer;
    EXPECT_EQ(answer.contains("error"), !line.ends_with('}')) << answer;
    EXPECT_TRUE(client.closed_by_peer());
  }
}

TEST(HostileClient, DripsBytesWithoutEverEndingALine) {
  ServedSocket served(impatient());
  RawClient client(served.path());

  EXPECT_TRUE(eventually([&] { return !client.send("x"); }));
  EXPECT_TRUE(logs(served, "half a request"));
}

TEST(HostileClient, StaysConnectedForNothing) {
  ServedSocket served(impatient());
  auto client = served.client();
  EXPECT_EQ(client.ask("ping")["result"]["pong"], true);

  EXPECT_TRUE(client.closed_by_peer());
  EXPECT_TRUE(logs(served, "idle"));
}

TEST(HostileClient, IsNotIdleWhileItWaitsOrWatches) {
  ServedSocket served(impatient());
  auto waiting = served.client();
  ASSERT_TRUE(waiting.send(R"({"jsonrpc":"2.0","id":7,"method":"status"})"
                           "\n"));
  auto watching = served.client();
  EXPECT_EQ(watching.ask("watch.subscribe", {{"addresses", {"a"}}})["result"]["sub"], 1);
  auto idle = served.client();
  EXPECT_EQ(idle.ask("ping")["result"]["pong"], true);

  EXPECT_TRUE(idle.closed_by_peer());

  EXPECT_TRUE(eventually([&] { return served.server->clients().size() == 2; }));
}

TEST(HostileClient, AsksWithoutReadingTheAnswers) {
  ServedSocket served(impatient());
  served.dispatcher.big_answer = 100'000;
  auto client = served.client();
  const std::string request = R"({"jsonrpc":"2.0","id":1,"method":"config.get"})"
                              "\n";

  EXPECT_TRUE(eventually([&] {
    static_cast<void>(client.send_some(request));
    return served.server->clients().empty();
  }));

  EXPECT_TRUE(logs(served, "does not read"));
  EXPECT_TRUE(serves_others(served));
}

TEST(HostileClient, WatchesWithoutReading) {
  ServedSocket served(impatient());
  auto client = served.client();
  const auto sub = client.ask("watch.subscribe", {{"addresses", {"a"}}})["result"]["sub"];
  const auto outbox = served.dispatcher.outbox(0);
  auto other = served.client();
  const auto other_sub = other.ask("watch.subscribe", {{"addresses", {"a"}}})["result"]["sub"];

  std::size_t most = 0;
  std::uint64_t pushed = 0;
  while (outbox->push(sub, "a", "value",
                      protocol::NotificationText(Json{{"value", std::string(1000, 'x')}}))) {
    most = std::max(most, outbox->bytes());
    if (++pushed % 100 == 0) {
      ASSERT_TRUE(served.dispatcher.outbox(1)->push(
          other_sub, "a", "value", protocol::NotificationText(Json{{"value", pushed}})));
      EXPECT_EQ(other.notification("value")["params"]["value"], pushed);
    }
  }

  EXPECT_LT(most, 300U * 1024);
  EXPECT_TRUE(logs(served, "does not read"));
}

TEST(HostileClient, LearnsHowManyNotificationsItWasTooSlowFor) {
  ServedSocket served;
  auto client = served.client();
  const auto sub = client.ask("watch.subscribe", {{"addresses", {"a"}}})["result"]["sub"];
  const auto outbox = served.dispatcher.outbox(0);
  std::uint64_t pushed = 0;
  while (outbox->dropped() < 10) {
    ASSERT_TRUE(outbox->push(sub, "a", "value",
                             protocol::NotificationText(Json{{"value", std::string(1000, 'x')}})));
    ++pushed;
  }

  std::uint64_t seen = 0;
  std::uint64_t dropped = 0;
  while (seen + dropped < pushed) {
    const auto message = client.json();
    ASSERT_FALSE(message.is_null());
    if (message["method"] == "dropped") {
      EXPECT_EQ(message["params"]["address"], "a");
      dropped += message["params"]["count"].get<std::uint64_t>();
    } else {
      ++seen;
    }
  }

  EXPECT_EQ(dropped, outbox->dropped());
}

TEST(HostileClient, IsKilledInTheMiddleOfARequest) {
  ServedSocket served;
  for (int i = 0; i < 20; ++i) {
    RawClient client(served.path());
    constexpr std::string_view half = kPing.substr(0, 15);
    const auto child = fork();
    if (child == 0) {  // only system calls: a thread of the parent may have held any lock
      static_cast<void>(client.send(kPing));
      static_cast<void>(client.send(half));
      kill(getpid(), SIGKILL);
    }
    client.close();
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
  }

  EXPECT_TRUE(eventually([&] { return served.server->clients().empty(); }));
  EXPECT_TRUE(serves_others(served));
}

TEST(HostileClient, ConnectsFiftyTimes) {
  ServedSocket served;
  // One more for root; then those that may only stop.
  const std::size_t allowed = (geteuid() == 0 ? 9U : 8U) + 32;
  std::vector<RawClient> clients;
  for (std::size_t i = 0; i < 50; ++i) {
    clients.emplace_back(served.path());
    const auto first = clients.back().json();
    ASSERT_EQ(first.contains("params"), i < allowed) << i << ": " << first;
  }

  EXPECT_EQ(served.server->clients().size(), allowed);
  EXPECT_EQ(clients.front().ask("ping")["result"]["pong"], true) << "it keeps its place";
  EXPECT_EQ(clients[allowed - 1].ask("ping")["result"]["pong"], true) << "and so does the last";
  clients.clear();
  ASSERT_TRUE(eventually([&] { return served.server->clients().empty(); }));
  EXPECT_TRUE(serves_others(served));
}

TEST(HostileClient, FiveHundredConnectAndGo) {
  ServedSocket served;
  for (int i = 0; i < 500; ++i) {
    RawClient client(served.path());
  }

  ASSERT_TRUE(eventually([&] { return served.server->clients().empty(); }));
  EXPECT_TRUE(serves_others(served));
}

TEST(HostileClient, CannotExhaustTheDescriptors) {
#if defined(MAUVE_SANITIZE_ADDRESS_UNDEFINED)
  GTEST_SKIP() << "NOT TESTED: the sanitizer needs a descriptor of its own to look at an object";
#endif
  ServedSocket served;
  RawClient waiting(served.path());
  ASSERT_FALSE(waiting.json().is_null());
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  // The next descriptor of the process is the client's own, and none is left for the server.
  const int next_fd = dup(0);
  close(next_fd);
  rlimit tight = before;
  tight.rlim_cur = static_cast<rlim_t>(next_fd) + 1;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &tight), 0);

  RawClient late(served.path());
  EXPECT_TRUE(late.connected());
  ASSERT_TRUE(logs(served, "no descriptor left"));
  EXPECT_EQ(waiting.ask("ping")["result"]["pong"], true);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);

  EXPECT_EQ(late.json()["method"], "hello");
  EXPECT_TRUE(logs(served, "may do all again"));
}

}  // namespace
}  // namespace mauve::test
