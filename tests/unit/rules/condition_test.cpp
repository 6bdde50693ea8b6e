// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rules/condition.h"

#include <limits>
#include <map>
#include <string>

#include <gtest/gtest.h>

namespace mauve::rules {
namespace {

using namespace std::chrono_literals;  // NOLINT: durations

/// Values by address; what is not there is an unknown name.
using Known = std::map<std::string, Value>;

Read read_from(const Known& values) {
  return [&values](const std::string& address) -> Result<Value> {
    const auto found = values.find(address);
    if (found != values.end()) return found->second;
    return refuse(Errc::unknown_name, address, "there is nothing of this name");
  };
}

Condition accepted(const std::string& text) {
  auto condition = Condition::parse(text);
  EXPECT_TRUE(condition) << (condition ? "" : to_string(condition.error()));
  return condition ? *std::move(condition) : *Condition::parse("a.b");
}

Truth truth(const std::string& text, const Known& values) {
  std::string error;
  return accepted(text).evaluate(read_from(values), error);
}

Error refused(const std::string& text) {
  const auto condition = Condition::parse(text);
  EXPECT_FALSE(condition) << text;
  return condition ? Error{} : condition.error();
}

TEST(Condition, ComparesIntegersThatNeedAll64Bits) {
  const Known values{{"a.n", Value(std::uint64_t{INT64_MAX} + 1)}};
  EXPECT_EQ(truth("a.n > 9223372036854775807", values), Truth::yes);
  EXPECT_EQ(truth("a.n == 9223372036854775807", values), Truth::no);
  EXPECT_EQ(truth("a.n >= 0.5", values), Truth::yes);
  EXPECT_EQ(truth("a.n == 9223372036854775808", values), Truth::yes);
  EXPECT_EQ(truth("a.n == 9223372036854775809", values), Truth::no);
  EXPECT_EQ(truth("a.n != 9223372036854775809", values), Truth::yes);
  EXPECT_EQ(truth("a.n < 9223372036854775809", values), Truth::yes);
  EXPECT_EQ(truth("a.n >= 9223372036854775809", values), Truth::no);

  const Known smaller{{"a.n", Value(std::int64_t{INT64_MAX})}, {"a.x", 0x1p64}};
  EXPECT_EQ(truth("a.n < 9223372036854775808", smaller), Truth::yes);
  EXPECT_EQ(truth("a.n == 9223372036854775808", smaller), Truth::no);
  EXPECT_EQ(truth("a.x > 18446744073709551615", smaller), Truth::no) << "compared as doubles";
}

TEST(Condition, ComparesNumbersWithEveryOperator) {
  const Known values{{"a.n", 3}, {"a.x", 2.5}};

  EXPECT_EQ(truth("a.n < 4", values), Truth::yes);
  EXPECT_EQ(truth("a.n <= 3", values), Truth::yes);
  EXPECT_EQ(truth("a.n > 3", values), Truth::no);
  EXPECT_EQ(truth("a.n >= 3", values), Truth::yes);
  EXPECT_EQ(truth("a.n == 3", values), Truth::yes);
  EXPECT_EQ(truth("a.n != 3", values), Truth::no);
  EXPECT_EQ(truth("a.n < 3.5", values), Truth::yes);
  EXPECT_EQ(truth("a.x >= 2.5", values), Truth::yes);
  EXPECT_EQ(truth("a.x > 2", values), Truth::yes);
  EXPECT_EQ(truth("a.x > -1e3", values), Truth::yes);
}

TEST(Condition, ComparesWordsDurationsAndTruths) {
  const Known values{{"c.state", "faulted"},
                     {"c.core", "guidance/stop"},
                     {"c.age", "20ms"},
                     {"g.core.fixed", true}};

  EXPECT_EQ(truth("c.state == faulted", values), Truth::yes);
  EXPECT_EQ(truth("c.state != running", values), Truth::yes);
  EXPECT_EQ(truth("c.core == guidance/stop", values), Truth::yes);
  EXPECT_EQ(truth("c.age > 10ms", values), Truth::yes);
  EXPECT_EQ(truth("c.age < 1.5s", values), Truth::yes);
  EXPECT_EQ(truth("g.core.fixed == true", values), Truth::yes);
  EXPECT_EQ(truth("g.core.fixed", values), Truth::yes);
  EXPECT_EQ(truth("not g.core.fixed", values), Truth::no);
}

TEST(Condition, BindsNotBeforeAndBeforeOr) {
  const Known values{{"a.t", true}, {"a.f", false}};

  EXPECT_EQ(truth("a.t or a.t and a.f", values), Truth::yes);
  EXPECT_EQ(truth("(a.t or a.t) and a.f", values), Truth::no);
  EXPECT_EQ(truth("not a.t or a.t", values), Truth::yes);
  EXPECT_EQ(truth("not (a.t or a.t)", values), Truth::no);
  EXPECT_EQ(truth("not not a.t", values), Truth::yes);
  EXPECT_EQ(truth("a.f or a.f or a.t", values), Truth::yes);
}

TEST(Condition, IsUnknownWhereAValueIsMissingAndItMatters) {
  const Known values{{"a.t", true},
                     {"a.f", false},
                     {"a.null", Value()},
                     {"a.nan", std::numeric_limits<double>::quiet_NaN()}};

  EXPECT_EQ(truth("a.null < 4", values), Truth::unknown);
  EXPECT_EQ(truth("not a.null < 4", values), Truth::unknown);
  EXPECT_EQ(truth("a.nan < 4", values), Truth::unknown);
  EXPECT_EQ(truth("a.null < 4 or a.t", values), Truth::yes);
  EXPECT_EQ(truth("a.null < 4 and a.f", values), Truth::no);
  EXPECT_EQ(truth("a.null < 4 and a.t", values), Truth::unknown);
  EXPECT_EQ(truth("a.t < 4", values), Truth::unknown) << "another kind of value";
}

TEST(Condition, NamesTheFirstAddressThatIsNotThere) {
  const Known values{{"a.t", true}};
  std::string error;

  const Truth found = accepted("a.t and b.gone").evaluate(read_from(values), error);

  EXPECT_EQ(found, Truth::unknown);
  EXPECT_NE(error.find("b.gone"), std::string::npos) << error;
}

TEST(Condition, ShowsTheValueOfEachAddressOnce) {
  const Known values{{"a.n", 9}, {"a.state", "running"}, {"a.null", Value()}};

  EXPECT_EQ(in_words(accepted("a.n < 4 or a.n > 20 or a.state == faulted or a.null > 1")
                         .values(read_from(values))),
            "a.n is 9, a.state is running, a.null is not there");
}

TEST(Condition, SaysWhereItCannotBeReadAndWhatToWrite) {
  const struct {
    const char* text;
    const char* place;
    const char* hint;
  } kCases[] = {
      {"", "empty", "gnss.core.satellites < 4"},
      {"a.b <", "the end, at character 6", ""},
      {"a.b = 4", "\"=\", at character 5", "=="},
      {"a.b == 4 && c.d", "\"&&\", at character 10", "and"},
      {"a.b == 4 || c.d", "at character 10", "or"},
      {"!a.b", "at character 1", "not"},
      {"4 > a.b", "at character 1", "address first"},
      {"a.b > c.d", "address \"c.d\", at character 7", "number"},
      {"a.b > 5 parsecs", "\"parsecs\", at character 9", ""},
      {"a.b > 5parsecs", "at character 7", "units"},
      {"a.b == \"x\"", "at character 8", "without quotes"},
      {"missed > 3", "at character 1", "dots"},
      {"(a.b", "for the \"(\" at character 1", ""},
      {"a.b) and c.d", "\")\", at character 4", ""},
      {"1 < a.b < 3", "at character 1", ""},
      {"a.b < 3 < 4", "\"<\", at character 9", ""},
      {"A.b < 3", "at character 1", ""},
      {"a..b < 3", "at character 1", ""},
      {"a.b < and", "at character 7", ""},
      {"not", "the end, at character 4", ""},
      {"a.b > -inf", "at character 7", "units"},
      {"a.b > 3 \xc3\xa4", "belongs nowhere", ""},
  };
  for (const auto& one : kCases) {
    const Error error = refused(one.text);
    EXPECT_NE(error.message.find(one.place), std::string::npos)
        << one.text << ": " << error.message;
    EXPECT_NE(error.hint.find(one.hint), std::string::npos) << one.text << ": " << error.hint;
  }
}

TEST(Condition, IsBounded) {
  std::string deep = "a.b";
  std::string many = "a.b";
  for (std::size_t i = 0; i < Condition::kDeepest + 1; ++i) deep = "not " + deep;
  for (std::size_t i = 0; i < Condition::kComparisons; ++i) many += " or a.b";

  EXPECT_EQ(refused(deep).code, Errc::limit);
  EXPECT_EQ(refused(many).code, Errc::limit);
  EXPECT_EQ(refused("a.b" + std::string(Condition::kLongest, ' ')).code, Errc::limit);
}

TEST(Condition, RefusesToCompareWhatDiffersInKind) {
  const auto comparison = [](const char* text) { return accepted(text).comparisons()[0]; };

  EXPECT_TRUE(check_kind(comparison("a.b < 4"), Kind::number));
  EXPECT_TRUE(check_kind(comparison("a.b < 4ms"), Kind::duration));
  EXPECT_TRUE(check_kind(comparison("a.b == running"), Kind::word));
  EXPECT_FALSE(check_kind(comparison("a.b < 4"), Kind::duration));
  EXPECT_FALSE(check_kind(comparison("a.b"), Kind::number)) << "a number is neither true nor false";
  EXPECT_FALSE(check_kind(comparison("a.b < running"), Kind::word)) << "words have no order";
}

}  // namespace
}  // namespace mauve::rules
