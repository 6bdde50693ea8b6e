// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/terminal_text.h"

#include <gtest/gtest.h>

namespace mauve {
namespace {

TEST(TerminalText, FindsControlCharactersSeparatorsAndMarksOfDirection) {
  for (const auto* obeyed :
       {"\x1B[31m", "\n", "\x7F", "\xC2\x9B", "\u2028", "\u202E", "\u2066", "\u200F", "\u061C"}) {
    EXPECT_GT(terminal_command(obeyed), 0U) << obeyed;
  }
  for (const auto* shown : {"", "a", "\u00B5", "\u2020", "\u201C", "\u206A", "\xC2",
                            "\xC2"
                            "A",
                            "\xE2\x80", "\xD8\xA7"}) {
    EXPECT_EQ(terminal_command(shown), 0U) << shown;
  }
}

TEST(TerminalText, IsEscapedInJsonWithoutAChangeOfItsMeaning) {
  EXPECT_EQ(json_for_terminals("{\n  \"a\": \"\u202Egnp.exe\x7F \xC2\x9B"
                               "31m \u00B5\u2028\"\n}"),
            "{\n  \"a\": \"\\u202egnp.exe\\u007f \\u009b31m \u00B5\\u2028\"\n}");
}

TEST(BeginningOfALongText, LeavesAShortTextAsItIs) {
  EXPECT_EQ(beginning_of(""), "");
  EXPECT_EQ(beginning_of(std::string(120, 'x')), std::string(120, 'x'));
}

TEST(BeginningOfALongText, HasTheBeginningAndTheLengthOfALongText) {
  EXPECT_EQ(beginning_of(std::string(900'000, 'x')), std::string(60, 'x') + "... (900000 bytes)");
}

TEST(BeginningOfALongText, DoesNotCutALetter) {
  std::string text(59, 'x');
  for (int i = 0; i < 60; ++i) text += "\u00e4";
  EXPECT_EQ(beginning_of(text), std::string(59, 'x') + "... (179 bytes)");
}

}  // namespace
}  // namespace mauve
