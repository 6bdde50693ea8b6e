// SPDX-License-Identifier: LGPL-3.0-or-later
/// Described types: to values and back, and layouts that distinguish types.
#include <gtest/gtest.h>

#include <mauve/plugin.h>

namespace {

struct Point {
  double x = 0;
  double y = 0;
};
struct Scan {
  std::uint8_t mode = 0;
  mauve::Bounded<float, 4> ranges;
  mauve::Text<8> frame;
  std::array<int, 2> counts{};
  Point origin;
};
struct OtherPoint {
  double y = 0;
  double x = 0;
};

}  // namespace

template <>
struct mauve::Described<Point> {
  static constexpr std::string_view name = "point/1";
  static constexpr auto fields() {
    return std::tuple{field("x", &Point::x, "m"), field("y", &Point::y, "m")};
  }
};
template <>
struct mauve::Described<OtherPoint> {
  static constexpr std::string_view name = "point/1";
  static constexpr auto fields() {
    return std::tuple{field("x", &OtherPoint::x, "m"), field("y", &OtherPoint::y, "m")};
  }
};
template <>
struct mauve::Described<Scan> {
  static constexpr std::string_view name = "scan/1";
  static constexpr auto fields() {
    return std::tuple{field("mode", &Scan::mode), field("ranges", &Scan::ranges, "m"),
                      field("frame", &Scan::frame), field("counts", &Scan::counts),
                      field("origin", &Scan::origin)};
  }
};

namespace mauve {
namespace {

struct WatcherShell : Shell {};

/// Properties of these types are checked to the last number in them.
struct Watcher : Core<WatcherShell> {
  Property<Scan> scan{*this, "scan", {}, "what it expects"};
  Property<double> far{*this, "far", 1.0, "no limit"};
};

TEST(Type, OfAPropertyHoldsNoNumberThatIsNone) {
  Watcher core;
  Value::Object scan{{"mode", 3},
                     {"ranges", Value::Array{1.5, "nan"}},
                     {"frame", "laser"},
                     {"counts", Value::Array{1, 2}},
                     {"origin", Value::Object{{"x", 0.5}, {"y", -1.0}}}};

  const Status in_an_array = core.scan.set(scan);
  scan[1].second = Value::Array{1.5, "inf"};
  scan[4].second = Value::Object{{"x", "nan"}, {"y", -1.0}};
  const Status in_a_member = core.scan.set(scan);
  scan[4].second = Value::Object{{"x", 0.5}, {"y", -1.0}};

  ASSERT_FALSE(in_an_array);
  EXPECT_EQ(in_an_array.error().message, "has a field or an item that is not a number");
  ASSERT_FALSE(in_a_member);
  EXPECT_EQ(in_a_member.error().message, "has a field or an item that is not a number");
  EXPECT_TRUE(core.scan.set(scan)) << "an infinity is a number, here as in a property of one";
  EXPECT_TRUE(core.far.set("inf"));
  EXPECT_FALSE(core.far.set("nan"));
}

TEST(Type, GoesToAValueAndBack) {
  Scan scan;
  scan.mode = 3;
  scan.ranges.push_back(1.5F);
  scan.frame = "laser";
  scan.counts = {1, 2};
  scan.origin = {0.5, -1};

  const Value value = data_type<Scan>().to_value(&scan);
  EXPECT_EQ(
      to_string(value),
      R"({"mode":3,"ranges":[1.5],"frame":"laser","counts":[1,2],"origin":{"x":0.5,"y":-1}})");
  Scan back;
  ASSERT_TRUE(data_type<Scan>().from_value(value, &back));
  EXPECT_EQ(data_type<Scan>().to_value(&back), value);
}

TEST(Type, RefusesFieldsThatDoNotFitAndNamesThem) {
  Scan scan;
  const Status unknown = data_type<Scan>().from_value(Value::Object{{"modes", 1}}, &scan);
  const Status range = data_type<Scan>().from_value(Value::Object{{"mode", 300}}, &scan);
  const Status full =
      data_type<Scan>().from_value(Value::Object{{"ranges", Value::Array{1, 2, 3, 4, 5}}}, &scan);

  EXPECT_EQ(unknown.error().at, "modes");
  EXPECT_EQ(range.error().message, "300 is not from 0 to 255");
  EXPECT_FALSE(full);
}

TEST(Type, RefusesAnEnormousValueInOneSentenceThatDoesNotRepeatIt) {
  const std::string enormous(900'000, 'x');
  std::string text;
  Scan scan;
  const auto refused = [&](const Value& value) {
    return data_type<Scan>().from_value(value, &scan).error();
  };

  EXPECT_EQ(data_type<std::string>().from_value(enormous, &text).error().message,
            "is a text of 900000 bytes, and at most 4096 are taken");
  EXPECT_TRUE(data_type<std::string>().from_value(enormous.substr(0, 4096), &text));
  EXPECT_EQ(refused(Value::Object{{"frame", enormous}}).message,
            "is a text of 900000 bytes, and at most 8 are taken");
  EXPECT_EQ(refused(Value::Object{{"mode", enormous}}).message,
            "expected an integer, got \"" + std::string(59, 'x') + "... (900002 bytes)");
  EXPECT_LT(refused(Value::Object{{"counts", Value::Array(100'000, 1)}}).message.size(), 200U);
  EXPECT_LT(to_string(refused(Value::Object{{enormous, 1}})).size(), 300U);
}

TEST(Type, KeepsEveryUnsignedIntegerOf64Bits) {
  const auto& type = data_type<std::uint64_t>();
  for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{INT64_MAX},
                                     std::uint64_t{INT64_MAX} + 1, std::uint64_t{UINT64_MAX}}) {
    const Value value = type.to_value(&number);
    EXPECT_EQ(to_string(value), std::to_string(number));
    std::uint64_t back = 1;
    ASSERT_TRUE(type.from_value(value, &back));
    EXPECT_EQ(back, number);
  }
  std::uint64_t whole = 0;
  std::int64_t with_sign = 0;
  const Value largest(std::uint64_t{UINT64_MAX});
  EXPECT_EQ(type.from_value(-1, &whole).error().message,
            "-1 is not from 0 to 18446744073709551615");
  EXPECT_EQ(data_type<std::int64_t>().from_value(largest, &with_sign).error().message,
            "18446744073709551615 is not from -9223372036854775808 to 9223372036854775807");
  EXPECT_EQ(type.from_value(3.0, &whole).error().message, "expected an integer, got 3.0");
  EXPECT_EQ(type.from_value(0x1p63, &whole).error().message,
            "expected an integer, got 9223372036854775808.0");
  double real = 0;
  ASSERT_TRUE(data_type<double>().from_value(largest, &real));
  EXPECT_EQ(real, 0x1p64);
}

TEST(Type, LayoutDistinguishesStructsOfTheSameName) {
  EXPECT_EQ(data_type<Point>().name, data_type<OtherPoint>().name);
  EXPECT_FALSE(same_type(data_type<Point>(), data_type<OtherPoint>()));
}

TEST(Type, NamesBasicTypes) {
  EXPECT_EQ(data_type<double>().name, "double");
  EXPECT_EQ(data_type<std::uint16_t>().name, "uint16");
  EXPECT_EQ(data_type<bool>().name, "bool");
  EXPECT_EQ(data_type<Duration>().name, "duration");
}

TEST(Bounded, KeepsItsCapacity) {
  Bounded<int, 2> items;
  EXPECT_TRUE(items.push_back(1));
  EXPECT_TRUE(items.push_back(2));
  EXPECT_FALSE(items.push_back(3));
  EXPECT_EQ(items.size(), 2u);
  items.resize(9);
  EXPECT_EQ(items.size(), 2u);
}

}  // namespace
}  // namespace mauve
