// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/turns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/post.hpp>
#include <string>
#include <vector>

#include "fake_dispatcher.h"

namespace mauve::test {
namespace {

using testing::ElementsAre;

TEST(Turns, LetWhatIsReadyRunBetweenTwoPieces) {
  boost::asio::io_context io(1);
  server::Turns turns(io);
  std::vector<std::string> order;
  const auto ready = [&](const char* name) {
    boost::asio::post(io, [&order, name] { order.emplace_back(name); });
  };
  turns.take([&] {
    order.emplace_back("first");
    ready("stop");
  });
  turns.take([&] {
    order.emplace_back("second");
    turns.take([&] { order.emplace_back("fourth"); });
    ready("other stop");
  });
  turns.take([&] { order.emplace_back("third"); });

  io.run();

  EXPECT_THAT(order, ElementsAre("first", "stop", "second", "other stop", "third", "fourth"));
}

/// Longer than what is served at once.
std::string long_request(int id) {
  return R"({"jsonrpc":"2.0","id":)" + std::to_string(id) + R"(,"method":"ping","params":{"x":")" +
         std::string(100'000, 'x') + "\"}}\n";
}

TEST(Turns, KeepTheOrderOfTheRequestsOfOneClient) {
  ServedSocket served;
  auto client = served.client();
  std::string lines;
  for (int id = 0; id < 40; ++id) {
    lines += id % 3 == 0 ? long_request(id)
                         : R"({"jsonrpc":"2.0","id":)" + std::to_string(id) +
                               R"(,"method":"nothing"})"
                               "\n";
  }
  ASSERT_TRUE(client.send(lines));

  for (int id = 0; id < 40; ++id) {
    EXPECT_EQ(client.json()["id"], id);
  }
}

TEST(Turns, AreAwaitedByAClientThatHasClosedItsSendingSide) {
  ServedSocket served;
  auto client = served.client();
  ASSERT_TRUE(client.send(long_request(1) + long_request(2)));
  client.half_close();

  EXPECT_EQ(client.json()["id"], 1);
  EXPECT_EQ(client.json()["id"], 2);
}

TEST(Turns, ThatNoThreadTakesUpAnyMoreKeepNoServerFromEnding) {
  ServedSocket served;
  std::vector<RawClient> clients;
  for (int i = 0; i < 4; ++i) {
    clients.push_back(served.client());
    ASSERT_TRUE(clients.back().send(long_request(i) + long_request(i)));
  }

  served.server.reset();

  EXPECT_LE(served.dispatcher.served(), 8U);
}

}  // namespace
}  // namespace mauve::test
