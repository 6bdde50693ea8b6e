// SPDX-License-Identifier: LGPL-3.0-or-later
// mauvectl checks the user of the process that listens on the socket.
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "cli/client.h"
#include "protocol/socket_path.h"
#include "support/foreign_listener.h"
#include "support/temp_dir.h"

namespace mauve::ctl {
namespace {

TEST(ClientTrust, BelievesNoOtherUserWhoListensInASharedDirectory) {
  const test::TempDir folder;
  std::filesystem::permissions(folder.path(),
                               std::filesystem::perms::all | std::filesystem::perms::sticky_bit);
  const auto path = (folder / "s").string();
  const test::ForeignListener impostor(path, SOCK_STREAM);
  if (!impostor.listens()) GTEST_SKIP() << "NOT TESTED: only root makes a socket of another user";
  Client client(path, std::chrono::seconds(60));

  const auto fault = client.connect();

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->id, "listener_not_trusted");
  EXPECT_EQ(fault->name, "not_permitted");
}

/// A new directory below which nobody but its owner and root may write; empty: there is no place
/// for one, since this test may run anywhere, and as any user.
std::string closed_directory() {
  for (const char* parent : {"/run", "/var/lib", "/opt"}) {
    std::string place = std::string(parent) + "/mauve-test-XXXXXX";
    struct stat its {};
    const bool closed = stat(parent, &its) == 0 && (its.st_mode & S_IWOTH) == 0;
    if (closed && mkdtemp(place.data()) != nullptr) return place;
  }
  return {};
}

TEST(ClientTrust, BelievesAnotherUserInADirectoryThatOnlyThatUserMayWrite) {
  constexpr uid_t kUser = test::ForeignListener::kUser;
  const std::string place = closed_directory();
  if (place.empty()) GTEST_SKIP() << "NOT TESTED: only root makes a directory that is closed";
  EXPECT_TRUE(protocol::may_be_mauved(place + "/s", geteuid()));
  EXPECT_TRUE(protocol::may_be_mauved(place + "/s", 0));
  EXPECT_FALSE(protocol::may_be_mauved(place + "/s", kUser)) << "the directory is of this user";

  const bool given = chown(place.c_str(), kUser, static_cast<gid_t>(-1)) == 0;
  if (given) {
    EXPECT_TRUE(protocol::may_be_mauved(place + "/s", kUser));
    EXPECT_FALSE(protocol::may_be_mauved(place + "/s", kUser + 1));
  }

  rmdir(place.c_str());
  if (!given) GTEST_SKIP() << "NOT TESTED: only root gives a directory to another user";
}

TEST(ClientTrust, BelievesNobodyElseInADirectoryBelowOneThatEverybodyMayWrite) {
  constexpr uid_t kUser = test::ForeignListener::kUser;
  const test::TempDir folder;
  const auto socket = (folder / "below" / "s").string();
  std::filesystem::create_directory(folder / "below");
  std::filesystem::permissions(folder.path(),
                               std::filesystem::perms::all | std::filesystem::perms::sticky_bit);
  EXPECT_TRUE(protocol::may_be_mauved(socket, geteuid()));
  EXPECT_FALSE(protocol::may_be_mauved(socket, kUser));
  if (chown((folder / "below").c_str(), kUser, static_cast<gid_t>(-1)) != 0) {
    GTEST_SKIP() << "NOT TESTED: only root gives a directory to another user";
  }

  EXPECT_FALSE(protocol::may_be_mauved(socket, kUser));
}

}  // namespace
}  // namespace mauve::ctl
