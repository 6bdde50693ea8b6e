// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/peer.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/rate.h"

namespace mauve::server {
namespace {

const RoleRules kRules{900, 901, 902, 903};

TEST(Role, OfTheHighestGroup) {
  EXPECT_EQ(role_of({1, 1000, {100, 901}}, kRules), Role::viewer);
  EXPECT_EQ(role_of({1, 1000, {901, 902}}, kRules), Role::operator_);
  EXPECT_EQ(role_of({1, 1000, {903, 901}}, kRules), Role::admin);
}

TEST(Role, IsNoneForAStranger) { EXPECT_EQ(role_of({1, 1000, {100}}, kRules), Role::none); }

TEST(Role, IsAdminForRootAndForTheUserOfTheDaemon) {
  EXPECT_EQ(role_of({1, 0, {}}, kRules), Role::admin);
  EXPECT_EQ(role_of({1, 900, {}}, kRules), Role::admin);
}

TEST(Role, IsNotGivenByAGroupThatDoesNotExist) {
  EXPECT_EQ(role_of({1, 1000, {0, 901}}, {900, {}, {}, {}}), Role::none);
}

TEST(Peer, IsWhoTheKernelSays) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);

  const auto peer = peer_of(ends[0]);

  ASSERT_TRUE(peer);
  EXPECT_EQ(peer->pid, getpid());
  EXPECT_EQ(peer->uid, geteuid());
  EXPECT_FALSE(peer->groups.empty());
  close(ends[0]);
  close(ends[1]);
}

TEST(Peer, IsRefusedWhenItIsNoSocket) { EXPECT_FALSE(peer_of(STDIN_FILENO + 1000)); }

TEST(RateLimiter, LetsASecondsWorthPassAndThenTheRate) {
  RateLimiter rate(10);
  auto now = RateLimiter::Clock::now();
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(rate.allow(1000, now));
  }

  EXPECT_FALSE(rate.allow(1000, now));
  EXPECT_TRUE(rate.allow(1001, now));
  now += std::chrono::milliseconds(100);
  EXPECT_TRUE(rate.allow(1000, now));
  EXPECT_FALSE(rate.allow(1000, now));
}

TEST(RateLimiter, NeverHoldsRootBack) {
  RateLimiter rate(1);
  const auto now = RateLimiter::Clock::now();
  for (int i = 0; i < 1000; ++i) {
    EXPECT_TRUE(rate.allow(0, now));
  }
}

}  // namespace
}  // namespace mauve::server
