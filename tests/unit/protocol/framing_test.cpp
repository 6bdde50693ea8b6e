// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/framing.h"

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace mauve::protocol {
namespace {

std::vector<std::string> take_all(LineFramer& framer) {
  std::vector<std::string> lines;
  while (auto line = framer.next()) lines.push_back(std::move(*line));
  return lines;
}

std::string nested(std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); }

using Lines = std::vector<std::string>;

TEST(Framing, PutsALineTogetherByteByByte) {
  LineFramer framer;

  for (const char byte : std::string_view("{\"id\":1}\n")) {
    EXPECT_FALSE(framer.next());
    ASSERT_TRUE(framer.feed({&byte, 1}));
  }

  EXPECT_EQ(take_all(framer), Lines{"{\"id\":1}"});
  EXPECT_FALSE(framer.partial());
}

TEST(Framing, TakesTwoLinesAndAHalfFromOnePiece) {
  LineFramer framer;

  ASSERT_TRUE(framer.feed("one\ntwo\nthr"));

  EXPECT_EQ(take_all(framer), (Lines{"one", "two"}));
  EXPECT_TRUE(framer.partial());
  ASSERT_TRUE(framer.feed("ee\n"));
  EXPECT_EQ(take_all(framer), Lines{"three"});
}

TEST(Framing, AcceptsCarriageReturnsAndLeavesOutEmptyLines) {
  LineFramer framer;

  ASSERT_TRUE(framer.feed("one\r\n\n\r\ntwo\n"));

  EXPECT_EQ(take_all(framer), (Lines{"one", "two"}));
}

TEST(Framing, AcceptsALineAsLongAsTheLimit) {
  LineFramer framer(8);

  ASSERT_TRUE(framer.feed("12345678\n12345678\r\n"));

  EXPECT_EQ(take_all(framer), (Lines{"12345678", "12345678"}));
}

TEST(Framing, RefusesALineLongerThanTheLimit) {
  LineFramer framer(8);

  const Status fed = framer.feed("123456789\n");

  ASSERT_FALSE(fed);
  EXPECT_EQ(fed.error().code, Errc::limit);
  EXPECT_FALSE(framer.next());
}

TEST(Framing, RefusesALongLineBeforeItsEndIsSeen) {
  LineFramer framer(8);

  ASSERT_TRUE(framer.feed("123456789"));  // the last byte may still be a carriage return

  EXPECT_FALSE(framer.feed("0"));
}

TEST(Framing, KeepsTheLinesBeforeTheOneThatIsTooLong) {
  LineFramer framer(8);

  EXPECT_FALSE(framer.feed("good\nmuch too long\nnever seen\n"));

  EXPECT_EQ(take_all(framer), Lines{"good"});
  EXPECT_FALSE(framer.feed("nor this\n"));
  EXPECT_FALSE(framer.next());
}

TEST(Framing, CutsTheSameLinesHoweverTheBytesArrive) {
  std::mt19937 random(20240229);  // NOLINT: the same bytes in every run
  for (int round = 0; round < 200; ++round) {
    std::string stream;
    for (int i = 0; i < 400; ++i) stream += "ab\r\n\n"[random() % 5];
    LineFramer whole(64);
    LineFramer pieces(64);
    const bool accepted = whole.feed(stream).has_value();
    bool pieces_accepted = true;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t size = 1 + random() % 7;
      pieces_accepted = pieces.feed(std::string_view(stream).substr(at, size)).has_value();
      at += size;
    }
    EXPECT_EQ(pieces_accepted, accepted);
    EXPECT_EQ(take_all(pieces), take_all(whole));
  }
}

TEST(StrictJson, ReadsEveryKindOfValue) {
  const auto value =
      parse_json(R"({"a":[1,-2,0.5,true,null,"x\u00e9"],"b":{"c":18446744073709551615}})");

  ASSERT_TRUE(value) << value.error().message;
  EXPECT_EQ((*value)["a"][1], -2);
  EXPECT_EQ((*value)["a"][5], "xé");
  EXPECT_EQ((*value)["b"]["c"], 18446744073709551615ULL);
}

TEST(StrictJson, CountsTheValues) {
  EXPECT_TRUE(parse_json("[1,{\"a\":2,\"b\":[]}]", 5));

  const auto refused = parse_json("[1,{\"a\":2,\"b\":[]}]", 4);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "has more than 4 values");
  EXPECT_FALSE(parse_json("[[[[[]]]]]", 4)) << "one that opens counts too";
}

TEST(StrictJson, AcceptsNestingOf32AndRefuses33) {
  EXPECT_TRUE(parse_json(nested(32)));

  const auto refused = parse_json(nested(33));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "nested deeper than 32");
  EXPECT_FALSE(parse_json(std::string(kMaxLine, '[')));
  std::string objects;
  for (int i = 0; i < 33; ++i) objects += R"({"a":)";
  EXPECT_FALSE(parse_json(objects));
}

TEST(StrictJson, RefusesDuplicateKeys) {
  EXPECT_FALSE(parse_json(R"({"a":1,"a":1})"));
  EXPECT_FALSE(parse_json(R"({"a":{"b":1,"c":2,"b":3}})"));
  EXPECT_FALSE(parse_json(R"({"a":1,"\u0061":2})"));

  EXPECT_TRUE(parse_json(R"({"a":{"a":1},"b":{"a":1}})"));
}

TEST(StrictJson, RefusesWhatIsNotAJsonText) {
  for (const std::string text : {"",
                                 " ",
                                 "{",
                                 "[1,]",
                                 "{\"a\"}",
                                 "NaN",
                                 "[NaN]",
                                 "[Infinity]",
                                 "[-Infinity]",
                                 "[1e999]",
                                 "[01]",
                                 "[+1]",
                                 "{} {}",
                                 "{}x",
                                 "// c\n{}",
                                 "{'a':1}",
                                 "[\"\x80\"]",
                                 "[\"\xc0\xaf\"]",
                                 "[\"\xed\xa0\x80\"]",
                                 "[\"\\ud800\"]",
                                 "[\"tab\there\"]",
                                 "\xff\xfe{}",
                                 "tru"}) {
    const auto refused = parse_json(text);
    ASSERT_FALSE(refused) << text;
    EXPECT_EQ(refused.error().code, Errc::invalid_value);
    EXPECT_FALSE(refused.error().message.empty());
    EXPECT_EQ(refused.error().message.find("json.exception"), std::string::npos);
    EXPECT_LT(refused.error().message.size(), 200U);
  }
}

TEST(StrictJson, SaysWhereTheTextGoesWrong) {
  const auto refused = parse_json(R"({"a":1,})");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "byte 8");
}

TEST(StrictJson, SurvivesRandomAndDamagedTexts) {
  const std::string good =
      R"({"jsonrpc":"2.0","id":7,"method":"param.set","params":{"values":{"a.b":[1,2.5,"é"]}}})";
  std::mt19937 random(42);  // NOLINT: the same bytes in every run
  for (int round = 0; round < 20000; ++round) {
    std::string text = good;
    for (std::size_t i = random() % 6; i-- > 0;) {
      text[random() % text.size()] = static_cast<char>(random() % 256);
    }
    text.resize(random() % (text.size() + 1));
    const auto value = parse_json(text);
    if (value) {
      EXPECT_TRUE(parse_json(to_line(*value)));
    }
  }
}

TEST(ToLine, IsOneLineOfValidUtf8WhateverTheText) {
  const std::string line = to_line(Json{{"text", "two\nlines \xff"}});

  EXPECT_EQ(line, "{\"text\":\"two\\nlines \xef\xbf\xbd\"}");
}

}  // namespace
}  // namespace mauve::protocol
