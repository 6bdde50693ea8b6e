// SPDX-License-Identifier: LGPL-3.0-or-later
// The timeline: which part of a trace it shows, what it draws, and that it stays small.
#include "mtrace/timeline.h"

#include <algorithm>
#include <string>

#include <gmock/gmock.h>

#include "mtrace/scene.h"
#include "unit/ctl/made_trace.h"
#include "unit/ctl/svg_reader.h"

namespace mauve::ctl::mtrace {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kMilli = 1'000'000;
constexpr double kPixel = 1e-3;

/// "low" of 20 ms that works for 10 ms, "high" of 10 ms that works for 2 ms, on one processor.
struct Two {
  Trace trace;

  Two() {
    add_component("low", 20, 20 * kMilli);
    add_component("high", 40, 10 * kMilli);
    trace.reading.complete = true;
    for (std::int64_t at = 0; at < 40 * kMilli; at += 10 * kMilli) {
      job("high", at, at, at + 2 * kMilli, 10);
    }
    job("low", 0, 2 * kMilli, 14 * kMilli, 20);
    job("low", 20 * kMilli, 22 * kMilli, 34 * kMilli, 20);
  }
  void add_component(const char* name, std::int64_t priority, std::int64_t period) {
    Component made;
    made.name = name;
    made.priority = priority;
    made.cpus = {1};
    made.realtime = true;
    made.period = period;
    made.states = {{"work", false, 0}, {"pace", true, period}};
    trace.header.components.push_back(made);
  }
  void add(std::int64_t time, const char* thread, Event event, const char* name = "",
           std::int64_t a = 0, std::int64_t b = 0) {
    append_record(trace, time, thread, event, name, a, b);
  }
  void job(const char* name, std::int64_t release, std::int64_t from, std::int64_t to,
           std::int64_t period) {
    add(from, name, Event::release, "", release);
    add(from, name, Event::begin, "work");
    add(to, name, Event::end, "work");
    add(to, name, Event::wait, "pace", release + period * kMilli);
  }
};

TEST(Timeline, HasTheMostUrgentTaskOnTop) {
  const Timeline drawn = draw_timeline(Two().trace, {});

  EXPECT_LT(drawn.svg.find(">high<"), drawn.svg.find(">low<"));
  EXPECT_THAT(drawn.svg, HasSubstr("priority 40, CPU 1, 10ms"));
  EXPECT_THAT(drawn.svg, HasSubstr(">T0</text>"));
  EXPECT_THAT(drawn.svg, HasSubstr(">time since T0 [ms]</text>"));
}

TEST(Timeline, DrawsAnArrowForEachRelease) {
  // The one that the last job announced is drawn as well.
  EXPECT_EQ(count_in(draw_timeline(Two().trace, {}).svg, "<title>release of"), 6U);
}

TEST(Timeline, CutsABoxWhereAMoreUrgentTaskRuns) {
  const Two two;
  const Scene scene = scene_of(two.trace, {}, kPixel);
  const auto& boxes = scene.rows.at(1).boxes;

  ASSERT_EQ(boxes.size(), 6U);
  EXPECT_EQ(boxes[0].piece, Piece::runs);
  EXPECT_EQ(boxes[0].to, 10 * kMilli);
  EXPECT_EQ(boxes[1].piece, Piece::preempted);
  EXPECT_EQ(boxes[1].to, 12 * kMilli);
  EXPECT_EQ(boxes[2].piece, Piece::runs);
  EXPECT_EQ(boxes[2].to, 14 * kMilli);
}

TEST(Timeline, TaskOnOtherProcessorsPreemptNobody) {
  Two two;
  two.trace.header.components[1].cpus = {0};

  EXPECT_THAT(draw_timeline(two.trace, {}).svg, Not(HasSubstr("class=\"preempted\" ")));
}

TEST(Timeline, MarksWaitsForLocksAndHolds) {
  Two two;
  two.trace.records.clear();
  two.add(1 * kMilli, "low", Event::release, "", 1 * kMilli);
  two.add(1 * kMilli, "low", Event::begin, "work");
  two.add(4 * kMilli, "low", Event::lock, "world", 2 * kMilli);
  two.add(5 * kMilli, "low", Event::unlock, "world", 1 * kMilli);
  two.add(6 * kMilli, "low", Event::end, "work");
  two.add(6 * kMilli, "low", Event::wait, "pace", 21 * kMilli);
  const std::string svg = draw_timeline(two.trace, {}).svg;

  EXPECT_EQ(count_in(svg, "class=\"blocked\"><title>"), 1U);
  EXPECT_THAT(svg, HasSubstr("low holds world for 1.0 ms"));
  EXPECT_THAT(svg, HasSubstr(">waits for a lock</text>")) << "the legend explains it";
}

TEST(Timeline, MarksWhatHappened) {
  Two two;
  two.add(9 * kMilli, "[control]", Event::prepare, "core.swap low", 0, 1);
  two.add(11 * kMilli, "[control]", Event::commit, "core.swap low", 15 * kMilli, 1);
  two.add(20 * kMilli, "low", Event::applied, "change", 15 * kMilli, 1);
  two.add(25 * kMilli, "[control]", Event::rollback, "core.swap low", 26 * kMilli, 1);
  two.add(31 * kMilli, "high", Event::fault, "threw");
  two.add(34 * kMilli, "low", Event::overrun, "", 1 * kMilli, 1);
  two.add(36 * kMilli, "low", Event::missed, "", 2, 2);
  two.add(35 * kMilli, "[probe]", Event::disturbed, "", 1 * kMilli);
  two.add(37 * kMilli, "low", Event::user, "gain<", 0, std::bit_cast<std::int64_t>(0.25));
  const std::string svg = draw_timeline(two.trace, {}).svg;

  EXPECT_THAT(svg, HasSubstr(">change 1: core.swap low</text>"));
  EXPECT_THAT(svg, HasSubstr(">rollback 1: core.swap low</text>"));
  EXPECT_THAT(svg, HasSubstr("low takes change 1 (change)"));
  EXPECT_THAT(svg, HasSubstr("high: threw"));
  EXPECT_THAT(svg, HasSubstr("low ended 1.0 ms after its deadline"));
  EXPECT_THAT(svg, HasSubstr(">2 missed</text>"));
  EXPECT_THAT(svg, HasSubstr("class=\"disturbed\"><title>"));
  EXPECT_THAT(svg, HasSubstr("gain&lt; = 0.25"));
  EXPECT_THAT(svg, HasSubstr("prepared core.swap low in 2.0 ms"));
}

/// A trace in which the job for 10 ms ends at 60.1 ms, kept for the misses that follow.
Trace made_late() {
  Two two;
  two.trace.records.clear();
  two.job("high", 0, 0, 1 * kMilli, 10);
  two.job("high", 10 * kMilli, 10 * kMilli, 60 * kMilli + 100'000, 10);
  // The record and the next job have the same time.
  two.add(60 * kMilli + 110'000, "high", Event::missed, "", 4, 4);
  two.job("high", 60 * kMilli, 60 * kMilli + 110'000, 61 * kMilli, 10);
  for (std::int64_t at = 70 * kMilli; at < 120 * kMilli; at += 10 * kMilli) {
    two.job("high", at, at, at + kMilli, 10);
  }
  two.trace.header.why = "missed high";
  return two.trace;
}

TEST(Timeline, DrawsMissedReleasesAtTheInstantsAtWhichNoJobRan) {
  View all;
  all.from = 0;
  const std::string svg = draw_timeline(made_late(), all).svg;

  EXPECT_EQ(count_in(svg, "<title>missed release for "), 4U);
  for (const char* at : {"0.020", "0.030", "0.040", "0.050"}) {
    EXPECT_THAT(svg, HasSubstr("missed release for T0 + " + std::string(at) + "000000 s"));
    EXPECT_THAT(svg, Not(HasSubstr("release of high for T0 + " + std::string(at))));
  }
  EXPECT_THAT(svg, HasSubstr(">4 missed</text>"));
}

TEST(Timeline, DrawsNoMissedReleaseWhereAStartCameBetween) {
  Two two;
  two.add(40 * kMilli, "high", Event::stopped);
  two.add(50 * kMilli, "high", Event::started, "", 60 * kMilli);
  two.add(85 * kMilli, "high", Event::missed, "", 2, 2);
  const std::string svg = draw_timeline(two.trace, {}).svg;

  EXPECT_EQ(count_in(svg, "<title>missed release for "), 0U);
  EXPECT_THAT(svg, HasSubstr(">2 missed</text>"));
}

TEST(Timeline, BeginsBeforeTheReleaseOfTheJobThatIsTheCauseOfAMiss) {
  Trace trace = made_late();
  EXPECT_LT(draw_timeline(trace, {}).from, 10 * kMilli);

  // The culprit is more urgent than the component whose releases are missed.
  Two two;
  two.trace.records.clear();
  two.job("low", 0, 0, 1 * kMilli, 20);
  two.job("high", 190 * kMilli, 190 * kMilli, 360 * kMilli, 10);
  two.job("low", 200 * kMilli, 360 * kMilli, 361 * kMilli, 20);
  two.add(361 * kMilli, "low", Event::missed, "", 7, 7);
  two.job("low", 360 * kMilli, 361 * kMilli, 362 * kMilli, 20);
  for (std::int64_t at = 380 * kMilli; at < 500 * kMilli; at += 20 * kMilli) {
    two.job("low", at, at, at + kMilli, 20);
  }
  two.trace.header.why = "missed low";
  EXPECT_LT(draw_timeline(two.trace, {}).from, 190 * kMilli);
}

TEST(Timeline, ShowsTheLastJobsOfTheMostFrequentComponentWhereNothingIsSaid) {
  const Trace trace = MadeTrace(3).make(4, 3000 * kMilli, 0, 50);
  const Timeline drawn = draw_timeline(trace, {});
  const Scene scene = scene_of(trace, {}, 0.0);

  std::size_t most = 0;
  for (const Lane& lane : scene.lanes) {
    most = std::max(most, static_cast<std::size_t>(std::ranges::count_if(
                              lane.jobs, [&](const Job& job) { return job.to >= scene.from; })));
  }
  EXPECT_GE(most, 40U) << "jobs to look at";
  EXPECT_LE(most, 60U) << "so that each is seen";
  EXPECT_LT(drawn.to - drawn.from, 1000 * kMilli);
  EXPECT_THAT(drawn.left_out, testing::Contains(HasSubstr("--from and --to choose")));
}

TEST(Timeline, ShowsFivePeriodsAroundWhyTheTraceWasKept) {
  Trace trace = MadeTrace(3).make(4, 3000 * kMilli, 0, 50);
  Record missed = trace.records[trace.records.size() / 2];
  missed.thread = trace.intern("c1");
  missed.event = Event::missed;
  missed.a = 1;
  const std::int64_t time = missed.time;
  trace.records.insert(
      trace.records.begin() + static_cast<std::ptrdiff_t>(trace.records.size() / 2), missed);
  trace.header.why = "missed c1";
  const Timeline drawn = draw_timeline(trace, {});

  EXPECT_LT(drawn.from, time);
  EXPECT_GT(drawn.to, time);
  EXPECT_LT(drawn.to - drawn.from, 450 * kMilli);
}

TEST(Timeline, ShowsWhatIsAskedFor) {
  View view;
  view.from = 5 * kMilli;
  view.to = 15 * kMilli;
  view.components = {"high", "hihg"};
  const Timeline drawn = draw_timeline(Two().trace, view);

  EXPECT_EQ(drawn.from, 5 * kMilli);
  EXPECT_EQ(drawn.to, 15 * kMilli);
  EXPECT_THAT(drawn.svg, Not(HasSubstr(">low<")));
  EXPECT_THAT(drawn.left_out, testing::Contains("the component hihg, which has no records in it"));
}

TEST(Timeline, SaysSinceWhenARowHasThePriorityOfItsLabel) {
  Trace trace = Two().trace;
  View view;
  view.from = 5 * kMilli;
  view.to = 15 * kMilli;
  for (Component& component : trace.header.components) {
    if (component.name == "high") component.scheduled = 8 * kMilli;
    if (component.name == "low") component.timed = 4 * kMilli;
  }

  const Timeline drawn = draw_timeline(trace, view);
  EXPECT_THAT(drawn.left_out,
              testing::Contains("the priority, CPU and period of high before T0 + 0.008000000 s, "
                                "which may be others than its row says"));
  EXPECT_THAT(drawn.left_out, Not(testing::Contains(HasSubstr("period of low"))));
}

TEST(Timeline, IsOfBoundedSizeAndSaysWhatItLeavesOut) {
  const Trace trace = MadeTrace(4).make(40, 2000 * kMilli, 8, 60);
  View all;
  all.from = 0;
  all.to = 2000 * kMilli;
  const Timeline drawn = draw_timeline(trace, all);

  EXPECT_LT(count_in(drawn.svg, "<rect"), kMostBoxes + 1000);
  EXPECT_LT(drawn.svg.size(), 3'000'000U);
  EXPECT_THAT(drawn.left_out, testing::Contains(HasSubstr("8 components that ran the least")));
  EXPECT_THAT(drawn.left_out, testing::Contains(HasSubstr("the states of ")));
  EXPECT_THAT(drawn.svg, HasSubstr(">several jobs</text>"));
}

TEST(Timeline, OfNothingIsAPicture) {
  const Timeline drawn = draw_timeline(Trace(), {});

  EXPECT_THAT(drawn.svg, testing::StartsWith("<svg "));
  EXPECT_THAT(drawn.svg, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace mauve::ctl::mtrace
