// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/size.h"

#include <string>

#include <gtest/gtest.h>

namespace mauve {
namespace {

TEST(Size, ReadsEveryUnit) {
  EXPECT_EQ(*parse_size("0B"), 0U);
  EXPECT_EQ(*parse_size("65536B"), 65536U);
  EXPECT_EQ(*parse_size("64KiB"), 65536U);
  EXPECT_EQ(*parse_size("1MiB"), 1048576U);
  EXPECT_EQ(*parse_size("2GiB"), 2147483648U);
}

TEST(Size, RefusesWhatHasNoUnitOrIsNoWholeNumber) {
  for (const std::string text : {"", "64", "KiB", "-1B", "1.5KiB", "64 KiB", "64kb", "64KiB "}) {
    const auto size = parse_size(text);
    ASSERT_FALSE(size) << text;
    EXPECT_NE(size.error().hint.find("64KiB"), std::string::npos);
  }
}

TEST(Size, RefusesWhatDoesNotFit) {
  EXPECT_EQ(*parse_size("18446744073709551615B"), UINT64_MAX);
  EXPECT_FALSE(parse_size("18446744073709551616B"));
  EXPECT_FALSE(parse_size("17179869184GiB"));
}

TEST(Size, WritesTheLargestExactUnit) {
  EXPECT_EQ(format_size(0), "0B");
  EXPECT_EQ(format_size(1000), "1000B");
  EXPECT_EQ(format_size(65536), "64KiB");
  EXPECT_EQ(format_size(3145728), "3MiB");
}

}  // namespace
}  // namespace mauve
