// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/endpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>

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

TEST(Endpoint, MakesASecondSocketForStops) {
  const TempDir dir;
  const auto endpoint = Endpoint::open(dir / "s");

  ASSERT_TRUE(endpoint);
  EXPECT_EQ(mode_of(dir / "s.stop"), 0660U);
  EXPECT_TRUE(test::RawClient(dir / "s.stop").connected());
}

/// One entry of an access list, as acl(5) and the kernel have it.
struct AclEntry {
  std::uint16_t tag;
  std::uint16_t permissions;
  std::uint32_t id;
};
struct Acl {
  std::uint32_t version;
  std::array<AclEntry, 5> entries;
};

/// The entries of the access list of a file, for named groups; none: it has no list.
std::map<std::uint32_t, unsigned> named_groups(const std::filesystem::path& file) {
  std::array<char, 512> bytes{};
  const auto size = getxattr(file.c_str(), "system.posix_acl_access", bytes.data(), bytes.size());
  std::map<std::uint32_t, unsigned> found;
  for (std::size_t at = 4; size > 0 && at < static_cast<std::size_t>(size);
       at += sizeof(AclEntry)) {
    AclEntry entry{};
    std::memcpy(&entry, &bytes[at], sizeof entry);
    if (entry.tag == 0x08) found[entry.id] = entry.permissions;
  }
  return found;
}

TEST(Endpoint, KeepsViewersFromTheSocketForStopsAlsoWhereTheDirectoryHasThemInItsAccessList) {
  constexpr std::uint32_t kViewers = 50'000;
  constexpr auto kNobody = static_cast<std::uint32_t>(-1);
  const TempDir dir;
  const Acl list{2,
                 {{{0x01, 6, kNobody},
                   {0x04, 6, kNobody},
                   {0x08, 6, kViewers},
                   {0x10, 6, kNobody},
                   {0x20, 0, kNobody}}}};
  if (setxattr(dir.path().c_str(), "system.posix_acl_default", &list, sizeof list, 0) != 0) {
    GTEST_SKIP() << "NOT TESTED: this file system has no access lists";
  }

  const auto endpoint = Endpoint::open(dir / "s");

  ASSERT_TRUE(endpoint);
  EXPECT_EQ(named_groups(dir / "s").count(kViewers), 1U);
  EXPECT_EQ(mode_of(dir / "s"), 0660U) << "the mask permits what the list says";
  EXPECT_EQ(named_groups(dir / "s.stop").count(kViewers), 0U);
  EXPECT_EQ(mode_of(dir / "s.stop"), 0660U);
}

/// A mauved without it would hear no stop beside viewers who take every place.
TEST(Endpoint, RefusesAPathBesideWhichTheSecondSocketHasNoRoom) {
  const TempDir dir;
  const auto longest = 102 - dir.path().string().size() - 1;

  const auto endpoint = Endpoint::open(dir / std::string(longest, 'x'));
  const auto longer = Endpoint::open(dir / std::string(longest + 1, 'y'));

  ASSERT_TRUE(endpoint);
  EXPECT_TRUE(test::RawClient(dir / (std::string(longest, 'x') + ".stop")).connected());
  ASSERT_FALSE(longer);
  EXPECT_EQ(longer.error().code, Errc::limit);
}

TEST(Endpoint, RefusesAStartWhereSomethingElseHasTheNameOfTheSecondSocket) {
  const TempDir dir;
  dir.write("s.stop", "precious");

  EXPECT_FALSE(Endpoint::open(dir / "s"));

  EXPECT_EQ(TempDir::read(dir / "s.stop"), "precious");
  EXPECT_FALSE(std::filesystem::exists(dir / "s")) << "the first one is not left behind";
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
