// SPDX-License-Identifier: LGPL-3.0-or-later
// check-trace: what excuses a component, and what cannot be judged.
#include <algorithm>
#include <optional>
#include <string>

#include <gmock/gmock.h>

#include "mtrace/check.h"
#include "unit/ctl/made_trace.h"

namespace mauve::ctl::mtrace {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kOneMs = 1'000'000;

// ---------------------------------------------------------------------------------

/// One component of 10 ms that always takes 1 ms.
struct Short {
  Trace trace;

  Short() {
    Component control;
    control.name = "control";
    control.realtime = true;
    control.period = 10 * kOneMs;
    control.bound = 2 * kOneMs;
    control.states = {{"guide", false, 0}, {"pace", true, 10 * kOneMs}};
    trace.header.components.push_back(control);
    trace.reading.complete = true;
  }
  Short& add(std::int64_t time, Event event, std::string_view name = {}, std::int64_t a = 0,
             std::int64_t b = 0, std::string_view thread = "control") {
    const auto line = static_cast<std::uint32_t>(trace.records.size()) + 2;
    append_record(trace, time, thread, event, name, a, b).line = line;
    return *this;
  }
  Short& job(std::int64_t release, std::int64_t length = 1 * kOneMs) {
    return add(release + 5, Event::release, {}, release)
        .add(release + 5 + length, Event::wait, "pace", release + 10 * kOneMs);
  }
  [[nodiscard]] Verdict verdict() const { return check(trace); }
};

TEST(TraceCheck, AcceptsAGapThatMissedReports) {
  EXPECT_TRUE(
      Short().job(0).add(35 * kOneMs, Event::missed, "", 2, 2).job(30 * kOneMs).verdict().holds());
  const Verdict wrong =
      Short().job(0).add(45 * kOneMs, Event::missed, "", 2, 2).job(40 * kOneMs).verdict();
  ASSERT_EQ(wrong.found, 1U);
  EXPECT_THAT(wrong.first->message, HasSubstr("what it missed"));
}

TEST(TraceCheck, BeginsAnewBehindLostRecords) {
  const Verdict verdict =
      Short().job(0).add(55 * kOneMs, Event::lost, "", 12).job(60 * kOneMs).verdict();

  EXPECT_TRUE(verdict.holds()) << first_violation(verdict);
  EXPECT_THAT(verdict.not_checked, testing::Contains(HasSubstr("records of control were lost")));
}

/// Back from another offset, and perhaps from another wait: the header may be of before that.
TEST(TraceCheck, DoesNotJudgeByAHeaderThatDoesNotShowTheLastChangeYet) {
  const auto behind_a_rollback = [](std::int64_t shown) {
    Short trace;
    trace.trace.header.components[0].change = shown;
    trace.job(0).add(11 * kOneMs, Event::applied, "back", 10 * kOneMs, 7);
    trace.add(11 * kOneMs, Event::started, {}, 13 * kOneMs);
    // [control] records a rollback when it is decided, and shows it when all members are back.
    trace.add(12 * kOneMs, Event::rollback, "core.swap", 10 * kOneMs, 7, "[control]");
    return trace.job(13 * kOneMs).job(23 * kOneMs).verdict();
  };
  const Verdict older = behind_a_rollback(6);
  EXPECT_TRUE(older.holds()) << first_violation(older);
  EXPECT_THAT(older.not_checked, testing::Contains(HasSubstr("does not show yet")));
  EXPECT_THAT(first_violation(behind_a_rollback(7)), HasSubstr("is not on its grid"));
}

/// The release that a new offset announced stays, also when another period comes before it.
TEST(TraceCheck, JudgesAReleaseByThePeriodThatItWasAnnouncedWith) {
  const auto behind_two_changes = [](std::int64_t release) {
    Short trace;
    trace.job(0).add(2 * kOneMs, Event::commit, "param.set", 2 * kOneMs, 1, "[control]");
    trace.add(2 * kOneMs, Event::applied, "change", 2 * kOneMs, 1);
    trace.add(2 * kOneMs, Event::started, {}, 13 * kOneMs);
    trace.add(3 * kOneMs, Event::commit, "param.set", 3 * kOneMs, 2, "[control]");
    trace.add(3 * kOneMs, Event::applied, "change", 3 * kOneMs, 2);
    return trace.job(release).job(release + 10 * kOneMs).verdict();
  };
  const Verdict announced = behind_two_changes(13 * kOneMs);
  EXPECT_TRUE(announced.holds()) << first_violation(announced);
  EXPECT_THAT(first_violation(behind_two_changes(14 * kOneMs)), HasSubstr("its start announced"));
}

/// A less urgent component whose priority rises at 25 ms: until then it may have to wait.
struct Raised : Short {
  explicit Raised(std::optional<std::int64_t> scheduled = 25 * kOneMs) {
    Component monitor = trace.header.components[0];
    monitor.name = "monitor";
    monitor.priority = 50;
    monitor.cpus = {1};
    monitor.scheduled = scheduled;
    trace.header.components[0].priority = 40;
    trace.header.components[0].cpus = {1};
    trace.header.components[0].scheduled = -kOneMs;
    trace.header.components.push_back(monitor);
  }
  /// Both are released; `first` runs, then the other one.
  Raised& both(std::int64_t release, std::string_view first) {
    std::int64_t time = release + 5;
    const std::string_view second = first == "control" ? "monitor" : "control";
    for (const std::string_view thread : {first, second}) {
      add(time, Event::release, {}, release, 0, thread);
      add(time + kOneMs / 2, Event::wait, "pace", release + 10 * kOneMs, 0, thread);
      time += kOneMs / 2;
    }
    return *this;
  }
};

TEST(TraceCheck, DoesNotJudgeTheOrderOfJobsByAPriorityThatCameLater) {
  const Verdict verdict = Raised()
                              .both(0, "control")
                              .both(10 * kOneMs, "control")
                              .both(20 * kOneMs, "control")
                              .both(30 * kOneMs, "monitor")
                              .verdict();
  EXPECT_TRUE(verdict.holds()) << first_violation(verdict);
  EXPECT_EQ(verdict.checked.orders, 1U);
  EXPECT_THAT(verdict.not_checked,
              testing::Contains("the order of monitor's jobs before T0 + 0.025000000 s: the trace "
                                "has only its later priority and CPU"));
}

TEST(TraceCheck, JudgesTheOrderOfJobsSinceTheLastChangeOfAPriority) {
  const Verdict verdict = Raised()
                              .both(0, "control")
                              .both(10 * kOneMs, "control")
                              .both(20 * kOneMs, "control")
                              .both(30 * kOneMs, "control")
                              .verdict();
  ASSERT_EQ(verdict.found, 1U);
  EXPECT_EQ(verdict.first->time, 30 * kOneMs + 5);
  EXPECT_THAT(first_violation(verdict), HasSubstr("order: control (priority 40) began"));
}

/// An older mauved does not write it: the last change of the component may have been that of it.
TEST(TraceCheck, TakesTheLastChangeForTheOneOfThePriorityWhereTheHeaderDoesNotSay) {
  const auto changed_at_11 = [](std::string_view first) {
    Raised trace(std::nullopt);
    trace.both(0, "control");
    trace.add(10 * kOneMs + 1, Event::applied, "change", 10 * kOneMs, 1, "monitor");
    return trace.both(10 * kOneMs, "control").both(20 * kOneMs, first).verdict();
  };
  EXPECT_TRUE(changed_at_11("monitor").holds()) << first_violation(changed_at_11("monitor"));
  EXPECT_EQ(changed_at_11("control").found, 1U);
}

/// The probe does not notice a delay of less than 0.2 ms, so no trace proves that there was none.
TEST(TraceCheck, DoesNotJudgeAResponseThatADelayTheProbeCannotSeeExplains) {
  const auto beyond_by = [](std::int64_t ns) {
    return Short().job(0).job(10 * kOneMs, 2 * kOneMs - 5 + ns).job(20 * kOneMs).verdict();
  };
  EXPECT_EQ(beyond_by(0).checked.responses, 3U);
  const Verdict verdict = beyond_by(kOneMs / 5 - 1);
  EXPECT_TRUE(verdict.holds()) << first_violation(verdict);
  EXPECT_EQ(verdict.checked.responses, 2U);
  EXPECT_THAT(verdict.not_checked, testing::Contains(HasSubstr("by less than 0.2 ms")));
  EXPECT_EQ(beyond_by(kOneMs / 5).found, 1U);
}

TEST(TraceCheck, DoesNotCallALongerJobThanTheMeasuredOnesAViolation) {
  const auto responds_late = [](bool measured) {
    Short trace;
    trace.trace.header.components[0].measured = measured;
    return trace.job(0).job(10 * kOneMs, 5 * kOneMs).job(20 * kOneMs).verdict();
  };
  EXPECT_EQ(responds_late(false).found, 1U);
  const Verdict verdict = responds_late(true);
  EXPECT_TRUE(verdict.holds()) << first_violation(verdict);
  EXPECT_EQ(verdict.checked.responses, 2U);
  EXPECT_THAT(verdict.not_checked, testing::Contains(HasSubstr("so declare budgets")));
}

/// A raised priority moves the bounds of all others, and the header has those of the end.
TEST(TraceCheck, DoesNotJudgeResponsesByABoundThatCameWithALaterPriority) {
  const auto responds_late_at = [](std::int64_t release) {
    Short trace;
    trace.trace.header.components[0].scheduled = 15 * kOneMs;
    for (const std::int64_t one : {0 * kOneMs, 10 * kOneMs, 20 * kOneMs, 30 * kOneMs}) {
      trace.job(one, one == release ? 3 * kOneMs : kOneMs);
    }
    return trace.verdict();
  };
  const Verdict before = responds_late_at(10 * kOneMs);
  EXPECT_TRUE(before.holds()) << first_violation(before);
  EXPECT_EQ(before.checked.responses, 3U);
  EXPECT_THAT(before.not_checked,
              testing::Contains("responses beyond the bound before T0 + 0.015000000 s: the trace "
                                "has only the later bound"));
  EXPECT_EQ(responds_late_at(20 * kOneMs).found, 1U);
}

/// So does another core, period or budget, also when a component of the trace has left since.
TEST(TraceCheck, DoesNotJudgeResponsesByABoundThatCameWithALaterBudget) {
  const auto responds_late_at = [](std::int64_t release, bool other_leaves) {
    Short trace;
    trace.trace.header.components[0].scheduled = -kOneMs;
    trace.trace.header.components[0].timed = other_leaves ? -kOneMs : 15 * kOneMs;
    if (other_leaves) trace.add(15 * kOneMs, Event::stopped, {}, 0, 0, "former");
    for (const std::int64_t one : {0 * kOneMs, 10 * kOneMs, 20 * kOneMs, 30 * kOneMs}) {
      trace.job(one, one == release ? 3 * kOneMs : kOneMs);
    }
    return trace.verdict();
  };
  for (const bool other_leaves : {false, true}) {
    const Verdict before = responds_late_at(10 * kOneMs, other_leaves);
    EXPECT_TRUE(before.holds()) << first_violation(before);
    EXPECT_THAT(before.not_checked,
                testing::Contains("responses beyond the bound before T0 + 0.015000000 s: the "
                                  "trace has only the later bound"));
    EXPECT_EQ(responds_late_at(20 * kOneMs, other_leaves).found, 1U);
  }
}

TEST(TraceCheck, DoesNotJudgeResponsesInAWindowOfDisturbance) {
  const Verdict verdict = Short()
                              .job(0)
                              .add(14 * kOneMs, Event::disturbed, "", 3 * kOneMs, 0, "[probe]")
                              .job(10 * kOneMs, 5 * kOneMs)
                              .job(20 * kOneMs)
                              .verdict();
  EXPECT_TRUE(verdict.holds()) << first_violation(verdict);
  EXPECT_EQ(verdict.checked.responses, 2U);
  EXPECT_THAT(verdict.checked.responses_of, testing::ElementsAre(testing::Pair("control", 2U)));
  EXPECT_THAT(verdict.not_checked, testing::Contains("responses in windows of disturbance"));
  EXPECT_FALSE(Short().job(0).job(10 * kOneMs, 5 * kOneMs).verdict().holds());
}

TEST(TraceCheck, DoesNotJudgeWhatAProbeWouldNotSeeOnADisturbedMachine) {
  const auto beyond = [](std::int64_t by, bool disturbed) {
    Short trace;
    if (disturbed) trace.add(1, Event::disturbed, "", kOneMs, 0, "[probe]");
    return trace.job(10 * kOneMs).job(20 * kOneMs, 2 * kOneMs + by).verdict();
  };
  EXPECT_TRUE(beyond(1'100'000, true).holds());
  EXPECT_FALSE(beyond(1'200'000, true).holds());
  EXPECT_FALSE(beyond(300'000, false).holds());
  EXPECT_THAT(beyond(300'000, false).first->message, HasSubstr("responded in 2.300005 ms"));
}

TEST(TraceCheck, DoesNotJudgeTheJobAfterAnOverrun) {
  const auto late = [](bool recorded) {
    Short trace;
    trace.trace.header.components[0].bound = 11 * kOneMs;
    trace.job(0).add(10 * kOneMs + 5, Event::release, "", 10 * kOneMs);
    if (recorded) trace.add(21 * kOneMs - 1, Event::overrun, "", kOneMs, 1);
    trace.add(21 * kOneMs, Event::wait, "pace", 20 * kOneMs);
    trace.add(21 * kOneMs, Event::release, "", 20 * kOneMs);
    return trace.add(32 * kOneMs, Event::wait, "pace", 30 * kOneMs).verdict();
  };
  EXPECT_TRUE(late(true).holds()) << first_violation(late(true));
  EXPECT_EQ(late(true).checked.responses, 2U);
}

TEST(TraceCheck, AFaultOrAStopExplainsWhoDidNotTakeAChange) {
  const auto change = [](Event explanation) {
    Short trace;
    trace.job(0)
        .add(5 * kOneMs, Event::commit, "swap", 15 * kOneMs, 3, "[control]")
        .add(5 * kOneMs, Event::member, "control", 0, 3, "[control]")
        .job(10 * kOneMs);
    if (explanation != Event::user) trace.add(12 * kOneMs, explanation, "threw");
    if (explanation == Event::stopped) trace.add(13 * kOneMs, Event::started, "", 20 * kOneMs);
    return trace.job(20 * kOneMs).verdict();
  };
  EXPECT_TRUE(change(Event::fault).holds()) << first_violation(change(Event::fault));
  EXPECT_TRUE(change(Event::stopped).holds()) << first_violation(change(Event::stopped));
  ASSERT_EQ(change(Event::user).found, 1U);
  EXPECT_THAT(change(Event::user).first->message, HasSubstr("control never took change 3"));
}

TEST(TraceCheck, AStoppedComponentIsNotReleasedBeforeItStarts) {
  EXPECT_FALSE(Short().job(0).add(5 * kOneMs, Event::stopped).job(10 * kOneMs).verdict().holds());
  EXPECT_TRUE(Short()
                  .job(0)
                  .add(5 * kOneMs, Event::stopped)
                  .add(35 * kOneMs, Event::started, "", 40 * kOneMs)
                  .job(40 * kOneMs)
                  .verdict()
                  .holds());
}

TEST(TraceCheck, AtABarrierComponentsGoOnLaterOnTheirGrid) {
  const auto barrier = [](std::int64_t release) {
    return Short()
        .job(0)
        .add(10 * kOneMs, Event::applied, "barrier", 12 * kOneMs, 1)
        .job(release)
        .verdict();
  };
  EXPECT_TRUE(barrier(40 * kOneMs).holds()) << first_violation(barrier(40 * kOneMs));
  EXPECT_FALSE(barrier(45 * kOneMs).holds());
}

/// The releases missed at the barrier were of the period that the rollback takes back.
TEST(TraceCheck, DoesNotJudgeAReleaseThatABarrierAndARollbackToAnotherPeriodMoved) {
  const auto behind_a_barrier = [](bool then_back) {
    Short trace;
    trace.job(0).add(10 * kOneMs, Event::applied, "barrier", 10 * kOneMs, 7);
    trace.add(11 * kOneMs, Event::commit, "apply", 11 * kOneMs, 7, "[control]");
    trace.add(11 * kOneMs, Event::member, "control", 0, 7, "[control]");
    trace.add(11 * kOneMs, Event::missed, {}, 1, 1);
    trace.add(11 * kOneMs, Event::applied, "change", 11 * kOneMs, 7);
    if (then_back) {
      trace.add(12 * kOneMs, Event::applied, "back", 12 * kOneMs, 8);
      trace.add(12 * kOneMs, Event::rollback, "apply", 12 * kOneMs, 8, "[control]");
      trace.add(12 * kOneMs, Event::member, "control", 0, 8, "[control]");
    }
    return trace.job(14 * kOneMs).job(24 * kOneMs).verdict();
  };
  const Verdict moved = behind_a_barrier(true);
  EXPECT_TRUE(moved.holds()) << first_violation(moved);
  EXPECT_THAT(moved.not_checked, testing::Contains(HasSubstr("a barrier and another change")));
  EXPECT_THAT(first_violation(behind_a_barrier(false)), HasSubstr("what it missed mean"));
}

TEST(TraceCheck, MembersOfARollbackGoBackAtOneInstant) {
  const auto rollback = [](bool both) {
    Short trace;
    trace.job(0)
        .add(10 * kOneMs, Event::applied, "back", 10 * kOneMs, 4)
        .job(10 * kOneMs)
        .add(12 * kOneMs, Event::rollback, "swap", 10 * kOneMs, 4, "[control]")
        .add(12 * kOneMs, Event::member, "control", 0, 4, "[control]")
        .add(12 * kOneMs, Event::member, "scan", 0, 4, "[control]")
        .add(5 * kOneMs, Event::release, "", 5 * kOneMs, 0, "scan")
        .add(6 * kOneMs, Event::wait, "pace", 15 * kOneMs, 0, "scan");
    if (both) trace.add(15 * kOneMs, Event::applied, "back", 10 * kOneMs, 4, "scan");
    return trace.add(15 * kOneMs, Event::release, "", 15 * kOneMs, 0, "scan").verdict();
  };
  EXPECT_TRUE(rollback(true).holds()) << first_violation(rollback(true));
  ASSERT_EQ(rollback(false).found, 1U);
  EXPECT_THAT(rollback(false).first->message, HasSubstr("scan never took change 4"));
}

TEST(TraceCheck, WhoWaitedAtABarrierTakesTheChangeAtALaterInstant) {
  const Verdict verdict = Short()
                              .job(0)
                              .add(9 * kOneMs, Event::applied, "barrier", 10 * kOneMs, 1)
                              .add(11 * kOneMs, Event::commit, "apply", 12 * kOneMs, 1, "[control]")
                              .add(11 * kOneMs, Event::member, "control", 0, 1, "[control]")
                              .add(11 * kOneMs, Event::applied, "change", 12 * kOneMs, 1)
                              .job(20 * kOneMs)
                              .verdict();
  EXPECT_TRUE(verdict.holds()) << first_violation(verdict);
  EXPECT_EQ(verdict.checked.takes, 2U);
}

TEST(TraceCheck, NamesTheEarliestViolationWhateverIsFoundFirst) {
  const Verdict verdict =
      Short().job(0, 3 * kOneMs).job(10 * kOneMs).job(50 * kOneMs).job(60 * kOneMs).verdict();

  EXPECT_EQ(verdict.found, 2U);
  EXPECT_THAT(verdict.found_of,
              testing::ElementsAre(testing::Pair("lost", 1U), testing::Pair("response", 1U)));
  ASSERT_TRUE(verdict.first);
  EXPECT_EQ(verdict.first->rule, "response");
}

TEST(TraceCheck, SaysWhatItCouldNotLookAt) {
  Short trace;
  trace.trace.reading.complete = false;
  trace.trace.reading.broken = 2;
  trace.trace.reading.first_broken = 7;
  trace.trace.reading.unknown = 3;
  trace.trace.header.lost = 12;
  trace.trace.header.components[0].bound.reset();

  const auto not_checked = trace.job(0).verdict().not_checked;

  EXPECT_THAT(not_checked, testing::Contains(HasSubstr("cut off")));
  EXPECT_THAT(not_checked, testing::Contains(HasSubstr("the first is line 7")));
  EXPECT_THAT(not_checked, testing::Contains("3 records of events that are not known"));
  EXPECT_THAT(not_checked, testing::Contains(HasSubstr("12 records that mauved could not")));
  EXPECT_THAT(not_checked, testing::Contains(HasSubstr("no admitted bound")));
}

TEST(TraceCheck, OfNothingHolds) { EXPECT_TRUE(check(Trace()).holds()); }

}  // namespace
}  // namespace mauve::ctl::mtrace
