// SPDX-License-Identifier: LGPL-3.0-or-later
#include "notify.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "support/notify_socket.h"

namespace mauve::daemon {
namespace {

using test::NotifySocket;

TEST(Notify, SaysReadyWithOneLineOfStatus) {
  const NotifySocket manager;

  notify::ready("rover is running:\n7 components");

  EXPECT_EQ(manager.next(), "READY=1\nSTATUS=rover is running: 7 components");
}

TEST(Notify, SaysThatItIsStopping) {
  const NotifySocket manager;

  notify::stopping("stopping");

  EXPECT_EQ(manager.next(), "STOPPING=1\nSTATUS=stopping");
}

TEST(Notify, AsksForMoreTime) {
  const NotifySocket manager;

  notify::extend(std::chrono::seconds(2));

  EXPECT_EQ(manager.next(), "EXTEND_TIMEOUT_USEC=2000000");
}

TEST(Notify, ARefusedStartOfAServicePointsToItsLog) {
  {
    const NotifySocket manager;
    EXPECT_EQ(notify::how_to_see_all(), "journalctl -u mauved shows all");
  }
  unsetenv("NOTIFY_SOCKET");
  EXPECT_EQ(notify::how_to_see_all(), "mauved --check shows all");
}

TEST(Notify, DoesNothingWithoutAServiceManager) {
  const NotifySocket manager;
  const std::string path = getenv("NOTIFY_SOCKET");
  unsetenv("NOTIFY_SOCKET");

  notify::ready("nobody hears this");

  setenv("NOTIFY_SOCKET", path.c_str(), 1);
  notify::ready("heard");
  EXPECT_EQ(manager.next(), "READY=1\nSTATUS=heard");
}

}  // namespace
}  // namespace mauve::daemon
