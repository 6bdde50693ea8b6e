// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/duration.h"

#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace mauve {
namespace {

using std::chrono::nanoseconds;

std::int64_t parsed(std::string_view text) {
  const auto value = parse_duration(text);
  EXPECT_TRUE(value) << text;
  return value ? value->count() : -1;
}

std::string refusal(std::string_view text) {
  const auto value = parse_duration(text);
  EXPECT_FALSE(value) << text;
  return value ? "" : value.error().message;
}

TEST(Duration, ReadsEveryUnit) {
  EXPECT_EQ(parsed("100ns"), 100);
  EXPECT_EQ(parsed("250us"), 250'000);
  EXPECT_EQ(parsed("10ms"), 10'000'000);
  EXPECT_EQ(parsed("1s"), 1'000'000'000);
  EXPECT_EQ(parsed("2min"), 120'000'000'000);
  EXPECT_EQ(parsed("1h"), 3'600'000'000'000);
  EXPECT_EQ(parsed("0s"), 0);
}

TEST(Duration, ReadsDecimalsExactly) {
  EXPECT_EQ(parsed("1.5ms"), 1'500'000);
  EXPECT_EQ(parsed("0.1s"), 100'000'000);
  EXPECT_EQ(parsed("0.000000001s"), 1);
  EXPECT_EQ(parsed("1.500000000000s"), 1'500'000'000);
  EXPECT_EQ(parsed("1.5h"), 5'400'000'000'000);
  EXPECT_EQ(parsed("0.25min"), 15'000'000'000);
}

TEST(Duration, RefusesANumberWithoutAUnitAndSaysHowToWriteIt) {
  const auto value = parse_duration("10");

  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().code, Errc::invalid_value);
  EXPECT_EQ(value.error().message, "\"10\" has no unit");
  EXPECT_NE(value.error().hint.find("10ms"), std::string::npos);
}

TEST(Duration, RefusesWhatIsNotADuration) {
  EXPECT_EQ(refusal(""), "\"\" is not a duration");
  EXPECT_EQ(refusal("ms"), "\"ms\" is not a duration");
  EXPECT_EQ(refusal("1.ms"), "\"1.ms\" is not a duration");
  EXPECT_EQ(refusal(".5ms"), "\".5ms\" is not a duration");
  EXPECT_EQ(refusal("10 ms"), "\"10 ms\" has an unknown unit");
  EXPECT_EQ(refusal("10MS"), "\"10MS\" has an unknown unit");
  EXPECT_EQ(refusal("1e3ms"), "\"1e3ms\" has an unknown unit");
  EXPECT_EQ(refusal("10ms "), "\"10ms \" has an unknown unit");
  EXPECT_EQ(refusal("+10ms"), "\"+10ms\" is not a duration");
}

TEST(Duration, RefusesANegativeOne) { EXPECT_EQ(refusal("-10ms"), "\"-10ms\" is negative"); }

TEST(Duration, RefusesAFractionOfANanosecond) {
  EXPECT_EQ(refusal("1.5ns"), "\"1.5ns\" is not a whole number of nanoseconds");
  EXPECT_EQ(refusal("0.0000000001s"), "\"0.0000000001s\" is not a whole number of nanoseconds");
  EXPECT_EQ(refusal("0.00000000000000000001s"),
            "\"0.00000000000000000001s\" is not a whole number of nanoseconds");
}

TEST(Duration, ReadsTheLongestAndRefusesOneMore) {
  EXPECT_EQ(parsed("9223372036854775807ns"), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(parsed("9223372036.854775807s"), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(refusal("9223372036854775808ns"), "\"9223372036854775808ns\" is too long");
  EXPECT_EQ(refusal("9223372036.854775808s"), "\"9223372036.854775808s\" is too long");
  EXPECT_EQ(refusal("99999999999999999999999999h"), "\"99999999999999999999999999h\" is too long");
}

TEST(Duration, WritesTheShortestExactText) {
  EXPECT_EQ(format_duration(nanoseconds(0)), "0s");
  EXPECT_EQ(format_duration(nanoseconds(100)), "100ns");
  EXPECT_EQ(format_duration(nanoseconds(250'000)), "250us");
  EXPECT_EQ(format_duration(nanoseconds(1'500'000)), "1.5ms");
  EXPECT_EQ(format_duration(nanoseconds(10'000'000)), "10ms");
  EXPECT_EQ(format_duration(nanoseconds(90'000'000'000)), "90s");
  EXPECT_EQ(format_duration(nanoseconds(120'000'000'000)), "2min");
  EXPECT_EQ(format_duration(nanoseconds(3'600'000'000'000)), "1h");
  EXPECT_EQ(format_duration(nanoseconds(1'000'000'001)), "1.000000001s");
  EXPECT_EQ(format_duration(nanoseconds(-1'500)), "-1.5us");
  EXPECT_EQ(format_duration(nanoseconds::min()), "-9223372036.854775808s");
}

TEST(Duration, ReadsBackWhatItWrites) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 20'000; ++round) {
    const auto value = static_cast<std::int64_t>(random() >> (1 + random() % 63));
    const std::string text = format_duration(nanoseconds(value));
    ASSERT_EQ(parsed(text), value) << text;
  }
}

}  // namespace
}  // namespace mauve
