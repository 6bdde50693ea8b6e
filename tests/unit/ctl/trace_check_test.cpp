// SPDX-License-Identifier: LGPL-3.0-or-later
// check-trace: what obeys the model passes, and each way to break it is found, in the right words.
#include "mtrace/check.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "unit/ctl/made_trace.h"

namespace mauve::ctl::mtrace {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kMs = 1'000'000;

Trace made(unsigned seed, int load = 55) { return MadeTrace(seed).make(6, 300 * kMs, 4, load); }

/// The records of one thread, by place.
std::vector<std::size_t> places_of(const Trace& trace, std::string_view thread, Event event) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < trace.records.size(); ++i) {
    const Record& record = trace.records[i];
    if (record.event == event && trace.text(record.thread) == thread) places.push_back(i);
  }
  return places;
}

std::size_t next_of(const Trace& trace, std::size_t after, Event event) {
  for (std::size_t i = after + 1; i < trace.records.size(); ++i) {
    const Record& record = trace.records[i];
    if (record.event == event && record.thread == trace.records[after].thread) return i;
  }
  return trace.records.size();
}

/// Breaks a trace of each of some seeds; each time that rule is the first that is broken.
void expect_found(std::string_view rule, std::string_view words,
                  const std::function<bool(Trace&)>& break_it) {
  int broken = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Trace trace = made(seed);
    if (!break_it(trace)) continue;
    ++broken;
    const Verdict verdict = check(trace);
    ASSERT_FALSE(verdict.holds()) << "seed " << seed;
    EXPECT_EQ(verdict.first->rule, rule) << "seed " << seed << "\n" << first_violation(verdict);
    EXPECT_THAT(verdict.first->message, HasSubstr(std::string(words))) << "seed " << seed;
    EXPECT_GT(verdict.first->line, 1U);
    EXPECT_FALSE(verdict.first->hint.empty());
  }
  EXPECT_GE(broken, 10) << "the test found too little to break";
}

TEST(TraceCheck, PassesWhatObeysTheModel) {
  Checked sum;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const Verdict verdict = check(made(seed, seed % 3 == 0 ? 90 : 55));
    ASSERT_TRUE(verdict.holds()) << "seed " << seed << "\n" << first_violation(verdict);
    sum.releases += verdict.checked.releases;
    sum.waits += verdict.checked.waits;
    sum.orders += verdict.checked.orders;
    sum.takes += verdict.checked.takes;
  }
  EXPECT_GT(sum.releases, 20'000U);
  EXPECT_GT(sum.waits, 20'000U);
  EXPECT_GT(sum.orders, 1'000U);
  EXPECT_GT(sum.takes, 500U);
}

TEST(TraceCheck, FindsALostRelease) {
  expect_found("lost", "lost a release: its wait announced", [](Trace& trace) {
    const auto releases = places_of(trace, "c0", Event::release);
    const std::size_t from = releases[releases.size() / 2];
    const std::size_t to = next_of(trace, from, Event::wait);
    const std::size_t before = releases[releases.size() / 2 - 1];
    // With a change applied there the job after it would break the cut as well.
    if (to == trace.records.size() || next_of(trace, before, Event::applied) < to) return false;
    const Word thread = trace.records[from].thread;
    std::vector<Record> kept;
    for (std::size_t i = 0; i < trace.records.size(); ++i) {
      const bool lost = i >= from && i <= to && trace.records[i].thread == thread;
      if (!lost) kept.push_back(trace.records[i]);
    }
    trace.records = std::move(kept);
    return true;
  });
}

TEST(TraceCheck, FindsAnInstantThatIsShifted) {
  for (const std::int64_t by : {-1'000, -1, 1, 1'000}) {
    expect_found("release", "its wait announced", [&](Trace& trace) {
      const auto releases = places_of(trace, "c0", Event::release);
      const std::size_t place = releases[releases.size() / 2];
      const std::size_t wait = next_of(trace, place, Event::wait);
      if (wait == trace.records.size()) return false;
      trace.records[place].a += by;
      trace.records[wait].a += by;  // the wait is as long as it was
      return true;
    });
  }
}

TEST(TraceCheck, FindsAWaitThatIsCountedFromNow) {
  expect_found("wait", "and that state", [](Trace& trace) {
    const auto waits = places_of(trace, "c0", Event::wait);
    trace.records[waits[waits.size() / 2]].a += 17'000;
    return true;
  });
}

TEST(TraceCheck, FindsAJobThatBeganBeforeItsRelease) {
  expect_found("release", "before its release", [](Trace& trace) {
    const auto releases = places_of(trace, "c0", Event::release);
    Record& release = trace.records[releases[releases.size() / 2]];
    release.time = release.a - 1;
    return true;
  });
}

/// At most so many jobs of the less urgent c2 begin first; returns how many could.
std::size_t swap_jobs(Trace& trace, std::size_t most) {
  std::size_t pairs = 0;
  for (const std::size_t urgent : places_of(trace, "c0", Event::release)) {
    for (const std::size_t other : places_of(trace, "c2", Event::release)) {
      const Record& first = trace.records[urgent];
      Record& second = trace.records[other];
      // The first release of all, and one after a late job, excuse a lot.
      if (second.a != first.a || first.time - first.a != 6'000 || first.a == 0) continue;
      if (pairs++ < most) second.time = first.time - 1'000;
    }
  }
  return pairs;
}

TEST(TraceCheck, FindsALessUrgentJobThatBeganFirst) {
  expect_found("order", "(priority 78) began",
               [](Trace& trace) { return swap_jobs(trace, 1'000) > 1; });
}

TEST(TraceCheck, LeavesOneOfManyPairsToTheTimersOfTheKernelAndNotMore) {
  int judged = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Trace trace = MadeTrace(seed).make(6, 1'000 * kMs, 4, 55);
    if (swap_jobs(trace, 1) < 20) continue;
    ++judged;

    const Verdict verdict = check(trace);
    ASSERT_TRUE(verdict.holds()) << "seed " << seed << "\n" << first_violation(verdict);
    EXPECT_THAT(verdict.not_checked, testing::Contains(HasSubstr("released together")));

    swap_jobs(trace, 1'000'000);
    EXPECT_EQ(check(trace).first->rule, "order");
  }
  EXPECT_GE(judged, 1) << "the test found too little to break";
}

TEST(TraceCheck, FindsAChangeThatIsAppliedLate) {
  expect_found("cut", "took change", [](Trace& trace) {
    const auto takes = places_of(trace, "c0", Event::applied);
    if (takes.empty()) return false;
    const std::size_t place = takes.front();
    const std::size_t late = next_of(trace, place, Event::wait);
    if (late == trace.records.size() || next_of(trace, place, Event::applied) < late) return false;
    Record applied = trace.records[place];
    applied.time = trace.records[late].time;
    trace.records.insert(trace.records.begin() + static_cast<std::ptrdiff_t>(late) + 1, applied);
    trace.records.erase(trace.records.begin() + static_cast<std::ptrdiff_t>(place));
    return true;
  });
}

TEST(TraceCheck, FindsAChangeThatIsAppliedEarly) {
  expect_found("cut", "early", [](Trace& trace) {
    const auto takes = places_of(trace, "c0", Event::applied);
    if (takes.empty()) return false;
    const std::size_t place = takes.front();
    std::size_t before = trace.records.size();  // the last job that ran without it
    for (const std::size_t release : places_of(trace, "c0", Event::release)) {
      if (release < place) before = release;
    }
    if (before == trace.records.size()) return false;
    Record applied = trace.records[place];
    applied.time = trace.records[before].time;
    trace.records.erase(trace.records.begin() + static_cast<std::ptrdiff_t>(place));
    trace.records.insert(trace.records.begin() + static_cast<std::ptrdiff_t>(before), applied);
    return true;
  });
}

TEST(TraceCheck, FindsAMemberThatNeverTookAChange) {
  expect_found("cut", "never took change", [](Trace& trace) {
    const auto takes = places_of(trace, "c0", Event::applied);
    if (takes.empty()) return false;
    trace.records.erase(trace.records.begin() + static_cast<std::ptrdiff_t>(takes.front()));
    return true;
  });
}

TEST(TraceCheck, FindsTwoInstantsOfOneChange) {
  expect_found("cut", "with the instant", [](Trace& trace) {
    const auto takes = places_of(trace, "c0", Event::applied);
    const auto others = places_of(trace, "c1", Event::applied);
    if (takes.empty() || others.empty()) return false;
    if (trace.records[takes.front()].b != trace.records[others.front()].b) return false;
    --trace.records[takes.front()].a;
    return true;
  });
}

TEST(TraceCheck, FindsAChangeThatIsAppliedThoughAborted) {
  expect_found("cut", "which was aborted", [](Trace& trace) {
    const auto commits = places_of(trace, "[control]", Event::commit);
    const auto takes = places_of(trace, "c0", Event::applied);
    if (takes.empty() || trace.records[takes.front()].b != 1) return false;
    Record abort = trace.records[commits.front()];
    abort.event = Event::abort;
    trace.records.insert(trace.records.begin() + static_cast<std::ptrdiff_t>(commits.front()) + 1,
                         abort);
    return true;
  });
}

TEST(TraceCheck, FindsAResponseThatIsTooLong) {
  expect_found("response", "were admitted", [](Trace& trace) {
    const auto releases = places_of(trace, "c0", Event::release);
    const std::size_t place = releases[releases.size() / 2];
    const std::size_t wait = next_of(trace, place, Event::wait);
    if (wait == trace.records.size()) return false;
    Component& c0 = trace.header.components[0];
    c0.bound = 0;
    for (const std::size_t release : releases) {
      const std::size_t end = next_of(trace, release, Event::wait);
      if (end == trace.records.size() || release == place) continue;
      c0.bound = std::max(*c0.bound, trace.records[end].time - trace.records[release].a);
    }
    trace.records[wait].time = trace.records[place].a + *c0.bound + 250'000;
    return true;
  });
}

TEST(TraceCheck, FindsStatesThatNoMachineHas) {
  expect_found("state", "which had not begun", [](Trace& trace) {
    const auto begins = places_of(trace, "c0", Event::begin);
    trace.records.erase(trace.records.begin() +
                        static_cast<std::ptrdiff_t>(begins[begins.size() / 2]));
    return true;
  });
  expect_found("state", "a state that its machine does not have", [](Trace& trace) {
    const auto begins = places_of(trace, "c0", Event::begin);
    const Word other = trace.intern("fly");
    trace.records[begins.back()].name = other;
    const std::size_t end = next_of(trace, begins.back(), Event::end);
    if (end < trace.records.size()) trace.records[end].name = other;
    return true;
  });
  expect_found("state", "had not ended", [](Trace& trace) {
    const auto waits = places_of(trace, "c0", Event::wait);
    trace.records.erase(trace.records.begin() +
                        static_cast<std::ptrdiff_t>(waits[waits.size() / 2]));
    return true;
  });
}

/// A component of 5 ms, whose offset becomes 2 ms and 0 again between two jobs: each time its
/// release is the first of the new grid. The last of its records is the release at this instant.
Trace with_an_offset_that_changes_twice(std::int64_t release) {
  Trace trace;
  auto& component = trace.header.components.emplace_back();
  component.name = "c";
  component.period = 5 * kMs;
  append_record(trace, 5 * kMs, "c", Event::release, "", 5 * kMs, 1);
  append_record(trace, 5 * kMs, "c", Event::wait, "period", 10 * kMs, 0);
  for (const std::int64_t moved : {12 * kMs, 15 * kMs}) {
    append_record(trace, 6 * kMs, "c", Event::applied, "change", 6 * kMs, 2);
    append_record(trace, 6 * kMs, "c", Event::started, "", moved, 0);
  }
  append_record(trace, release, "c", Event::release, "", release, 2);
  return trace;
}

/// The records of [control] about a change may come later than its instant, which lies before the
/// trace.
TEST(TraceCheck, PassesAChangeThatWasAppliedBeforeTheTraceBegins) {
  Trace trace;
  trace.header.components.emplace_back().name = "c";
  append_record(trace, 10 * kMs, "c", Event::release, "", 10 * kMs, 7);
  append_record(trace, 10 * kMs, "c", Event::wait, "period", 15 * kMs, 0);
  append_record(trace, 12 * kMs, "[control]", Event::rollback, "core.swap c", 9 * kMs, 7);
  append_record(trace, 12 * kMs, "[control]", Event::member, "c", 0, 7);
  append_record(trace, 15 * kMs, "c", Event::release, "", 15 * kMs, 7);

  const Verdict verdict = check(trace);

  EXPECT_TRUE(verdict.holds()) << first_violation(verdict);
}

TEST(TraceCheck, FollowsAnOffsetThatChangesTwiceBetweenTwoJobs) {
  const Verdict follows = check(with_an_offset_that_changes_twice(15 * kMs));
  EXPECT_TRUE(follows.holds()) << first_violation(follows);

  EXPECT_FALSE(check(with_an_offset_that_changes_twice(20 * kMs)).holds());
}

TEST(TraceCheck, FindsAJobThatEndsWithALock) {
  expect_found("lock", "still holds world", [](Trace& trace) {
    const auto unlocks = places_of(trace, "c0", Event::unlock);
    trace.records.erase(trace.records.begin() +
                        static_cast<std::ptrdiff_t>(unlocks[unlocks.size() / 2]));
    return true;
  });
}

}  // namespace
}  // namespace mauve::ctl::mtrace
