// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/client.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temp_dir.h"
#include "unit/ctl/fake_server.h"

namespace mauve::ctl {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::nanoseconds kPatient = 20s;
constexpr std::chrono::nanoseconds kImpatient = 50ms;

Fault fault_of_call(FakeServer& server, std::string_view method,
                    std::chrono::nanoseconds timeout = kPatient) {
  Client client(server.path(), kPatient);
  const auto refused = client.connect();
  EXPECT_FALSE(refused) << refused->message;
  auto answer = client.call(method, Json::object(), timeout);
  if (auto* fault = std::get_if<Fault>(&answer)) return std::move(*fault);
  ADD_FAILURE() << "answered";
  return {};
}

TEST(Client, AsksAndGetsItsAnswer) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    const auto request = peer.hear();
    peer.answer(request, {{"method", request.method}, {"address", request.params["address"]}});
    peer.wait_for_the_end();
  });
  Client client(server.path(), kPatient);

  ASSERT_FALSE(client.connect());
  const auto answer = client.call("param.get", {{"address", "a.b"}}, kPatient);

  EXPECT_EQ(client.greeting()["generation"], 41);
  EXPECT_EQ(std::get<Json>(answer), (Json{{"method", "param.get"}, {"address", "a.b"}}));
}

TEST(Client, WaitsForRoomInTheQueueOfTheSocket) {
  const test::TempDir folder;
  const std::string path = folder / "s";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(bind(listener, generic, sizeof address), 0);
  ASSERT_EQ(listen(listener, 0), 0);
  std::vector<int> queued;
  do {
    queued.push_back(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  } while (connect(queued.back(), generic, sizeof address) == 0);
  ASSERT_EQ(errno, EAGAIN);
  std::thread server([&] {
    std::this_thread::sleep_for(20ms);
    for (std::size_t i = 0; i < queued.size(); ++i) {
      queued[i] = accept(listener, nullptr, nullptr);
      EXPECT_EQ(send(queued[i], kHello.data(), kHello.size(), MSG_NOSIGNAL),
                static_cast<ssize_t>(kHello.size()));
    }
  });

  Client client(path, kPatient);
  const auto refused = client.connect();

  EXPECT_FALSE(refused) << refused->message;
  server.join();
  close(listener);
}

TEST(Client, KeepsNotificationsThatComeBeforeTheAnswer) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    const auto request = peer.hear();
    peer.say(protocol::to_line(protocol::make_notification("value", {{"n", 1}})) + "\n");
    peer.answer(request, {{"sub", 1}});
    peer.say(protocol::to_line(protocol::make_notification("value", {{"n", 2}})) + "\n");
    peer.wait_for_the_end();
  });
  Client client(server.path(), kPatient);
  ASSERT_FALSE(client.connect());

  const auto answer = client.call("watch.subscribe", Json::object(), kPatient);

  EXPECT_TRUE(std::holds_alternative<Json>(answer));
  EXPECT_EQ(std::get<Notification>(client.next()).params["n"], 1);
  EXPECT_EQ(std::get<Notification>(client.next()).params["n"], 2);
}

TEST(Client, ReadsAnAnswerThatComesByteByByte) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    const auto request = peer.hear();
    const auto line = protocol::to_line(protocol::make_response(request.id, {{"x", 1}})) + "\n";
    for (const char byte : line) peer.say({byte});
    peer.wait_for_the_end();
  });
  Client client(server.path(), kPatient);
  ASSERT_FALSE(client.connect());

  EXPECT_EQ(std::get<Json>(client.call("ping", Json::object(), kPatient)), (Json{{"x", 1}}));
}

TEST(Client, HandsOnARefusalOfTheDaemon) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    const auto request = peer.hear();
    const auto fault =
        protocol::fault_of(refuse(Errc::unknown_name, "a.b", "no such"), "unchanged", 41);
    peer.say(protocol::to_line(protocol::make_error(request.id, fault)) + "\n");
    peer.wait_for_the_end();
  });

  const Fault fault = fault_of_call(server, "param.get");

  EXPECT_EQ(fault.exit, 4);
  EXPECT_EQ(fault.where, "a.b");
  EXPECT_EQ(fault.generation, 41U);
}

TEST(Client, SaysThatThereIsNoSocket) {
  Client client("/nowhere/at/all.sock", kPatient);

  const auto fault = client.connect();

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->name, "unreachable");
  EXPECT_EQ(fault->exit, 7);
  EXPECT_EQ(fault->where, "/nowhere/at/all.sock");
  EXPECT_THAT(fault->message, testing::HasSubstr("no socket at /nowhere/at/all.sock"));
  EXPECT_FALSE(fault->hint.empty());
}

TEST(Client, NamesTheSocketOfTheServiceWhereThereIsOne) {
  const test::TempDir place;
  const std::string service = place.write("mauved.sock", "").string();

  EXPECT_THAT(how_to_reach("/run/user/7/mauve/mauved.sock", service),
              testing::HasSubstr("export MAUVE_SOCKET=" + service));
  EXPECT_THAT(how_to_reach(service, service), testing::HasSubstr("systemctl start mauved"));
  EXPECT_THAT(how_to_reach(service, service), testing::HasSubstr("journalctl -u mauved"));
  EXPECT_THAT(how_to_reach("/run/user/7/mauve/mauved.sock", place / "no.sock"),
              testing::HasSubstr("systemctl start mauved"));
}

TEST(Client, NamesTheAccessListToAUserInTheGroupOfTheSocket) {
  const test::TempDir place;
  const std::string path = place.write("mauved.sock", "").string();

  EXPECT_THAT(how_to_be_permitted(path), testing::HasSubstr("getfacl " + path));
  EXPECT_THAT(how_to_be_permitted(place / "no.sock"),
              testing::HasSubstr("'mauve-view' to look, 'mauve' to change"));
}

TEST(Client, SaysThatAFileIsNoSocket) {
  const test::TempDir place;
  const std::string path = place.write("passwd", "").string();

  const auto fault = Client(path, kPatient).connect();

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->name, "unreachable");
  EXPECT_EQ(fault->message, path + " is no socket, so no mauved answers there");
}

TEST(Client, SaysThatNobodyListens) {
  const std::string path = "/tmp/mauve_ctl_dead_" + std::to_string(getpid());
  {
    boost::asio::io_context io;
    boost::asio::local::stream_protocol::acceptor dead(io, {path});
  }
  Client client(path, kPatient);

  const auto fault = client.connect();
  unlink(path.c_str());

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->exit, 7);
  EXPECT_NE(fault->message.find("nobody listens"), std::string::npos) << fault->message;
}

TEST(Client, RefusesAPathThatNoSocketCanHave) {
  EXPECT_EQ(Client(std::string(200, 'x'), kPatient).connect()->exit, 2);
  EXPECT_EQ(Client("", kPatient).connect()->exit, 2);
}

TEST(Client, SaysThatASilentServerDoesNotGreet) {
  FakeServer server([](Peer& peer) { peer.wait_for_the_end(); });
  Client client(server.path(), kImpatient);

  const auto fault = client.connect();

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->exit, 7);
  EXPECT_NE(fault->message.find("greet"), std::string::npos);
}

TEST(Client, RefusesAServerThatIsNotMauved) {
  for (const std::string greeting : {"HTTP/1.1 400 Bad Request\r\n\r\n", "{}\n", "\x01\x02\x03\n",
                                     R"({"jsonrpc":"2.0","method":"welcome","params":{}})"
                                     "\n",
                                     R"({"jsonrpc":"2.0","id":1,"result":{}})"
                                     "\n"}) {
    FakeServer server([&](Peer& peer) { peer.say(greeting); });
    Client client(server.path(), kPatient);

    const auto fault = client.connect();

    ASSERT_TRUE(fault) << greeting;
    EXPECT_EQ(fault->name, "bad_answer") << greeting;
    EXPECT_EQ(fault->exit, 7);
  }
}

TEST(Client, RefusesADaemonOfAnotherProtocol) {
  FakeServer server([](Peer& peer) {
    peer.say(R"({"jsonrpc":"2.0","method":"hello","params":{"protocol":[2,3]}})"
             "\n");
  });
  Client client(server.path(), kPatient);

  const auto fault = client.connect();

  ASSERT_TRUE(fault);
  EXPECT_NE(fault->message.find("protocol 1"), std::string::npos);
}

TEST(Client, HandsOnWhatIsSaidInPlaceOfAGreeting) {
  FakeServer server([](Peer& peer) {
    const auto fault = protocol::fault_of(refuse(Errc::limit, "", "too many clients"));
    peer.say(protocol::to_line(protocol::make_error(nullptr, fault)) + "\n");
  });
  Client client(server.path(), kPatient);

  const auto fault = client.connect();

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->message, "too many clients");
}

TEST(Client, SaysThatTheDaemonWentAway) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    peer.hear();
  });

  const Fault fault = fault_of_call(server, "status.get");

  EXPECT_EQ(fault.exit, 7);
  EXPECT_EQ(fault.message, "mauved went away");
  EXPECT_EQ(fault.state, "unchanged");
}

TEST(Client, DoesNotKnowTheOutcomeOfAChangeWhenTheDaemonWentAway) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    peer.hear();
  });

  EXPECT_EQ(fault_of_call(server, "core.swap").state, "unknown");
}

TEST(Client, SaysThatTheConnectionEndedInTheMiddleOfALine) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    peer.hear();
    peer.say(R"({"jsonrpc":"2.0","id":1,"resu)");
  });

  const Fault fault = fault_of_call(server, "status.get");

  EXPECT_EQ(fault.exit, 7);
  EXPECT_NE(fault.message.find("middle of a line"), std::string::npos);
}

TEST(Client, SaysThatAnAnswerIsGarbage) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    peer.hear();
    peer.say("\xff\xfe garbage\n");
    peer.wait_for_the_end();
  });

  const Fault fault = fault_of_call(server, "status.get");

  EXPECT_EQ(fault.name, "bad_answer");
  EXPECT_EQ(fault.exit, 7);
}

TEST(Client, GivesUpWhenTheAnswerDoesNotCome) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    peer.hear();
    peer.say(R"({"jsonrpc":)");
    peer.wait_for_the_end();
  });

  const Fault fault = fault_of_call(server, "core.swap", kImpatient);

  EXPECT_EQ(fault.name, "timed_out");
  EXPECT_EQ(fault.exit, 8);
  EXPECT_EQ(fault.state, "unknown");
}

TEST(Client, IgnoresAnAnswerToSomebodyElse) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    const auto request = peer.hear();
    peer.say(protocol::to_line(protocol::make_response(999, {{"x", 1}})) + "\n");
    peer.answer(request, {{"x", 2}});
    peer.wait_for_the_end();
  });
  Client client(server.path(), kPatient);
  ASSERT_FALSE(client.connect());

  EXPECT_EQ(std::get<Json>(client.call("ping", Json::object(), kPatient)), (Json{{"x", 2}}));
}

TEST(Client, DoesNotSendARequestThatIsTooLong) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    peer.wait_for_the_end();
  });
  Client client(server.path(), kPatient);
  ASSERT_FALSE(client.connect());

  const auto answer = client.call("config.check", {{"text", std::string(1 << 20, 'x')}}, kPatient);

  EXPECT_EQ(std::get<Fault>(answer).name, "limit");
}

}  // namespace
}  // namespace mauve::ctl
