// SPDX-License-Identifier: LGPL-3.0-or-later
#include "notify.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

#include "support/temp_dir.h"

namespace mauve::daemon {
namespace {

/// Stands in for the service manager.
class NotifySocket {
 public:
  NotifySocket() {
    fd_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, (dir_ / "n").c_str(), sizeof address.sun_path - 1);
    EXPECT_EQ(bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", address.sun_path, 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    close(fd_);
  }
  std::string received() const {
    char buffer[1000];
    const auto size = recv(fd_, buffer, sizeof buffer, 0);
    return size < 0 ? std::string() : std::string(buffer, static_cast<std::size_t>(size));
  }

 private:
  test::TempDir dir_;
  int fd_ = -1;
};

TEST(Notify, SaysReadyWithOneLineOfStatus) {
  const NotifySocket manager;

  notify::ready("rover is running:\n7 components");

  EXPECT_EQ(manager.received(), "READY=1\nSTATUS=rover is running: 7 components");
}

TEST(Notify, SaysThatItIsStopping) {
  const NotifySocket manager;

  notify::stopping("stopping");

  EXPECT_EQ(manager.received(), "STOPPING=1\nSTATUS=stopping");
}

TEST(Notify, AsksForMoreTime) {
  const NotifySocket manager;

  notify::extend(std::chrono::seconds(2));

  EXPECT_EQ(manager.received(), "EXTEND_TIMEOUT_USEC=2000000");
}

TEST(Notify, DoesNothingWithoutAServiceManager) {
  unsetenv("NOTIFY_SOCKET");

  notify::ready("nobody hears this");
}

}  // namespace
}  // namespace mauve::daemon
