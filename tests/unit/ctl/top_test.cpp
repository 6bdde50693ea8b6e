// SPDX-License-Identifier: LGPL-3.0-or-later
/// Rows, keys and pictures of top, without a terminal.
#include "top/top.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "render/table.h"
#include "unit/ctl/top_answers.h"

namespace mauve::ctl {
namespace {

std::vector<TopRow> rows() { return top_rows(top_answers(), {}); }

std::vector<std::string> names(const std::vector<TopRow>& rows) {
  std::vector<std::string> all;
  for (const TopRow& row : rows) all.push_back(row.name);
  return all;
}

void type(TopView& view, std::string_view bytes) {
  for (const Key& key : keys_in(bytes)) press(view, key, arranged(rows(), view));
}

std::vector<std::string> frame(const TopView& view, Extent extent, bool colour = false) {
  return top_frame({"rover: 3 of 4 components running", arranged(rows(), view), nullptr, 0}, view,
                   extent, colour);
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

TEST(TopRows, BringStateAndStatisticsTogether) {
  const TopRow control = rows().at(0);

  EXPECT_EQ(control.name, "control");
  EXPECT_EQ(control.state, "reach_goal");
  EXPECT_EQ(control.core, "guidance/gap@1.2");
  EXPECT_EQ(control.cpus, "0,1");
  EXPECT_EQ(control.late_last, 12'345);
  EXPECT_EQ(control.execution_p99, 40'000);
  EXPECT_EQ(control.missed, 2);
  EXPECT_FALSE(control.unfinished);
  EXPECT_TRUE(rows().at(1).unfinished) << "its next release has passed";
  EXPECT_EQ(rows().at(2).state, "faulted");
  EXPECT_FALSE(rows().at(3).elapsed_last) << "it never ran";
}

TEST(TopRows, ShowHowBusyItWasSinceTheLastAnswer) {
  const TopData before = top_answers();
  TopData now = before;
  now.statistics["t_ns"] = number_of(before.statistics, "t_ns") + 1e9;
  now.statistics["components"][0]["execution"]["sum_ns"] = 200'000'000 + 250'000'000;
  TopData anew = now;
  anew.statistics["components"][0]["since_ns"] = number_of(before.statistics, "t_ns") + 5e8;
  anew.statistics["components"][0]["execution"]["sum_ns"] = 50'000'000;

  EXPECT_NEAR(top_rows(before, {})[0].busy.value(), 0.03, 1e-9) << "since it is counted";
  EXPECT_NEAR(top_rows(now, before)[0].busy.value(), 0.25, 1e-9);
  EXPECT_NEAR(top_rows(anew, before)[0].busy.value(), 0.3, 1e-9) << "with what came between";
}

TEST(TopRows, ShowHowOftenAComponentReallyRuns) {
  const TopData before = top_answers();
  TopData now = before;
  now.statistics["t_ns"] = number_of(before.statistics, "t_ns") + 1e9;
  const auto jobs = number_of(before.statistics["components"][0]["lateness"], "count");
  const auto every = [&](double more) {
    now.statistics["components"][0]["lateness"]["count"] = jobs + more;
    return top_rows(now, before)[0].every;
  };
  const double grid = number_of(before.status["components"][0], "period_ns");

  EXPECT_EQ(every(1e9 / grid - 1), grid) << "the second does not begin at a release";
  EXPECT_NEAR(every(10), 1e8, 1) << "ten jobs in a second, whatever the grid";
}

TEST(TopRows, SurviveAnswersOfAnotherShape) {
  EXPECT_TRUE(top_rows({}, {}).empty());
  const TopData odd{Json::parse(R"({"components": [{"name": 3, "cpus": "x"}, 5, null]})"),
                    Json::parse(R"({"components": [{"name": "3", "execution": 7}]})")};
  EXPECT_EQ(top_rows(odd, odd).size(), 3U);
}

TEST(TopSorting, PutsTheGreatestFirstAndNamesLast) {
  TopView view;
  EXPECT_EQ(names(arranged(rows(), view)),
            (std::vector<std::string>{"laser", "control", "driver", "spare"}));
  view.sort = TopSort::name;
  EXPECT_EQ(names(arranged(rows(), view)),
            (std::vector<std::string>{"control", "driver", "laser", "spare"}));
  view.sort = TopSort::missed;
  EXPECT_EQ(names(arranged(rows(), view))[0], "control");
  view.sort = TopSort::execution;
  EXPECT_EQ(names(arranged(rows(), view)).back(), "spare") << "nothing is less than any time";
}

TEST(TopKeys, AreReadFromTheSequencesOfATerminal) {
  const auto keys = keys_in("s\033[A\033OB\033[5~\r\x7f\033");

  ASSERT_EQ(keys.size(), 6U);
  EXPECT_EQ(keys[0].character, 's');
  EXPECT_EQ(keys[1].kind, Key::Kind::up);
  EXPECT_EQ(keys[2].kind, Key::Kind::down);
  EXPECT_EQ(keys[3].kind, Key::Kind::enter);
  EXPECT_EQ(keys[4].kind, Key::Kind::erase);
  EXPECT_EQ(keys[5].kind, Key::Kind::escape);
}

TEST(TopKeys, GoThroughTheOrdersAndBack) {
  TopView view;
  type(view, "s");
  EXPECT_EQ(view.sort, TopSort::name);
  type(view, "sssss");
  EXPECT_EQ(view.sort, TopSort::priority);
  type(view, "B");
  EXPECT_EQ(view.sort, TopSort::busy);
}

TEST(TopKeys, FilterWhileTheyAreTyped) {
  TopView view;
  type(view, "fLAS");
  EXPECT_TRUE(view.typing);
  EXPECT_EQ(names(arranged(rows(), view)), std::vector<std::string>{"laser"});
  type(view, "\x7f\x7f\x7fq\r");
  EXPECT_EQ(view.filter, "q") << "within a filter it does not quit";
  EXPECT_TRUE(arranged(rows(), view).empty());
  EXPECT_FALSE(view.quit);
  type(view, "\033");
  EXPECT_EQ(view.filter, "");
  type(view, "q");
  EXPECT_TRUE(view.quit);
}

TEST(TopKeys, SelectAndShowDetails) {
  TopView view;
  type(view, "\033[B\033[B");
  EXPECT_EQ(view.selected, "driver");
  type(view, "\033[B\033[B\033[B\033[A");
  EXPECT_EQ(view.selected, "driver") << "not beyond the last";
  type(view, "\r");
  EXPECT_TRUE(view.details);
  type(view, "d");
  EXPECT_FALSE(view.details);
  type(view, "p?x");
  EXPECT_TRUE(view.paused);
  EXPECT_FALSE(view.help);
}

TEST(TopFrame, KeepsTheNamesOfCoresWholeAtEveryWidth) {
  for (std::size_t width = 40; width <= 140; ++width) {
    const auto lines = frame({}, {width, 24});
    for (const std::string& line : lines) EXPECT_EQ(line.find("…r"), std::string::npos) << line;
    if (lines[2].find("CORE") == std::string::npos) continue;
    for (const TopRow& row : rows()) {
      EXPECT_NE(joined(lines).find(row.core), std::string::npos) << joined(lines);
    }
  }
}

TEST(TopFrame, ShowsEveryColumnOn100) {
  const auto lines = frame({}, {100, 24});

  ASSERT_EQ(lines.size(), 24U);
  EXPECT_EQ(lines[0], "rover: 3 of 4 components running");
  for (const char* title : {"NAME", "STATE", "PR/CPU", "EVERY", "WAIT", "WMAX", "EXEC", "P99",
                            "EMAX", "BUSY", "MISS", "OVER", "CORE"}) {
    EXPECT_NE(lines[2].find(title), std::string::npos) << title << " in " << lines[2];
  }
  EXPECT_NE(lines[3].find(">laser"), std::string::npos) << lines[3];
  EXPECT_NE(lines[3].find("+++"), std::string::npos) << lines[3];
  EXPECT_NE(lines[23].find("q quit"), std::string::npos);
}

TEST(TopFrame, ShowsTheCoreOn80BeforeLessImportantColumns) {
  EXPECT_NE(frame({}, {80, 24})[2].find("CORE"), std::string::npos);
}

TEST(TopFrame, FitsEveryTerminal) {
  for (const bool help : {false, true}) {
    for (std::size_t width = 1; width <= 160; ++width) {
      for (const std::size_t height : {1U, 2U, 3U, 4U, 5U, 8U, 24U}) {
        TopView view;
        view.help = help;
        view.selected = "spare";
        const auto lines = frame(view, {width, height});
        EXPECT_LE(lines.size(), height);
        for (const std::string& line : lines) EXPECT_LE(columns(line), width) << line;
      }
    }
  }
}

TEST(TopFrame, KeepsNameAndStateOn20Columns) {
  const std::string text = joined(frame({}, {20, 10}));

  EXPECT_NE(text.find(">laser"), std::string::npos) << text;
  EXPECT_NE(text.find(" control reach_goal\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("CORE"), std::string::npos) << text;
}

TEST(TopFrame, KeepsTheSelectedRowInSight) {
  TopView view;
  view.selected = "spare";

  const std::string text = joined(frame(view, {80, 5}));

  EXPECT_NE(text.find(">spare"), std::string::npos) << text;
  EXPECT_NE(text.find("NAME"), std::string::npos) << text;
  EXPECT_EQ(text.find("laser"), std::string::npos) << text;
}

TEST(TopFrame, ShowsWhatIsChosen) {
  TopView view;
  view.interval = "1 s";
  type(view, "pBfla");

  const auto lines = frame(view, {80, 10});

  EXPECT_EQ(lines[1], "by busy, every 1 s, PAUSED");
  EXPECT_EQ(lines[9], "filter: la_");
  type(view, "\r");
  EXPECT_EQ(frame(view, {80, 10})[1], "by busy, every 1 s, with \"la\", PAUSED");
}

TEST(TopFrame, TakesEscapesOutOfNames) {
  TopData answers = top_answers();
  answers.status["components"][0]["name"] = "con\033[2Jtrol";
  const TopScene scene{"a\033b", top_rows(answers, {}), nullptr, 0};

  EXPECT_EQ(joined(top_frame(scene, {}, {100, 10}, false)).find('\033'), std::string::npos);
}

TEST(TopFrame, ShowsTheDetailsOfOne) {
  TopView view;
  type(view, "d");
  TopScene scene{"rover", arranged(rows(), view), nullptr, 61e9};
  scene.details = top_answers().statistics["components"][0];
  scene.details["states"] = Json::array();

  const std::string text = joined(top_frame(scene, view, {80, 24}, false));

  EXPECT_NE(text.find("counted for 10 s"), std::string::npos) << text;
  EXPECT_NE(text.find("response"), std::string::npos) << text;
}

}  // namespace
}  // namespace mauve::ctl
