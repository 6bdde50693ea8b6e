// SPDX-License-Identifier: LGPL-3.0-or-later
#include "changes/request_limit.h"

#include <gtest/gtest.h>

namespace mauve::daemon {
namespace {

constexpr Instant kSecond = std::chrono::nanoseconds(1s).count();

TEST(RequestLimit, LetsTenPassAtOnceAndThenOneASecond) {
  RequestLimit limit;
  unsigned passed = 0;
  for (Instant now = 0; now < 60 * kSecond; now += kSecond / 1000) {
    passed += limit.pass("nagging", now) ? 1 : 0;
  }

  EXPECT_EQ(passed, RequestLimit::kAtOnce + 59);
  EXPECT_EQ(limit.ignored("nagging"), 60'000 - passed);
}

TEST(RequestLimit, SavesNoMoreThanTen) {
  RequestLimit limit;
  EXPECT_TRUE(limit.pass("calm", 0));
  unsigned passed = 0;
  for (int i = 0; i < 100; ++i) {
    passed += limit.pass("calm", 3600 * kSecond) ? 1 : 0;
  }

  EXPECT_EQ(passed, RequestLimit::kAtOnce);
}

TEST(RequestLimit, OfOneComponentIsNotThatOfAnother) {
  RequestLimit limit;
  while (limit.pass("nagging", kSecond)) {
  }

  EXPECT_TRUE(limit.pass("calm", kSecond));
  EXPECT_EQ(limit.ignored("calm"), 0U);
}

}  // namespace
}  // namespace mauve::daemon
