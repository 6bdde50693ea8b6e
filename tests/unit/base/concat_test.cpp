// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/concat.h"

#include <cstdint>
#include <limits>
#include <type_traits>

#include <gtest/gtest.h>

namespace mauve {
namespace {

TEST(Concat, JoinsTextsOfEveryKindAndNumbers) {
  const std::string name = "port";
  const std::string_view view = "view";

  EXPECT_EQ(concat({"n", 3, ":", name, " ", view, -4}), "n3:port view-4");
  EXPECT_EQ(concat({"only"}), "only");
  EXPECT_EQ(concat({"", name, ""}), "port");
}

TEST(Concat, HasRoomForTheLongestNumbers) {
  EXPECT_EQ(concat({std::numeric_limits<std::int64_t>::min()}), "-9223372036854775808");
  EXPECT_EQ(concat({std::numeric_limits<std::uint64_t>::max()}), "18446744073709551615");
}

static_assert(!std::is_constructible_v<TextPart, char>, "a letter is no number");
static_assert(!std::is_constructible_v<TextPart, bool>, "a truth value is no number");
static_assert(!std::is_constructible_v<TextPart, double>, "the caller chooses its digits");

}  // namespace
}  // namespace mauve
