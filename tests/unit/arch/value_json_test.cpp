// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/text/value_json.h"

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "arch/text/json.h"
#include "mauve/detail/codec_scalar.h"

namespace mauve::arch {
namespace {

const Value kSample =
    Value::Object{{"z", Value::Array{Value(true), Value(-3), Value(0.1), Value("10ms"), Value()}},
                  {"a", Value::Object{{"x", Value(1.0)}}},
                  {"empty", Value::Array{}}};

Value read_back(const std::string& text) {
  Problems problems;
  const auto node = parse_json(text, problems);
  EXPECT_TRUE(node) << text;
  return node ? to_value(*node) : Value{};
}

Value random_value(std::mt19937_64& random, int depth) {
  switch (random() % (depth == 0 ? 5 : 7)) {
    case 0:
      return {};
    case 1:
      return random() % 2 == 0;
    case 2:
      return static_cast<std::int64_t>(random());
    case 3: {
      const double number =
          std::ldexp(static_cast<double>(random()), static_cast<int>(random() % 400) - 200);
      return number;
    }
    case 4:
      return std::string(random() % 5, static_cast<char>(random() % 126 + 1));
    case 5: {
      Value::Array array;
      for (auto n = random() % 4; n > 0; --n) array.push_back(random_value(random, depth - 1));
      return array;
    }
    default: {
      Value::Object object;
      for (auto n = random() % 4; n > 0; --n) {
        object.emplace_back("key" + std::to_string(n), random_value(random, depth - 1));
      }
      return object;
    }
  }
}

TEST(ValueJson, ANumberAboveAllIntegersIsOutOfRangeAndAFractionIsNoInteger) {
  std::uint64_t serial = 0;
  EXPECT_EQ(Codec<std::uint64_t>::decode(read_back("18446744073709551616"), serial).error().message,
            "is above 18446744073709551615");
  EXPECT_EQ(Codec<std::uint64_t>::decode(read_back("-1e19"), serial).error().message,
            "is below -9223372036854775808");
  EXPECT_EQ(Codec<std::uint64_t>::decode(read_back("1.5"), serial).error().message,
            "expected an integer, got 1.5");
}

TEST(ValueJson, KeepsTheOrderOfMembersInText) {
  EXPECT_EQ(read_back(to_json_text(kSample)), kSample);
}

TEST(ValueJson, ReadsBackEveryValueItWrites) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 2'000; ++round) {
    const Value value = random_value(random, 4);
    ASSERT_EQ(read_back(to_json_text(value)), value) << to_json_text(value);
  }
}

TEST(ValueJson, GoesOverTheWireAndBack) {
  const auto value = from_json(nlohmann::json::parse(to_json(kSample).dump()));

  ASSERT_TRUE(value);
  EXPECT_EQ(*value->find("z"), *kSample.find("z"));
  EXPECT_EQ(*value->find("a"), *kSample.find("a"));
}

TEST(ValueJson, WritesAWordForANumberThatJsonCannotHoldAndNullOnlyForNoValue) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(to_json(Value(std::nan(""))), "nan");
  EXPECT_EQ(to_json(Value(-std::nan(""))), "nan");
  EXPECT_EQ(to_json(Value(kInfinity)), "inf");
  EXPECT_EQ(to_json(Value(-kInfinity)), "-inf");
  EXPECT_TRUE(to_json(Value()).is_null());
}

TEST(ValueJson, TheWordsComeBackAsNumbersWhereANumberIsExpected) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double number : {std::nan(""), kInfinity, -kInfinity}) {
    const auto value = from_json(to_json(Value(number)));
    ASSERT_TRUE(value);
    double back = 0.0;
    ASSERT_TRUE(Codec<double>::decode(*value, back)) << to_string(*value);
    EXPECT_TRUE(std::isnan(number) ? std::isnan(back) : back == number);
    std::int64_t integer = 0;
    EXPECT_FALSE(Codec<std::int64_t>::decode(*value, integer));
  }
  double number = 1.0;
  EXPECT_FALSE(Codec<double>::decode("NaN or so", number));
}

TEST(ValueJson, KeepsEveryIntegerOf64Bits) {
  for (const char* text : {"-9223372036854775808", "9223372036854775807", "9223372036854775808",
                           "18446744073709551615"}) {
    const Value value = read_back(text);
    EXPECT_EQ(kind_of(value), "an integer") << text;
    EXPECT_EQ(to_string(value), text);
    EXPECT_EQ(to_json(value).dump(), text);
    EXPECT_EQ(*from_json(nlohmann::json::parse(text)), value) << text;
  }
}

TEST(ValueJson, WritesTextThatIsNotUtf8WithoutThrowing) {
  EXPECT_NE(to_json_text(Value("a\xff")).find("a"), std::string::npos);
}

}  // namespace
}  // namespace mauve::arch
