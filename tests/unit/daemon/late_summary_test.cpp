// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/late_summary.h"

#include <gtest/gtest.h>

namespace mauve::daemon {
namespace {

constexpr Instant kSummarySecond = std::chrono::nanoseconds(1s).count();

RuntimeEvent missed(Instant time, int releases, int in_all, const std::string& component = "arm") {
  return {time, LogLevel::warning, component, "missed",
          std::to_string(releases) + " releases missed, " + std::to_string(in_all) + " in all"};
}

TEST(LateSummary, ReportsTheFirstMissAtOnceAndTheOthersInOneLine) {
  LateSummary summary;
  EXPECT_TRUE(summary.pass(missed(kSummarySecond, 1, 1)));
  for (int i = 0; i < 8; ++i) {
    EXPECT_FALSE(summary.pass(missed((2 + i) * kSummarySecond, 3, 4 + 3 * i)));
  }
  EXPECT_TRUE(summary.due(10 * kSummarySecond).empty());

  const auto lines = summary.due(11 * kSummarySecond);

  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].component, "arm");
  EXPECT_EQ(lines[0].event, "missed");
  EXPECT_EQ(lines[0].text, "24 more releases missed in 10 s, 25 in all");
  EXPECT_EQ(lines[0].time, 11 * kSummarySecond) << "not that of the last miss";
  EXPECT_TRUE(summary.due(12 * kSummarySecond).empty()) << "once";
}

TEST(LateSummary, ComesEachTenSecondsWhileAComponentIsLateAllTheTime) {
  LateSummary summary;
  std::size_t lines = 0;
  for (Instant now = 0; now < 60 * kSummarySecond; now += kSummarySecond / 100) {
    lines += summary.pass(missed(now, 1, 1)) ? 1U : 0U;
    lines += summary.due(now).size();
  }
  EXPECT_EQ(lines, 6U) << "of 6000";
}

TEST(LateSummary, ReportsASingleMissNowAndThenAtOnce) {
  LateSummary summary;
  for (Instant now = 0; now < 100 * kSummarySecond; now += 10 * kSummarySecond) {
    EXPECT_TRUE(summary.pass(missed(now, 1, 1)));
    EXPECT_TRUE(summary.due(now + kSummarySecond).empty());
  }
}

TEST(LateSummary, CountsComponentsAndEventsApart) {
  LateSummary summary;
  EXPECT_TRUE(summary.pass(missed(kSummarySecond, 1, 1)));
  EXPECT_TRUE(summary.pass(missed(kSummarySecond, 1, 1, "leg")));
  const RuntimeEvent late{kSummarySecond, LogLevel::warning, "arm", "overrun",
                          "job ended 3.01 ms late, overrun 17"};
  EXPECT_TRUE(summary.pass(late));
  EXPECT_FALSE(summary.pass(late));

  const auto lines = summary.due(11 * kSummarySecond);

  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].text, "1 more job ended late in 10 s, overrun 17");
}

TEST(LateSummary, IsFinishedWhenTheComponentStops) {
  LateSummary summary;
  for (const char* component : {"arm", "leg"}) {
    EXPECT_TRUE(summary.pass(missed(kSummarySecond, 1, 1, component)));
    EXPECT_FALSE(summary.pass(missed(2 * kSummarySecond, 1, 2, component)));
  }

  const auto lines = summary.finish("arm", 3 * kSummarySecond);

  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].text, "1 more release missed in 2 s, 2 in all");
  EXPECT_TRUE(summary.finish("arm", 3 * kSummarySecond).empty());
}

TEST(LateSummary, CountsComponentsThatMissReleasesTogetherOnceInTenSeconds) {
  LateSummary summary;
  const auto miss = [&](Instant time, const std::string& component) {
    static_cast<void>(summary.pass(missed(time, 1, 1, component)));
  };
  constexpr Instant kMs = kSummarySecond / 1000;
  miss(kSummarySecond, "arm");
  miss(kSummarySecond + 1 * kMs, "leg");
  miss(kSummarySecond + 30 * kMs, "head");
  EXPECT_EQ(summary.missed_together(), 0U) << "two at one time, and one later";

  miss(kSummarySecond + 35 * kMs, "arm");
  miss(kSummarySecond + 50 * kMs, "leg");
  EXPECT_EQ(summary.missed_together(), 3U);
  EXPECT_EQ(summary.missed_together(), 0U) << "once";

  for (const char* component : {"arm", "leg", "head"}) {
    miss(9 * kSummarySecond, component);
  }
  EXPECT_EQ(summary.missed_together(), 0U) << "too soon";
  for (const char* component : {"arm", "leg", "head"}) {
    miss(12 * kSummarySecond, component);
  }
  EXPECT_EQ(summary.missed_together(), 3U);
}

/// The count of three components that miss a release at the second second.
std::size_t together_after(LateSummary& summary) {
  for (const char* component : {"arm", "leg", "head"}) {
    static_cast<void>(summary.pass(missed(2 * kSummarySecond, 1, 1, component)));
  }
  return summary.missed_together();
}

TEST(LateSummary, DoesNotSuspectTheMachineAfterAJobThatTookTooLong) {
  RuntimeEvent overrun{2 * kSummarySecond - 1, LogLevel::warning, "arm", "overrun",
                       "job ended 40 ms late, overrun 1"};
  LateSummary of_short;
  static_cast<void>(of_short.pass(overrun));
  EXPECT_EQ(together_after(of_short), 3U) << "it ended late only because it began late";

  overrun.long_job = true;
  LateSummary of_long;
  static_cast<void>(of_long.pass(overrun));
  EXPECT_EQ(together_after(of_long), 0U);

  overrun.time = kSummarySecond - 1;
  LateSummary long_ago;
  static_cast<void>(long_ago.pass(overrun));
  EXPECT_EQ(together_after(long_ago), 3U);
}

TEST(LateSummary, DoesNotSuspectTheMachineAfterAFailure) {
  LateSummary summary;
  summary.failed(2 * kSummarySecond);
  EXPECT_EQ(together_after(summary), 0U);
}

TEST(LateSummary, ConcernsNothingElse) {
  EXPECT_TRUE(LateSummary::concerns(missed(0, 1, 1)));
  EXPECT_FALSE(LateSummary::concerns({0, LogLevel::error, "arm", "faulted", "threw"}));
}

}  // namespace
}  // namespace mauve::daemon
