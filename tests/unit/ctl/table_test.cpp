// SPDX-License-Identifier: LGPL-3.0-or-later
#include "render/table.h"

#include <gtest/gtest.h>

#include "render/words.h"

namespace mauve::ctl {
namespace {

Table small() {
  Table table({{"NAME"}, {"RELEASES", true}});
  table.add({{"laser"}, {"7"}});
  table.add({{"control_of_the_arm"}, {"12345"}});
  return table;
}

TEST(Table, PutsTextsLeftAndNumbersRight) {
  EXPECT_EQ(small().text(0, false),
            "NAME                RELEASES\n"
            "laser                      7\n"
            "control_of_the_arm     12345\n");
}

TEST(Table, KeepsNamesWholeAndPutsWhatDoesNotFitBelow) {
  EXPECT_EQ(small().text(22, false),
            "NAME\n"
            "    RELEASES\n"
            "laser\n"
            "           7\n"
            "control_of_the_arm\n"
            "       12345\n");
}

TEST(Table, LeavesOutColumnsWithARankBeforeItUsesSecondLines) {
  Table table({{"NAME"}, {"CORE", false, 1}, {"RELEASES", true, 2}});
  table.add({{"control_of_the_arm"}, {"guidance/potential_field"}, {"12345"}});

  EXPECT_EQ(table.text(44, false),
            "NAME                CORE\n"
            "control_of_the_arm  guidance/potential_field\n");
  EXPECT_EQ(table.text(40, false), "NAME\ncontrol_of_the_arm\n");
}

TEST(Table, BreaksTheWidestTextAtItsBlanks) {
  Table table({{"NAME"}, {"TEXT"}, {"UNIT"}});
  table.add({{"gain"}, {"how fast it turns to the goal"}, {"1/s"}});
  table.add({{"speed"}, {"the most"}, {"m/s"}});

  EXPECT_EQ(table.text(30, false),
            "NAME   TEXT               UNIT\n"
            "gain   how fast it turns  1/s\n"
            "       to the goal\n"
            "speed  the most           m/s\n");
}

TEST(Table, MakesNoLineWiderThanTheTerminalUnlessOneWordIs) {
  Table table({{"NAME"}, {"CONDITION"}, {"FIRED", true}, {"WHY NOT"}});
  table.add({{"in_the_building"},
             {"gnss.core.satellites < 4 and odometry.read.x > 3"},
             {"0"},
             {"the condition does not hold"}});
  for (std::size_t width = 24; width <= 120; ++width) {
    const std::string text = table.text(width, false);
    for (const auto line : lines_of(text)) EXPECT_LE(columns(line), width) << text;
    for (const char* word :
         {"in_the_building", "gnss.core.satellites", "odometry.read.x", "hold"}) {
      EXPECT_NE(text.find(word), std::string::npos) << width << "\n" << text;
    }
  }
}

TEST(Table, DoesNotPadAllRowsForOneLongCellWhenItIsPiped) {
  Table table({{"NAME"}, {"VALUE"}, {"UNIT"}});
  table.add({{"discs"}, {std::string(300, 'x')}, {"m"}});
  table.add({{"gain"}, {"0.2"}, {"1/s"}});

  const std::string text = table.text(0, false);

  EXPECT_EQ(lines_of(text)[2], "gain   0.2    1/s");
  EXPECT_NE(text.find(std::string(300, 'x')), std::string::npos);
}

TEST(Table, PaintsOnlyWithColours) {
  Table table({{"STATE"}});
  table.add({{"faulted", Paint::red}});

  EXPECT_EQ(table.text(0, false), "STATE\nfaulted\n");
  EXPECT_EQ(table.text(0, true), "\033[1mSTATE  \033[0m\n\033[1;31mfaulted\033[0m\n");
}

TEST(Columns, CountCodePointsNotBytes) { EXPECT_EQ(columns("µs…"), 3U); }

TEST(Harmless, TakesEscapesAndControlsAway) {
  EXPECT_EQ(harmless("a\033[2Jb\nc\x7f"), "a?[2Jb?c?");
  EXPECT_EQ(harmless("\xC2\x9B"
                     "31m"),
            "?31m");
  EXPECT_EQ(harmless("\u202Egnp.exe\u2066 \u2028"), "?gnp.exe? ?");
  EXPECT_EQ(harmless("é µ …"), "é µ …");
}

TEST(Words, WriteTimesWithTheUnitThatFits) {
  EXPECT_EQ(nanoseconds_in_words(0), "0 ns");
  EXPECT_EQ(nanoseconds_in_words(38), "38 ns");
  EXPECT_EQ(nanoseconds_in_words(1234), "1.2 us");
  EXPECT_EQ(nanoseconds_in_words(196000), "196 us");
  EXPECT_EQ(nanoseconds_in_words(5e9), "5.0 s");
  EXPECT_EQ(seconds_in_words(7.9), "7 s");
  EXPECT_EQ(seconds_in_words(192), "3 min 12 s");
  EXPECT_EQ(seconds_in_words(3600), "1 h");
  EXPECT_EQ(seconds_in_words(266400), "3 d 2 h");
}

TEST(Words, WriteAnyValueInOneLine) {
  EXPECT_EQ(compact(Json::parse(R"({"b":[1,2.5,"x"],"a":null,"c":true})")),
            "{a: -, b: [1, 2.5, x], c: true}");
  EXPECT_EQ(compact("two\nlines"), "two?lines");
}

TEST(Words, RoundForPeopleToTenDigits) {
  EXPECT_EQ(compact(92.80000000000001), "92.8");
  EXPECT_EQ(compact(43.566137428333334), "43.56613743");
  EXPECT_EQ(compact(18446744073709551615ULL), "18446744073709551615");
}

TEST(Words, BreakLinesAtSpaces) {
  EXPECT_EQ(wrapped("one two three four five six seven", 25, 2),
            "one two three four five\n  six seven");
  EXPECT_EQ(wrapped("one two three", 0, 2), "one two three");
  EXPECT_EQ(wrapped("a_word_that_is_longer_than_the_line", 25, 2),
            "a_word_that_is_longer_than_the_line");
}

TEST(Words, CutAtTheEnd) {
  EXPECT_EQ(cut("µµµµ", 3), "µµ…");
  EXPECT_EQ(cut("abc", 3), "abc");
  EXPECT_EQ(cut("abc", 0), "abc");
}

TEST(Words, AreJoinedAndParted) {
  std::string all;
  join(all, "a");
  join(all, "b");
  join(all, "c", "; ");
  EXPECT_EQ(all, "a, b; c");
  EXPECT_EQ(lines_of("a\n\nb"), (std::vector<std::string_view>{"a", "", "b"}));
  EXPECT_EQ(lines_of("a\n"), std::vector<std::string_view>{"a"});
  EXPECT_TRUE(lines_of("").empty());
}

}  // namespace
}  // namespace mauve::ctl
