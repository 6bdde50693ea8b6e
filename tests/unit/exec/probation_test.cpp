// SPDX-License-Identifier: LGPL-3.0-or-later
/// Probation and the rollback, on a clock that is moved by hand.
#include <gtest/gtest.h>

#include "support/under_probation.h"

namespace mauve {
namespace {

using test::UnderProbation;

/// Throws in its fifth job.
struct Bad : ramp::Down {
  void update() override {
    if (++jobs_ == 5) throw std::runtime_error("sensor lost");
    ramp::Down::update();
  }

 private:
  int jobs_ = 0;
};

/// Takes longer than the period in its second, fourth and sixth job.
struct Tardy : ramp::Down {
  void update() override {
    ramp::Down::update();
    if (++jobs_ % 2 == 0 && jobs_ <= 6) clock()->advance(12ms);
  }
  static ManualClock*& clock() {
    static ManualClock* clock = nullptr;
    return clock;
  }

 private:
  int jobs_ = 0;
};

TEST_F(UnderProbation, ARollBackMakesNoGenerationBeforeTheCallerOfTheChangeKnowsItsOwn) {
  for (const bool asks : {true, false}) {
    const std::uint64_t before = deployer.generation();
    Change change{{ramp::to_core<Bad>("Bad")}};
    change.probation = Probation{};
    Result<PreparedChange> prepared = deployer.prepare(change);
    ASSERT_TRUE(prepared);
    std::shared_ptr<Ongoing> ongoing = deployer.begin(*prepared);

    deployer.run_for(100ms);  // the fifth job is among these, and the old core runs again
    EXPECT_TRUE(tend().empty());
    EXPECT_EQ(deployer.generation(), before + 1);
    EXPECT_EQ(core(), "Bad") << "the model shows the generation that is reported next";
    if (asks) {
      ASSERT_TRUE(ongoing->advance());
      EXPECT_EQ(ongoing->result()->generation, before + 1);
    } else {
      ongoing.reset();  // the maker drops the change without asking
    }
    EXPECT_EQ(tend().size(), 1u);
    EXPECT_EQ(deployer.generation(), before + 2);
    EXPECT_EQ(deployer.status("control").missed, 0u);
    deployer.run_for(100ms);
  }
}

/// The next change does not free the cores that this change replaced: collect() hands them out.
TEST_F(UnderProbation, IsKeptByTheNextChangeWhenItPassedBeforeItsCallerAsked) {
  const auto begin = [&](const char* name) {
    Change change{{ramp::to_core<ramp::Up>(name)}};
    change.probation = Probation{};
    Result<PreparedChange> prepared = deployer.prepare(change);
    EXPECT_TRUE(prepared);
    auto ongoing = deployer.begin(*prepared);
    for (int looks = 0; looks < 20 && !ongoing->advance(); ++looks) deployer.run_for(10ms);
    EXPECT_TRUE(ongoing->advance());
    return ongoing;
  };
  const auto first = begin("first");
  ASSERT_TRUE(deployer.confirm());
  const auto second = begin("second");
  EXPECT_EQ(ramp::Up::configured_cores(), 3);

  EXPECT_TRUE(first->result());
  EXPECT_TRUE(second->result());
  deployer.run_for(30s);
  static_cast<void>(tend());
  static_cast<void>(deployer.collect().release());
  EXPECT_EQ(ramp::Up::configured_cores(), 1);
}

TEST_F(UnderProbation, ACoreThatThrowsIsRolledBackAtTheNextRelease) {
  const std::string before = core();
  ASSERT_TRUE(swap_to<Bad>());
  deployer.run_for(30ms);
  EXPECT_TRUE(deployer.on_probation());

  deployer.run_for(20ms);  // the fifth job is among these
  EXPECT_EQ(ramp::read(architecture.position), -1.0) << "its safe value, at once";
  const Outcome end = rolled_back_after(20ms, before, "threw: sensor lost");

  EXPECT_EQ(end.component, "control");
  EXPECT_EQ(end.began, 2u);
  EXPECT_EQ(end.generation, 3u);
  EXPECT_EQ(end.cores.size(), 1u);
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
  EXPECT_EQ(deployer.status("control").missed, 0u) << "the old core runs at the next release";
  EXPECT_EQ(deployer.generation(), 3u);
  EXPECT_FALSE(deployer.on_probation());
}

TEST_F(UnderProbation, ACoreThatWasRolledBackIsFreedWithWhatIsCollectedThen) {
  ASSERT_TRUE(swap_to<Bad>());
  const std::weak_ptr<const CoreBase> bad = architecture.control.bundle()->core;

  deployer.run_for(100ms);
  ASSERT_EQ(tend().size(), 1u);
  while (!deployer.settled()) deployer.run_for(10ms);
  Retired retired = deployer.collect();

  EXPECT_TRUE(retired.release());
  EXPECT_TRUE(bad.expired()) << "the next change would free it, on [control]";
}

TEST_F(UnderProbation, TheStateGoesBackAsItIs) {
  ASSERT_TRUE(swap_to<Bad>());  // counts down: 10, 9, 8, 7, 6, thrown
  end_after(100ms);

  // Four jobs down from about 10, then up again without a jump.
  const double position = ramp::read(architecture.position);
  EXPECT_GE(position, 6.0);
  EXPECT_LE(position, 14.0);
}

TEST_F(UnderProbation, ItEndsAfterSoManyJobsWithoutAFault) {
  ASSERT_TRUE(swap_to<ramp::Down>({.activations = 20}));

  deployer.run_for(150ms);
  EXPECT_TRUE(deployer.on_probation());
  EXPECT_TRUE(tend().empty());
  const Outcome end = end_after(100ms);

  EXPECT_EQ(end.kind, Outcome::Kind::passed);
  EXPECT_EQ(end.reason, "20 jobs without a fault");
  EXPECT_EQ(deployer.generation(), 2u);
}

TEST_F(UnderProbation, ItEndsWithItsTime) {
  ASSERT_TRUE(swap_to<ramp::Down>({.time = 200ms}));

  EXPECT_EQ(end_after(250ms).kind, Outcome::Kind::passed);
}

TEST_F(UnderProbation, AfterItAFaultIsTheComponentsOwn) {
  ASSERT_TRUE(swap_to<Bad>({.activations = 2}));
  end_after(30ms);

  deployer.run_for(50ms);

  EXPECT_TRUE(tend().empty());
  EXPECT_EQ(deployer.status("control").state, ComponentState::faulted);
}

TEST_F(UnderProbation, MoreLateJobsThanToleratedCauseARollback) {
  Tardy::clock() = const_cast<ManualClock*>(dynamic_cast<const ManualClock*>(&deployer.clock()));
  const std::string before = core();

  ASSERT_TRUE(swap_to<Tardy>({.misses = 2, .window = 10}));

  rolled_back_after(200ms, before, "overran too often");
  EXPECT_EQ(deployer.status("control").overruns, 3u) << "two were tolerated";
}

TEST_F(UnderProbation, AsManyLateJobsAsToleratedDoNot) {
  Tardy::clock() = const_cast<ManualClock*>(dynamic_cast<const ManualClock*>(&deployer.clock()));

  ASSERT_TRUE(swap_to<Tardy>({.activations = 20, .misses = 1, .window = 2}));

  EXPECT_EQ(end_after(500ms).kind, Outcome::Kind::passed) << "one of any two jobs in a row";
  EXPECT_EQ(deployer.status("control").overruns, 3u);
}

/// Half of each period is late.
class WithADeadline : public UnderProbation {
 protected:
  void SetUp() override {
    architecture.control.task().deadline = 5ms;
    UnderProbation::SetUp();
    deployer.run_for(5ms);
  }
  /// The host stands still: one of six jobs begins 7 ms after its release.
  void stand_still(int times) {
    auto* clock = const_cast<ManualClock*>(dynamic_cast<const ManualClock*>(&deployer.clock()));
    for (int i = 0; i < times; ++i) {
      clock->advance(12ms);
      deployer.run_for(48ms);
    }
  }
};

TEST_F(WithADeadline, AHostThatStandsStillNowAndThenLeadsNobodyBack) {
  ASSERT_TRUE(swap_to<ramp::Down>({.activations = 100}));
  deployer.run_for(40ms);

  stand_still(10);

  EXPECT_EQ(deployer.status("control").overruns, 10u);
  EXPECT_EQ(end_after(1s).kind, Outcome::Kind::passed);
}

TEST_F(WithADeadline, AMemberThatIsStarvedCausesARollback) {
  const std::string before = core();
  ASSERT_TRUE(swap_to<ramp::Down>({.activations = 100}));
  deployer.run_for(40ms);

  stand_still(11);

  rolled_back_after(40ms, before, "overran too often");
}

TEST_F(UnderProbation, UndoRollsBack) {
  const std::string before = core();
  ASSERT_TRUE(swap_to<ramp::Down>());
  deployer.run_for(20ms);

  ASSERT_TRUE(deployer.undo());
  const Outcome end = rolled_back_after(20ms, before, "undone by request");

  EXPECT_EQ(end.component, "");
  const Status again = deployer.undo();
  ASSERT_FALSE(again) << "once";
  EXPECT_EQ(again.error().message, "generation 3 is not on probation, so there is nothing to undo");
}

TEST_F(UnderProbation, WhatNobodyConfirmsIsRolledBack) {
  const std::string before = core();
  ASSERT_TRUE(swap_to<ramp::Down>({.confirm_within = 50ms}));
  deployer.run_for(60ms);
  EXPECT_TRUE(tend().empty());

  rolled_back_after(20ms, before, "not confirmed within its time");
}

TEST_F(UnderProbation, WhatIsConfirmedStays) {
  ASSERT_TRUE(swap_to<ramp::Down>({.confirm_within = 50ms}));
  const Result<Receipt> meanwhile = deployer.swap_core<ramp::Up>("control");

  ASSERT_TRUE(deployer.confirm());
  const Outcome end = end_after(100ms);

  ASSERT_FALSE(meanwhile);
  EXPECT_EQ(meanwhile.error().code, Errc::conflict);
  EXPECT_EQ(end.reason, "confirmed");
  EXPECT_FALSE(deployer.confirm());
  EXPECT_EQ(deployer.generation(), 2u);
}

TEST_F(UnderProbation, AStopDuringItParksAndTheRollbackStaysPossible) {
  ASSERT_TRUE(swap_to<ramp::Down>());
  deployer.run_for(20ms);

  ASSERT_TRUE(deployer.stop({"control"}));
  ASSERT_TRUE(deployer.undo());
  end_after(20ms);

  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
  EXPECT_NE(core().find("Up"), std::string::npos);
}

TEST_F(UnderProbation, AStopThatKnowsNothingOfARollBackParksTheOldCore) {
  const std::string before = core();
  ASSERT_TRUE(swap_to<Bad>());
  deployer.run_for(100ms);  // it threw and went back; nobody has looked yet

  ASSERT_TRUE(deployer.stop({"control"}));
  ASSERT_EQ(tend().size(), 1u);
  ASSERT_TRUE(deployer.start({"control"}));
  deployer.run_for(50ms);

  EXPECT_EQ(core(), before);
  EXPECT_GT(ramp::read(architecture.position), 6.0) << "it counts up again";
}

TEST_F(UnderProbation, AfterAStopOfEverythingWhatComesBackStaysParked) {
  Change change;
  change.remove = {"control"};
  change.probation = Probation{};
  ASSERT_TRUE(deployer.apply(change));
  deployer.run_for(20ms);

  ASSERT_TRUE(deployer.stop_all());
  ASSERT_TRUE(deployer.undo());
  end_after(20ms);

  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
  const double position = ramp::read(architecture.position);
  deployer.run_for(50ms);
  EXPECT_EQ(ramp::read(architecture.position), position) << "the machine stands";
  ASSERT_TRUE(deployer.start({"control"}));
  deployer.run_for(50ms);
  EXPECT_NE(ramp::read(architecture.position), position);
}

TEST_F(UnderProbation, WhatJoinedLeavesAgainAndWhatLeftComesBack) {
  struct Other : ramp::Shell {};
  auto joining = std::make_shared<ComponentBase>(
      "second",
      ComponentType{"ramp", ShellType::of<ramp::Shell>(), FsmType::of<ramp::Fsm>("ramp"), "bad"},
      CoreType::of<Bad>("bad"));
  Change change;
  change.new_components.push_back({joining, {}});
  change.remove = {"control"};
  change.probation = Probation{};
  joining.reset();
  ASSERT_TRUE(deployer.apply(change));
  change = {};
  EXPECT_EQ(architecture.find_component("control"), nullptr);
  EXPECT_EQ(deployer.status().size(), 1u) << "what left is not shown while it may come back";

  EXPECT_EQ(end_after(100ms).component, "second");
  EXPECT_NE(architecture.find_component("control"), nullptr);
  EXPECT_EQ(architecture.find_component("second"), nullptr);
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
  EXPECT_EQ(deployer.status().size(), 1u);
}

}  // namespace
}  // namespace mauve
