// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/text/json.h"

#include <random>
#include <string>

#include <gtest/gtest.h>

namespace mauve::arch {
namespace {

Node accepted(std::string_view text) {
  Problems problems;
  auto node = parse_json(text, problems);
  for (const Problem& problem : problems.sorted()) ADD_FAILURE() << to_string(problem, "text");
  return node ? *node : Node{};
}

std::vector<Problem> refused(std::string_view text, const JsonLimits& limits = {}) {
  Problems problems;
  EXPECT_FALSE(parse_json(text, problems, limits)) << text;
  EXPECT_FALSE(problems.empty()) << text;
  return problems.sorted();
}

const Member& member(const Node& node, std::size_t index) {
  return std::get<Node::Object>(node.content).at(index);
}
const Node& item(const Node& node, std::size_t index) {
  return std::get<Node::Array>(node.content).at(index);
}

TEST(Json, ReadsEveryKindOfValue) {
  const Node root = accepted(R"([null, true, -3, 2.5, "text", [], {}])");

  EXPECT_EQ(kind_of(item(root, 0)), "null");
  EXPECT_EQ(std::get<bool>(item(root, 1).content), true);
  EXPECT_EQ(std::get<std::int64_t>(item(root, 2).content), -3);
  EXPECT_EQ(std::get<double>(item(root, 3).content), 2.5);
  EXPECT_EQ(std::get<std::string>(item(root, 4).content), "text");
  EXPECT_EQ(kind_of(item(root, 5)), "an array");
  EXPECT_EQ(kind_of(item(root, 6)), "an object");
}

TEST(Json, KeepsTheOrderOfMembers) {
  const Node root = accepted(R"({"z": 1, "a": 2})");

  EXPECT_EQ(member(root, 0).key, "z");
  EXPECT_EQ(member(root, 1).key, "a");
}

TEST(Json, KnowsThePlaceOfKeysAndValues) {
  const Node root = accepted("{\n  \"a\": 12,\n  \"b\": [true,\n 1.5e3, \"x\"]}");

  EXPECT_EQ(root.where, (Position{1, 1}));
  EXPECT_EQ(member(root, 0).where, (Position{2, 3}));
  EXPECT_EQ(member(root, 0).value.where, (Position{2, 8}));
  EXPECT_EQ(member(root, 1).value.where, (Position{3, 8}));
  EXPECT_EQ(item(member(root, 1).value, 0).where, (Position{3, 9}));
  EXPECT_EQ(item(member(root, 1).value, 1).where, (Position{4, 2}));
  EXPECT_EQ(item(member(root, 1).value, 2).where, (Position{4, 9}));
}

TEST(Json, CountsCharactersNotBytesAndSkipsEscapesInStrings) {
  const Node root = accepted("[\"\xc3\xa9\xe2\x82\xac\", \"\\\"],{\\\\\", 1]");

  EXPECT_EQ(item(root, 1).where, (Position{1, 8}));
  EXPECT_EQ(std::get<std::string>(item(root, 1).content), "\"],{\\");
  EXPECT_EQ(item(root, 2).where, (Position{1, 19}));
}

TEST(Json, AcceptsComments) {
  const Node root = accepted("// \"first\" { [\n{ \"a\": /* , */ 1, // last\r\n\"b\": 2 } // end");

  EXPECT_EQ(root.where, (Position{2, 1}));
  EXPECT_EQ(member(root, 0).value.where, (Position{2, 16}));
  EXPECT_EQ(member(root, 1).where, (Position{3, 1}));
}

TEST(Json, AcceptsAByteOrderMark) {
  EXPECT_EQ(accepted("\xef\xbb\xbf{\"a\": 1}").where, (Position{1, 1}));
}

TEST(Json, SaysWhereTheSyntaxIsWrongAndWhatWasExpected) {
  const auto problems = refused("{\n  \"a\": ]\n}");

  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].where, (Position{2, 8}));
  EXPECT_EQ(problems[0].error.code, Errc::invalid_value);
  EXPECT_EQ(problems[0].error.message,
            "syntax error while parsing value - unexpected ']'; expected '[', '{', or a literal");
}

TEST(Json, RefusesWhatIsNotOneWholeValue) {
  for (const std::string text :
       {"", " ", "{", "[1,]", "{\"a\":1,}", "{} {}", "{} x", "{'a':1}", "tru", "nul", "01", "1.",
        "+1", "\"abc", "/* open", "{\"a\"}", "// only"}) {
    const auto problems = refused(text);
    EXPECT_NE(problems[0].where.line, 0U) << text;
    EXPECT_EQ(problems[0].error.message.find("last read"), std::string::npos) << text;
  }
}

TEST(Json, RefusesNumbersThatAreNotFinite) {
  refused("[NaN]");
  refused("[Infinity]");
  EXPECT_EQ(refused("[1, 1e999]")[0].where, (Position{1, 9}));
}

TEST(Json, ReadsIntegersOf64BitsWithAndWithoutSign) {
  EXPECT_EQ(std::get<std::int64_t>(accepted("9223372036854775807").content), INT64_MAX);
  EXPECT_EQ(std::get<std::uint64_t>(accepted("18446744073709551615").content), UINT64_MAX);
  EXPECT_EQ(kind_of(accepted("18446744073709551615")), "an integer");
}

TEST(Json, RefusesInvalidUtf8AndZeroBytes) {
  const auto problems = refused("{\"a\": \"\xff\"}");
  EXPECT_EQ(problems[0].error.message,
            "syntax error while parsing value - invalid string: ill-formed UTF-8 byte");
  EXPECT_EQ(refused(std::string_view("{}\0{", 4))[0].where, (Position{1, 3}));
}

TEST(Json, ReportsAKeyTwiceWithBothPlacesAndKeepsBothMembers) {
  Problems found;
  const auto root = parse_json("{\"a\": 1,\n \"b\": {\"c\": 1, \"c\": 2},\n \"a\": 3}", found);

  ASSERT_TRUE(root);
  EXPECT_EQ(member(*root, 2).key, "a");
  const auto problems = found.sorted();
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[0].where, (Position{2, 16}));
  EXPECT_EQ(problems[1].where, (Position{3, 2}));
  EXPECT_EQ(problems[1].error.code, Errc::duplicate);
  EXPECT_EQ(problems[1].error.message, "the key \"a\" appears twice");
  EXPECT_EQ(problems[1].error.hint, "it is already in line 1");
}

TEST(Json, Accepts32LevelsAndRefuses33) {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };

  accepted(nested(32));
  const auto problems = refused(nested(33));
  EXPECT_EQ(problems[0].error.code, Errc::limit);
  EXPECT_EQ(problems[0].where, (Position{1, 33}));
  refused(nested(100'000));
}

TEST(Json, RefusesTooLongAText) {
  JsonLimits limits;
  limits.bytes = 10;
  EXPECT_EQ(refused("[1, 2, 3, 4]", limits)[0].error.code, Errc::limit);
}

TEST(Json, BecomesAValueWithoutPlaces) {
  const Value expected = Value::Object{
      {"a", Value::Array{Value(1), Value(2.5), Value(true), Value()}}, {"b", Value("text")}};
  EXPECT_EQ(to_value(accepted(R"({"a": [1, 2.5, true, null], "b": "text"})")), expected);
}

TEST(Json, SurvivesAnyBytesAndAlwaysNamesAPlace) {
  const std::string good = "{\"a\": [1, -2.5e1, \"x\\n\", {\"b\": null}], // c\n \"d\": /**/ true}";
  std::mt19937 random(7);
  for (int round = 0; round < 20'000; ++round) {
    std::string text = good;
    for (unsigned change = random() % 4 + 1; change > 0; --change) {
      text[random() % text.size()] = static_cast<char>(random());
    }
    Problems problems;
    if (parse_json(text, problems)) continue;
    ASSERT_FALSE(problems.empty()) << text;
    for (const Problem& problem : problems.sorted()) ASSERT_GT(problem.where.line, 0U) << text;
  }
}

TEST(Json, HintsAtTheUsualSlips) {
  const auto hint = [](std::string_view text) { return refused(text).front().error.hint; };
  const std::string comma = "remove the comma before it: none stands behind the last item";
  EXPECT_EQ(hint("[1, 2,]"), comma);
  EXPECT_EQ(hint("{\n  \"a\": 1,\n}"), comma);
  EXPECT_EQ(hint("{\"a\": 1,\n // more\n}"), comma);
  const std::string missing = "a comma is missing behind the value before it";
  EXPECT_EQ(hint("{\"a\": 1\n \"b\": 2}"), missing);
  EXPECT_EQ(hint("[1 2]"), missing);
  EXPECT_EQ(hint("[\"a\" \"b\"]"), missing);
  EXPECT_EQ(hint("{\"a\": {} \"b\": 2}"), missing);
  const std::string quotes = "strings and keys stand in double quotes: \"...\"";
  EXPECT_EQ(hint("['a']"), quotes);
  EXPECT_EQ(hint("{'a': 1}"), quotes);
  EXPECT_EQ(hint("{\"a\": 'text'}"), quotes);
  const std::string closing =
      "a string ends in the line in which it begins: a closing \" is missing";
  EXPECT_EQ(hint("{\"a\": \"text,\n \"b\": 1}"), closing);
  EXPECT_EQ(hint("{\"a: 1}"), closing);
  EXPECT_EQ(hint("{a: 1}"), "keys stand in double quotes: \"name\": ...");
  EXPECT_EQ(hint("{\"a\" 1}"), "write a colon between key and value");
  EXPECT_EQ(hint("{\"a\" = 1}"), "write a colon between key and value");
  EXPECT_EQ(hint("{\"a\": }"), "write the value that is missing before it");
  EXPECT_EQ(hint("{\"a\": True}"),
            "text stands in double quotes; the words without are true, false and null");
  EXPECT_EQ(hint("{\"a\": 10ms}"), "text with a unit stands in double quotes: \"10ms\"");
  EXPECT_EQ(hint("{\"a\": .5}"), "a number begins with a digit or a minus sign");
  EXPECT_EQ(hint("[1, 2}"), "a [ is closed by ]");
  EXPECT_EQ(hint("{\"a\": 1]"), "a { is closed by }");
  EXPECT_EQ(hint("{\"a\": [1, 2"), "a closing } or ] is missing, or the file was cut off");
  EXPECT_EQ(hint(" \n"), "the file is empty");
  EXPECT_EQ(hint("{} {}"), "a file holds one value: remove the rest");
}

}  // namespace
}  // namespace mauve::arch
