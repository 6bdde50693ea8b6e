// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/outbox.h"

#include <gtest/gtest.h>

#include <string>

namespace mauve::server {
namespace {

const protocol::NotificationText kNothing{protocol::Json::object()};

TEST(Outbox, CountsTheBytesThatWait) {
  Outbox outbox(1'000'000, 1, [] {});
  const auto sub = outbox.open();
  ASSERT_TRUE(sub);

  ASSERT_TRUE(outbox.push(*sub, "", "value", kNothing));
  const auto one = outbox.bytes();
  ASSERT_TRUE(outbox.push(*sub, "", "value", kNothing));
  EXPECT_EQ(outbox.bytes(), 2 * one);

  const auto line = outbox.take();
  ASSERT_TRUE(line);
  EXPECT_EQ(line->size(), one);
  EXPECT_EQ(outbox.bytes(), one);
  ASSERT_TRUE(outbox.take());
  EXPECT_EQ(outbox.bytes(), 0U);
}

TEST(Outbox, HasRoomAgainAfterALineIsRead) {
  constexpr int kRounds = 100;
  Outbox outbox(1000, 1, [] {});
  const auto sub = outbox.open();
  ASSERT_TRUE(sub);

  for (int i = 0; i < kRounds; ++i) {
    ASSERT_TRUE(outbox.push(*sub, "", "value", kNothing));
    ASSERT_TRUE(outbox.take());
  }

  EXPECT_EQ(outbox.dropped(), 0U);
}

}  // namespace
}  // namespace mauve::server
