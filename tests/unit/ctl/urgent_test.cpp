// SPDX-License-Identifier: LGPL-3.0-or-later
// A stop, confirm or undo of mauvectl finds its way where clients, and mauved, are in trouble.
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

const Json kStopReceipt = Json::parse(R"({"generation": 42, "changed": true, "state": "applied",
  "commit": 7, "attempts": 1, "components":
  [{"name": "control", "pause_ns": 38, "missed": 0, "bytes": 0}]})");

std::string turned_away(const std::string& why) {
  return protocol::to_line(protocol::make_error(
             nullptr,
             protocol::fault_of(refuse({Errc::limit, "too_many_clients"}, "uid 7", why)))) +
         "\n";
}

/// Answers the second request that it hears; `instead` of an answer to the first one.
FakeServer::Script second_time(int& heard, std::string instead) {
  return [&heard, instead = std::move(instead)](Peer& peer) {
    peer.say(kHello);
    const auto request = peer.hear();
    if (request.id.is_null()) return;  // it only looked whether somebody listens
    if (++heard == 1) return peer.say(instead);
    peer.answer(request, kStopReceipt);
    peer.wait_for_the_end();
  };
}

TEST(Stop, IsSentAgainWhenItsAnswerIsLost) {
  int heard = 0;
  FakeServer server(second_time(heard, {}), 3);

  const Outcome outcome = run(server.path(), {"stop", "a"});

  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_EQ(heard, 2);
}

TEST(Stop, IsSentAgainWhenItsPlaceWentToAnother) {
  for (const char* command : {"stop", "confirm", "undo"}) {
    int heard = 0;
    FakeServer server(second_time(heard, turned_away("another client got this place")), 2);
    std::vector<std::string> words{command};
    if (words[0] == "stop") words.emplace_back("a");

    EXPECT_EQ(run(server.path(), words).exit, 0) << command;

    EXPECT_EQ(heard, 2) << command;
  }
}

TEST(Stop, ComesAgainWhenItIsNotLetIn) {
  int came = 0;
  FakeServer server(
      [&](Peer& peer) {
        if (++came < 4) return peer.say(turned_away("as many stops as are served are under way"));
        peer.say(kHello);
        peer.answer(peer.hear(), kStopReceipt);
        peer.wait_for_the_end();
      },
      4);

  EXPECT_EQ(run(server.path(), {"stop", "--all"}).exit, 0);
}

TEST(Stop, GivesUpWhenItsTimeIsOver) {
  FakeServer server([](Peer& peer) { peer.say(turned_away("nobody gets in")); }, 1);

  const Outcome outcome =
      run(server.path(), {"stop", "--all", "--timeout", "1ms", "--wait", "60s"});

  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.err, testing::HasSubstr("nobody gets in"));
}

TEST(Stop, GoesToTheSocketOfStopsFirst) {
  for (const char* command : {"stop", "confirm", "undo"}) {
    FakeServer server(
        [](Peer& peer) {
          peer.say(kHello);
          peer.answer(peer.hear(), kStopReceipt);
          peer.wait_for_the_end();
        },
        1, "s.stop");
    std::vector<std::string> words{command};
    if (words[0] == "stop") words.emplace_back("a");
    const auto ordinary = server.path().substr(0, server.path().size() - 5);

    EXPECT_EQ(run(ordinary, words).exit, 0) << command;
  }
}

TEST(Undo, IsNotSentAgainWhenItsAnswerIsLost) {
  int heard = 0;
  FakeServer server(second_time(heard, {}), 2);

  const Outcome outcome = run(server.path(), {"undo"});

  EXPECT_EQ(outcome.exit, 7);
  EXPECT_THAT(outcome.err, testing::HasSubstr("mauved runs, but closed this connection"));
  EXPECT_EQ(heard, 1) << "a second one would undo one more change";
}

TEST(Watch, SaysWhyItLostItsPlace) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    peer.answer(peer.hear(), {{"sub", 5}});
    peer.say(turned_away("a client of role admin got this one"));
  });

  const Outcome outcome = run(server.path(), {"watch", "fix.read"});

  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.err, testing::HasSubstr("a client of role admin got this one"));
}

}  // namespace
}  // namespace mauve::ctl
