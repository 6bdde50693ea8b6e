// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/socket_path.h"

#include <stdlib.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace mauve::protocol {
namespace {

TEST(SocketPath, IsWhatTheEnvironmentSays) {
  setenv("MAUVE_SOCKET", "/tmp/elsewhere.sock", 1);
  EXPECT_EQ(default_socket_path(), "/tmp/elsewhere.sock");
  unsetenv("MAUVE_SOCKET");
}

TEST(SocketPath, IsTheOneOfTheUserElse) {
  unsetenv("MAUVE_SOCKET");
  setenv("XDG_RUNTIME_DIR", "/run/user/7", 1);
  const std::string expected =
      geteuid() == 0 ? "/run/mauve/mauved.sock" : "/run/user/7/mauve/mauved.sock";
  EXPECT_EQ(default_socket_path(), expected);
}

}  // namespace
}  // namespace mauve::protocol
