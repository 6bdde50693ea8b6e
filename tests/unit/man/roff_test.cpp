// SPDX-License-Identifier: LGPL-3.0-or-later
#include "roff.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema.h"

namespace mauve::man {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Roff, LetsNoTextActAsARequest) {
  EXPECT_EQ(plain(".so /etc/passwd"), "\\&.so /etc/passwd");
  EXPECT_EQ(plain("'tis"), "\\(aqtis");
  EXPECT_EQ(plain("a\\fBb"), "a\\efBb");
  EXPECT_EQ(plain("--json"), "\\-\\-json");
  EXPECT_EQ(verbatim("{\n.x\n}"), ".PP\n.nf\n.RS 4\n{\n\\&.x\n}\n.RE\n.fi\n");
}

TEST(Roff, SpellsWhatNoTerminalMayLack) {
  EXPECT_EQ(plain("1 → 2…"), "1 \\(-> 2...");
  EXPECT_EQ(plain("ü"), "\\[u00FC]");
  EXPECT_EQ(plain("\xF0\x9F\xA4\x96"), "\\[u1F916]");
  EXPECT_EQ(plain("cut \xC3"), "cut ?");
}

TEST(Roff, TurnsCodeAndLinks) {
  EXPECT_EQ(inline_roff("`a_b` and **strong `c`**"), "\\fBa_b\\fP and strong \\fBc\\fP");
  EXPECT_EQ(inline_roff("see [the `map`](a/b.md), then [1, 2]"),
            "see the \\fBmap\\fP, then [1, 2]");
  EXPECT_EQ(inline_roff("2 * 3 `open"), "2 * 3 `open");
}

TEST(Roff, TurnsParagraphsListsAndCode) {
  EXPECT_EQ(roff("one\ntwo\n\n- three\n  more\n- four\n```sh\na | b\n```\n"),
            ".PP\none two\n.IP \\(bu 2\nthree more\n.IP \\(bu 2\nfour\n"
            ".PP\n.nf\n.RS 4\na | b\n.RE\n.fi\n");
}

TEST(Roff, TurnsTablesIntoItems) {
  EXPECT_EQ(roff("| a | b | c |\n|---|---|---|\n| `x|y` | 1 | 2 |\n"), ".TP\n\\fBx|y\\fP\n1; 2\n");
  EXPECT_EQ(
      roff("| a | b | a | b |\n|---|---|---|---|\n| 1 | one | 2 | two |\n| | | 3 | three |\n"),
      ".TP\n1\none\n.TP\n2\ntwo\n.TP\n3\nthree\n");
}

TEST(Roff, FindsASection) {
  const std::string text = "# T\n## A\none\n### B\ntwo\n## C\nthree\n";

  EXPECT_EQ(section(text, "A"), "one\n### B\ntwo\n");
  EXPECT_EQ(section(text, "C"), "three\n");
  EXPECT_EQ(section(text, "D"), "");
}

TEST(SchemaKeys, StateKindLimitsAndDefault) {
  const std::string text = schema_keys(R"({
    "required": ["name"],
    "properties": {
      "name": { "type": "string", "description": "Its name" },
      "count": { "type": "integer", "minimum": 1, "default": 3 },
      "mode": { "oneOf": [{ "enum": ["a", "b"] }, { "$ref": "#/definitions/part" }] } },
    "definitions": {
      "part": { "properties": { "deep": { "type": "array", "items": { "type": "string" } } } },
      "time": { "type": "string", "pattern": "^[0-9]+s$" } } })");

  EXPECT_THAT(text, HasSubstr("\\fBname\\fP (string, required)\nIts name.\n"));
  EXPECT_THAT(text, HasSubstr("\\fBcount\\fP (integer)\nAt least 1, default 3."));
  EXPECT_THAT(text, HasSubstr("(\\fB\"a\"\\fP or \\fB\"b\"\\fP or \\fIpart\\fP)"));
  EXPECT_THAT(text, HasSubstr(".SS part\n"));
  EXPECT_THAT(text, HasSubstr("\\fBdeep\\fP (array of string)"));
  EXPECT_THAT(text, Not(HasSubstr(".SS time")));
  EXPECT_THAT(text, HasSubstr("\\fBtime\\fP (string)\nForm: \\fB^[0\\-9]+s$\\fP."));
  EXPECT_EQ(schema_keys("nonsense"), "");
}

}  // namespace
}  // namespace mauve::man
