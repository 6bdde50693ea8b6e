// SPDX-License-Identifier: LGPL-3.0-or-later
/// Changes that meet while one of them is on probation, on a clock that is moved by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/outcomes.h"
#include "support/ramp.h"
#include "support/traced.h"

namespace mauve {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// Throws in its twentieth job.
struct Failing : ramp::Up {
  void update() override {
    if (++count_ == 20) throw std::runtime_error("sensor lost");
    ramp::Up::update();
  }

 private:
  int count_ = 0;
};

class Joining : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(50ms);
  }
  template <typename Core>
  static Edit to(const char* component) {
    return ramp::to_core<Core>(class_name(typeid(Core)), component);
  }
  static Edit step(const char* component, double value) {
    Edit edit;
    edit.member = component;
    edit.properties.emplace_back("core.step", Value(value));
    return edit;
  }
  /// In force, and a job of each component ran with it.
  Receipt apply(std::vector<Edit> edits, std::optional<Probation> probation = Probation{}) {
    Change change{std::move(edits)};
    change.probation = probation;
    return apply(change);
  }
  Receipt apply(const Change& change) {
    const Result<Receipt> receipt = deployer.apply(change);
    EXPECT_TRUE(receipt) << to_string(receipt.error());
    deployer.run_for(20ms);
    return receipt ? *receipt : Receipt{};
  }
  void let_join(const char* name, std::optional<Probation> probation) {
    Change change;
    const ComponentType type{"ramp", ShellType::of<ramp::Shell>(), FsmType::of<ramp::Fsm>("ramp"),
                             "up"};
    change.new_components.push_back(
        {std::make_shared<ComponentBase>(name, type, CoreType::of<ramp::Up>("up")), {}});
    change.probation = probation;
    apply(change);
  }
  std::vector<Outcome> report_after(Duration time) {
    deployer.run_for(time);
    return test::tend(deployer);
  }
  std::string core(const char* component) { return deployer.status(component).core; }

  ramp::Two<ramp::Up> architecture;
  Deployer deployer{architecture, {.simulated = true}};
  const std::string before = "ramp::Up";
};

TEST_F(Joining, ANameIsRefusedThatARollbackGaveBackBeforeTheCommit) {
  Change leaves;
  leaves.remove = {"right"};
  leaves.probation.emplace();
  apply(leaves);
  Change joins;
  const ComponentType type{"ramp", ShellType::of<ramp::Shell>(), FsmType::of<ramp::Fsm>("ramp"),
                           "up"};
  joins.new_components.push_back(
      {std::make_shared<ComponentBase>("right", type, CoreType::of<ramp::Up>("up")), {}});
  auto prepared = deployer.prepare(joins);
  ASSERT_TRUE(prepared) << to_string(prepared.error());
  ASSERT_TRUE(deployer.undo());
  ASSERT_EQ(report_after(50ms).size(), 1u);

  Retired retired;
  const Result<Receipt> done = deployer.commit(*prepared, retired);

  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::conflict);
  EXPECT_EQ(done.error().at, "right");
  EXPECT_EQ(deployer.status("right").state, ComponentState::running);
}

TEST_F(Joining, ASwapInPlaceParksNothingWhenARollbackCameBetween) {
  apply({to<ramp::Down>("left")});
  auto next = deployer.prepare_in_place(to<ramp::Up>("left"));
  ASSERT_TRUE(next) << to_string(next.error());
  ASSERT_TRUE(deployer.undo());
  ASSERT_EQ(report_after(50ms).size(), 1u);

  const Result<Receipt> parked = deployer.wait(*deployer.begin_in_place_park(*next));

  ASSERT_FALSE(parked);
  EXPECT_EQ(parked.error().code, Errc::conflict);
  EXPECT_EQ(deployer.status("left").state, ComponentState::running);
}

TEST_F(Joining, AChangeOfAnotherComponentLeavesAProbationAsItIs) {
  apply({to<Failing>("left")});
  const Receipt elsewhere = apply({to<ramp::Down>("right")});
  EXPECT_THAT(elsewhere.notes, IsEmpty());
  EXPECT_EQ(deployer.probations().size(), 2u);

  const std::vector<Outcome> ends = report_after(300ms);

  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(ends[0].component, "left");
  EXPECT_THAT(ends[0].generations, ElementsAre(2));
  EXPECT_EQ(ends[0].oldest_open, 3u);
  EXPECT_EQ(ends[0].generation, 4u);
  EXPECT_EQ(core("left"), before);
  EXPECT_THAT(core("right"), HasSubstr("Down"));
  EXPECT_TRUE(deployer.on_probation()) << "that of the other component goes on";
  EXPECT_EQ(deployer.status("left").missed, 0u);
}

TEST_F(Joining, ANewerChangeOfTheSameComponentRollsBackToWhatWasProvenLast) {
  apply({to<ramp::Down>("left")});
  const Receipt joined = apply({to<Failing>("left")});
  ASSERT_EQ(joined.notes.size(), 1u);
  EXPECT_THAT(joined.notes[0],
              HasSubstr("back to before generation 2; only a `mauvectl confirm` before"));

  const std::vector<Outcome> ends = report_after(300ms);

  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::rolled_back);
  EXPECT_THAT(ends[0].generations, ElementsAre(2, 3));
  EXPECT_EQ(ends[0].began, 2u);
  EXPECT_EQ(ends[0].oldest_open, 0u);
  EXPECT_EQ(core("left"), before);
  EXPECT_EQ(core("right"), before);
}

/// check-trace judges a component by its header only if both have the same number.
TEST_F(Joining, ATraceShowsTheNumberOfTheChangeThatEachMemberAppliedLast) {
  const TraceMode mode_before = trace_mode();
  set_trace_mode(TraceMode::jobs);
  apply({to<ramp::Down>("left"), to<ramp::Down>("right")});
  apply({to<ramp::Up>("left")});  // right follows
  const auto applied = test::of_kind(test::drain_trace(deployer), TraceKind::applied);
  set_trace_mode(mode_before);

  const auto components = deployer.traced().components;
  ASSERT_EQ(components.size(), 2U);
  for (const TracedComponent& one : components) {
    std::int64_t last = 0;
    for (const TraceRecord& record : applied) {
      if (trace_name(record.thread) == one.name) last = record.b;
    }
    EXPECT_GT(last, 0) << one.name;
    EXPECT_EQ(static_cast<std::int64_t>(one.change), last) << one.name;
  }
}

TEST_F(Joining, ASetOnABadCoreKeepsTheRollbackToTheGoodOne) {
  apply({to<Failing>("left")});
  apply({step("left", 2)}, std::nullopt);  // also without a probation of its own
  EXPECT_TRUE(deployer.on_probation());

  const std::vector<Outcome> ends = report_after(400ms);

  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::rolled_back);
  EXPECT_THAT(ends[0].cores, ElementsAre(HasSubstr("Failing"))) << "it was new, and at fault";
  EXPECT_EQ(core("left"), before);
}

TEST_F(Joining, WhatTheNewerChangeLeavesAsItIsFollowsItBack) {
  apply({to<ramp::Down>("left"), to<Failing>("right")});
  const Receipt joined = apply({to<ramp::Down>("left")});
  ASSERT_EQ(joined.components.size(), 1u) << "it cost the other one nothing";

  const std::vector<Outcome> ends = report_after(300ms);

  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].component, "right");
  EXPECT_EQ(core("left"), before);
  EXPECT_EQ(core("right"), before);
  EXPECT_EQ(deployer.status("left").missed + deployer.status("right").missed, 0u);
}

TEST_F(Joining, AChangeMayJoinSeveral) {
  apply({to<ramp::Down>("left")});
  apply({to<ramp::Down>("right")});
  const Receipt joined = apply({to<Failing>("left"), to<ramp::Up>("right")});
  EXPECT_EQ(joined.notes.size(), 2u);
  EXPECT_EQ(deployer.probations().size(), 1u);

  const std::vector<Outcome> ends = report_after(300ms);

  ASSERT_EQ(ends.size(), 1u);
  EXPECT_THAT(ends[0].generations, ElementsAre(2, 3, 4));
  EXPECT_EQ(core("left"), before);
  EXPECT_EQ(core("right"), before);
}

/// Of a row of changes only the first core and the last one are kept.
TEST_F(Joining, ARowOfChangesIsOneProbationAndKeepsTwoCores) {
  ASSERT_EQ(ramp::Up::configured_cores(), 2);
  for (int i = 0; i < 5; ++i) apply({to<ramp::Up>("left")});
  static_cast<void>(test::tend(deployer));
  EXPECT_EQ(ramp::Up::configured_cores(), 3);
  EXPECT_EQ(deployer.probations().size(), 1u);

  const std::vector<Outcome> ends = report_after(40s);

  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::passed);
  EXPECT_THAT(ends[0].generations, ElementsAre(2, 3, 4, 5, 6));
  static_cast<void>(deployer.collect().release());
  EXPECT_EQ(ramp::Up::configured_cores(), 2);
}

TEST_F(Joining, ConfirmAndUndoAreAboutAllThatJoined) {
  for (const bool confirms : {true, false}) {
    apply({to<ramp::Down>("left")});
    apply({to<ramp::Up>("left")});
    ASSERT_TRUE(confirms ? deployer.confirm() : deployer.undo());
    EXPECT_EQ(report_after(50ms).size(), 1u);
    EXPECT_FALSE(deployer.on_probation());
    EXPECT_THAT(core("left"), HasSubstr("Up"));
  }
  static_cast<void>(deployer.collect().release());
  EXPECT_EQ(ramp::Up::configured_cores(), 2);
}

TEST_F(Joining, UndoTakesTheNewestProbationFirst) {
  apply({to<ramp::Down>("left")});
  apply({to<ramp::Down>("right")});

  ASSERT_TRUE(deployer.undo());
  EXPECT_EQ(report_after(50ms).size(), 1u);
  EXPECT_THAT(core("left"), HasSubstr("Down"));
  EXPECT_EQ(core("right"), before);
  ASSERT_TRUE(deployer.undo());
  EXPECT_EQ(report_after(50ms).size(), 1u);
  EXPECT_EQ(core("left"), before);
}

TEST_F(Joining, AStartOrStopOfItsComponentLeavesAProbationAsItIs) {
  apply({to<Failing>("left")});
  ASSERT_TRUE(deployer.stop({"left"}));
  ASSERT_TRUE(deployer.start({"left"}));
  EXPECT_TRUE(deployer.on_probation());

  const std::vector<Outcome> ends = report_after(400ms);

  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(core("left"), before);
}

/// The component obeys the stop, and goes back with the other one before [control] looks at it.
TEST_F(Joining, AStopThatARollbackFollowsAtOnceIsSettled) {
  apply({to<Failing>("left"), to<ramp::Down>("right")});
  const auto stop = deployer.begin_stop({"right"});
  ASSERT_TRUE(stop) << to_string(stop.error());
  deployer.run_for(400ms);

  while (!(*stop)->advance()) deployer.run_for(1ms);

  EXPECT_TRUE((*stop)->result());
  report_after(50ms);
  EXPECT_EQ(core("right"), before);
  EXPECT_EQ(deployer.status("right").state, ComponentState::stopped);
}

TEST_F(Joining, AStopBetweenTwoChangesIsNotRolledBackWithThem) {
  apply({to<ramp::Down>("left")});
  ASSERT_TRUE(deployer.stop({"left"}));
  apply({to<ramp::Up>("left")});

  ASSERT_TRUE(deployer.undo());
  report_after(50ms);

  EXPECT_EQ(deployer.status("left").state, ComponentState::stopped);
}

TEST_F(Joining, AChangeOfRulesHasNoComponentToName) {
  Change rules;
  rules.changes_rules = true;
  rules.probation.emplace();
  apply(rules);

  const Receipt next = apply({to<ramp::Down>("left")});
  const Receipt rules_again = apply(rules);

  ASSERT_EQ(next.notes.size(), 1u);
  EXPECT_THAT(next.notes[0], StartsWith("generation 2 is still on probation, and"));
  ASSERT_EQ(rules_again.notes.size(), 1u);
  EXPECT_THAT(rules_again.notes[0],
              StartsWith("the probation of generations 2 to 3 (left) ends early"));
}

TEST_F(Joining, WhatAwaitsConfirmationIsNotChangedAndTheOthersAre) {
  Probation probation;
  probation.confirm_within = 1s;
  apply({to<ramp::Down>("left")}, probation);

  const Result<Receipt> same = deployer.apply(Change{{to<ramp::Up>("left")}});
  ASSERT_FALSE(same);
  EXPECT_EQ(same.error().code, Errc::conflict);
  apply({to<ramp::Down>("right")});

  EXPECT_THAT(report_after(2s), IsEmpty()) << "now it is rolled back";
  const std::vector<Outcome> ends = report_after(50ms);
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].reason, "not confirmed within its time");
  EXPECT_EQ(core("left"), before);
  EXPECT_THAT(core("right"), HasSubstr("Down"));
}

TEST_F(Joining, AComponentThatJoinedOnProbationLeavesAlsoAfterItWasChanged) {
  let_join("second", Probation{});
  apply({to<Failing>("second")});

  EXPECT_EQ(report_after(400ms).size(), 1u);

  EXPECT_EQ(architecture.find_component("second"), nullptr);
  EXPECT_EQ(deployer.status().size(), 2u);
}

TEST_F(Joining, AComponentThatLeftOnProbationComesBackWithTheOthers) {
  Change change{{to<ramp::Down>("left")}};
  change.remove = {"right"};
  change.probation = Probation{};
  apply(change);
  apply({to<Failing>("left")});
  EXPECT_EQ(architecture.find_component("right"), nullptr);

  EXPECT_EQ(report_after(400ms).size(), 1u);

  EXPECT_NE(architecture.find_component("right"), nullptr);
  EXPECT_EQ(deployer.status("right").state, ComponentState::running);
  EXPECT_EQ(core("left"), before);
}

TEST_F(Joining, AComponentThatLeftIsFreedWhenTheyPass) {
  let_join("second", std::nullopt);
  ASSERT_EQ(ramp::Up::configured_cores(), 3);
  Change change{{to<ramp::Down>("left")}};
  change.remove = {"second"};
  change.probation = Probation{};
  apply(change);
  apply({to<ramp::Up>("left")});

  report_after(40s);
  static_cast<void>(deployer.collect().release());

  EXPECT_EQ(ramp::Up::configured_cores(), 2);
}

/// The rollback leads into a resource that leaves.
TEST_F(Joining, AChangeThatCannotJoinEndsAProbationEarlyAndSaysSoBefore) {
  Change change;
  change.remove = {"right_position"};
  Edit apart;
  apart.member = "right";
  apart.disconnect = {"out"};
  change.edits.push_back(apart);
  apply({to<ramp::Down>("right")});
  change.probation = Probation{};

  Result<PreparedChange> prepared = deployer.prepare(change);
  ASSERT_TRUE(prepared) << to_string(prepared.error());
  const Receipt foreseen = deployer.foresee(*prepared);
  ASSERT_EQ(foreseen.notes.size(), 1u);
  EXPECT_THAT(foreseen.notes[0], HasSubstr("the probation of generation 2 (right) ends early"));
  Retired retired;
  const Result<Receipt> receipt = deployer.commit(*prepared, retired);
  ASSERT_TRUE(receipt);
  EXPECT_EQ(receipt->notes, foreseen.notes);

  const std::vector<Outcome> ends = report_after(20ms);
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::overtaken);
  EXPECT_THAT(ends[0].generations, ElementsAre(2));
}

}  // namespace
}  // namespace mauve
