// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/doors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "fake_dispatcher.h"
#include "support/eventually.h"

namespace mauve::test {
namespace {

using protocol::Json;

bool greets(const std::filesystem::path& socket) {
  RawClient client(socket);
  return client.connected() && client.json()["method"] == "hello";
}

bool logged(ServedSocket& served, const std::string& text) {
  return eventually([&] { return served.log_text().find(text) != std::string::npos; });
}

/// The listening sockets of this process whose name ends with `name`.
std::vector<int> listeners(const std::string& name) {
  std::vector<int> found;
  for (int fd = 3; fd < 1024; ++fd) {
    int listens = 0;
    socklen_t size = sizeof listens;
    if (getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) != 0 || listens == 0) continue;
    sockaddr_un address{};
    size = sizeof address;
    if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
        std::string(address.sun_path).ends_with(name)) {
      found.push_back(fd);
    }
  }
  return found;
}

TEST(Doors, AreMadeAnewWhenTheirFilesAreRemoved) {
  ServedSocket served;
  auto connected = served.client();

  std::filesystem::remove(served.path());
  std::filesystem::remove(served.path_of_stops());

  EXPECT_TRUE(eventually([&] { return greets(served.path()); }));
  EXPECT_TRUE(eventually([&] { return greets(served.path_of_stops()); }));
  EXPECT_EQ(connected.ask("ping")["result"]["pong"], true) << "who is connected stays so";
  EXPECT_TRUE(logged(served, "mauved.sock is gone"));
  EXPECT_TRUE(logged(served, "mauved.sock.stop is there again"));
}

TEST(Doors, AreMadeAnewWhenTheirDirectoryIsMoved) {
  ServedSocket served({}, {}, {}, "run");
  auto connected = served.client();
  const auto away = served.dir / "away";

  std::filesystem::rename(served.path().parent_path(), away);

  EXPECT_TRUE(eventually([&] { return greets(served.path()); }));
  EXPECT_TRUE(eventually([&] { return greets(served.path_of_stops()); }));
  EXPECT_TRUE(std::filesystem::exists(served.path().string() + ".lock"));
  EXPECT_EQ(connected.ask("ping")["result"]["pong"], true);
}

TEST(Doors, AreMadeAnewWhenTheListeningSocketsAreShutDown) {
  for (const int how : {SHUT_RD, SHUT_RDWR}) {
    ServedSocket served;
    ASSERT_TRUE(greets(served.path()));
    for (const auto* name : {"mauved.sock", "mauved.sock.stop"}) {
      const auto found = listeners((served.dir / name).string());
      ASSERT_EQ(found.size(), 1U) << name;
      ASSERT_EQ(shutdown(found.front(), how), 0);
    }

    EXPECT_TRUE(eventually([&] { return greets(served.path()); })) << how;
    EXPECT_TRUE(eventually([&] { return greets(served.path_of_stops()); })) << how;
    EXPECT_TRUE(logged(served, "mauved.sock is there again"));
  }
}

TEST(Doors, LeaveAloneWhatAnotherProgramPutInTheirPlace) {
  ServedSocket served;
  std::filesystem::remove(served.path());
  std::filesystem::create_directory(served.path());

  EXPECT_TRUE(logged(served, "cannot be made anew"));
  EXPECT_TRUE(greets(served.path_of_stops())) << "the other one is not concerned";

  EXPECT_TRUE(std::filesystem::is_directory(served.path()));
  std::filesystem::remove(served.path());
  EXPECT_TRUE(eventually([&] { return greets(served.path()); })) << "it is tried again";
}

TEST(Doors, LeaveTheSocketOfAnotherDaemonAloneAtTheEnd) {
  const TempDir dir;
  {
    auto mine = server::Endpoint::open(dir / "s");
    ASSERT_TRUE(mine);
    for (const auto* name : {"s", "s.stop", "s.lock"}) {
      std::filesystem::remove(dir / name);
      dir.write(name, "of another one");
    }
  }

  for (const auto* name : {"s", "s.stop", "s.lock"}) {
    EXPECT_EQ(TempDir::read(dir / name), "of another one") << name;
  }
}

/// While this lives, the process has no descriptor left.
class NoDescriptors {
 public:
  NoDescriptors() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const int next = dup(0);
    close(next);
    rlimit tight = before_;
    tight.rlim_cur = static_cast<rlim_t>(next);
    setrlimit(RLIMIT_NOFILE, &tight);
    // Below the next one there may be gaps.
    for (int fd = dup(0); fd >= 0; fd = dup(0)) filled_.push_back(fd);
  }
  ~NoDescriptors() {
    setrlimit(RLIMIT_NOFILE, &before_);
    for (const int fd : filled_) close(fd);
  }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
  std::vector<int> filled_;
};

/// A client whose socket was made before the descriptors went.
class EarlySocket {
 public:
  EarlySocket() : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval patience{60, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~EarlySocket() { close(fd_); }
  EarlySocket(const EarlySocket&) = delete;
  EarlySocket& operator=(const EarlySocket&) = delete;

  /// The lines of the other side until it has said `lines` of them.
  std::string ask(const std::filesystem::path& path, std::string_view text, int lines) const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    if (connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
      return "no way in";
    if (send(fd_, text.data(), text.size(), MSG_NOSIGNAL) < 0) return "no way to ask";
    std::string got;
    while (std::count(got.begin(), got.end(), '\n') < lines) {
      char buffer[4096];
      const auto size = recv(fd_, buffer, sizeof buffer, 0);
      if (size <= 0) break;
      got.append(buffer, static_cast<std::size_t>(size));
    }
    return got;
  }

 private:
  int fd_;
};

constexpr const char* kPingOfAnEarlySocket = R"({"jsonrpc":"2.0","id":1,"method":"ping"})"
                                             "\n";

TEST(Doors, LetAClientInThatStopsWhenNoDescriptorIsLeft) {
#if defined(MAUVE_SANITIZE_ADDRESS_UNDEFINED)
  GTEST_SKIP() << "NOT TESTED: the sanitizer needs a descriptor of its own to look at an object";
#endif
  ServedSocket served;
  ASSERT_TRUE(greets(served.path()));
  for (const auto& path : {served.path(), served.path_of_stops()}) {
    const EarlySocket client;
    std::string got;
    ASSERT_TRUE(eventually([&] { return served.server->clients().empty(); }));
    {
      const NoDescriptors none;
      got = client.ask(path, kPingOfAnEarlySocket, 2);
    }
    EXPECT_THAT(got, testing::HasSubstr("\"pong\":true")) << path;
    EXPECT_THAT(got, testing::HasSubstr("\"only\":[\"ping\",\"component.stop\"")) << path;
  }
  EXPECT_TRUE(logged(served, "no descriptor left"));
  EXPECT_TRUE(logged(served, "may do all again"));
  EXPECT_TRUE(greets(served.path()));
}

TEST(Doors, LetMoreClientsInThatStopThanThereAreDescriptorsInReserve) {
#if defined(MAUVE_SANITIZE_ADDRESS_UNDEFINED)
  GTEST_SKIP() << "NOT TESTED: the sanitizer needs a descriptor of its own to look at an object";
#endif
  ServedSocket served;
  ASSERT_TRUE(greets(served.path()));
  const std::vector<EarlySocket> clients(3 * server::Reserve::kDescriptors);
  int answered = 0;
  ASSERT_TRUE(eventually([&] { return served.server->clients().empty(); }));
  {
    const NoDescriptors none;
    for (const auto& client : clients) {
      answered += client.ask(served.path_of_stops(), kPingOfAnEarlySocket, 2).find("pong") ==
                          std::string::npos
                      ? 0
                      : 1;
    }
  }

  EXPECT_EQ(answered, static_cast<int>(clients.size())) << "one that has its answer makes room";
}

}  // namespace
}  // namespace mauve::test
