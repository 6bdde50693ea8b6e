// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/endpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/raw_client.h"
#include "support/temp_dir.h"

namespace mauve::server {
namespace {

using test::TempDir;

unsigned mode_of(const std::filesystem::path& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? status.st_mode & 07777 : 0;
}

TEST(Endpoint, MakesTheSocketForOwnerAndGroupInADirectoryForThem) {
  const TempDir dir;
  const auto path = dir / "run" / "mauved.sock";

  const auto endpoint = Endpoint::open(path);

  ASSERT_TRUE(endpoint);
  EXPECT_EQ(mode_of(path), 0660U);
  EXPECT_EQ(mode_of(dir / "run"), 0750U);
  EXPECT_EQ(mode_of(path.string() + ".lock"), 0600U);
}

TEST(Endpoint, RemovesSocketAndLockAtTheEnd) {
  const TempDir dir;
  { ASSERT_TRUE(Endpoint::open(dir / "s")); }

  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

TEST(Endpoint, RefusesASecondDaemonOnTheSameSocket) {
  const TempDir dir;
  const auto first = Endpoint::open(dir / "s");
  ASSERT_TRUE(first);

  const auto second = Endpoint::open(dir / "s");

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, Errc::conflict);
  EXPECT_TRUE(test::RawClient(dir / "s").connected());
}

TEST(Endpoint, ClearsTheSocketOfADaemonThatWasKilled) {
  const TempDir dir;
  const auto child = fork();
  if (child == 0) {
    const auto endpoint = Endpoint::open(dir / "s");
    _exit(endpoint ? 0 : 1);  // no destructor runs: as after SIGKILL
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  ASSERT_TRUE(std::filesystem::exists(dir / "s"));

  EXPECT_TRUE(Endpoint::open(dir / "s"));
}

TEST(Endpoint, LeavesAFileAloneThatIsNotASocket) {
  const TempDir dir;
  dir.write("s", "precious");

  const auto endpoint = Endpoint::open(dir / "s");

  ASSERT_FALSE(endpoint);
  EXPECT_EQ(TempDir::read(dir / "s"), "precious");
}

TEST(Endpoint, LeavesASocketAloneThatSomebodyAnswersAt) {
  const TempDir dir;
  auto other = Endpoint::open(dir / "s");
  ASSERT_TRUE(other);
  std::filesystem::remove((dir / "s").string() + ".lock");

  const auto endpoint = Endpoint::open(dir / "s");

  ASSERT_FALSE(endpoint);
  EXPECT_EQ(endpoint.error().code, Errc::conflict);
  EXPECT_TRUE(test::RawClient(dir / "s").connected());
}

TEST(Endpoint, DoesNotFollowALinkInPlaceOfTheLock) {
  const TempDir dir;
  const auto victim = dir.write("victim", "precious");
  std::filesystem::create_symlink(victim, (dir / "s").string() + ".lock");

  EXPECT_FALSE(Endpoint::open(dir / "s"));
  EXPECT_EQ(TempDir::read(victim), "precious");
}

TEST(Endpoint, RefusesAPathThatDoesNotFitIntoASocketAddress) {
  const TempDir dir;

  const auto endpoint = Endpoint::open(dir / std::string(120, 'x'));

  ASSERT_FALSE(endpoint);
  EXPECT_EQ(endpoint.error().code, Errc::limit);
}

TEST(Endpoint, SaysWhichDirectoryCannotBeMade) {
  const TempDir dir;

  const auto endpoint = Endpoint::open(dir / "a" / "b" / "s");

  ASSERT_FALSE(endpoint);
  EXPECT_EQ(endpoint.error().at, (dir / "a" / "b").string());
}

}  // namespace
}  // namespace mauve::server
