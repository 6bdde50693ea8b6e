// SPDX-License-Identifier: LGPL-3.0-or-later
/// The cores that take over by themselves when a core fails, on a clock that is moved by hand.
#include <gtest/gtest.h>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::tend;

/// Throws in every third job.
struct Unsteady : ramp::Up {
  void update() override {
    if (++jobs_ % 3 == 0) throw std::runtime_error("sensor lost");
    ramp::Up::update();
  }

 private:
  int jobs_ = 0;
};

struct UnsteadyArchitecture : ramp::One<Unsteady> {
  explicit UnsteadyArchitecture(FaultPolicy policy) { control.task().on_fault = policy; }
};

/// Counts down when it fails.
struct FallingBack : UnsteadyArchitecture {
  FallingBack() : UnsteadyArchitecture({.action = FaultPolicy::Action::fallback}) {
    control.fall_back_to(ComponentBase::Fallback{CoreType::of<ramp::Down>("ramp/down"), {}});
  }
};

void prepare_standby_cores(Deployer& deployer) {
  for (const Change& change : deployer.wanted_standby_cores()) {
    auto prepared = deployer.prepare(change);
    ASSERT_TRUE(prepared) << to_string(prepared.error());
    deployer.stand_by(*prepared);
  }
}

TEST(Standby, TheFallbackCoreTakesOverAtTheNextRelease) {
  FallingBack architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  EXPECT_TRUE(deployer.wanted_standby_cores().empty()) << "it stands by";

  deployer.run_for(25ms);
  EXPECT_EQ(ramp::read(architecture.position), -1.0) << "the safe value, at once";
  deployer.run_for(30ms);
  const auto outcomes = tend(deployer);

  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::fell_back);
  EXPECT_EQ(outcomes[0].component, "control");
  EXPECT_EQ(outcomes[0].reason, "sensor lost");
  ASSERT_TRUE(outcomes[0].incident);
  EXPECT_EQ(outcomes[0].incident->cause, "threw");
  EXPECT_EQ(outcomes[0].incident->text, "sensor lost");
  EXPECT_NE(outcomes[0].incident->core, "ramp/down") << "the core that failed";
  EXPECT_EQ(outcomes[0].incident->state, "update");
  EXPECT_EQ(outcomes[0].incident->job, 3u);
  EXPECT_EQ(Duration{outcomes[0].incident->time - deployer.t0()}, 20ms) << "when it failed";
  EXPECT_EQ(outcomes[0].cores, std::vector<std::string>{"ramp/down"});
  EXPECT_EQ(deployer.status("control").core, "ramp/down");
  EXPECT_EQ(deployer.status("control").missed, 0u);
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
  EXPECT_EQ(deployer.generation(), 2u);
  EXPECT_LT(ramp::read(architecture.position), 2.0) << "it goes on from the state of the other one";
  EXPECT_TRUE(deployer.wanted_standby_cores().empty()) << "nothing falls back from the fallback";
}

TEST(Standby, TheCoreThatFailedIsFreedWithWhatIsCollectedThen) {
  FallingBack architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  const std::weak_ptr<const CoreBase> failed = architecture.control.bundle()->core;

  deployer.run_for(50ms);
  ASSERT_EQ(tend(deployer).size(), 1u);

  EXPECT_TRUE(failed.expired()) << "the next change would free it, on [control]";
}

TEST(Standby, AFreshCoreTakesOverWithinItsBudgetOfRestarts) {
  UnsteadyArchitecture architecture(
      {.action = FaultPolicy::Action::restart, .restarts = 2, .per = 1s, .back_off = 15ms});
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  std::vector<Outcome> outcomes;

  for (int i = 0; i < 40; ++i) {
    deployer.run_for(10ms);
    for (Outcome& one : tend(deployer)) outcomes.push_back(std::move(one));
    prepare_standby_cores(deployer);
  }

  ASSERT_EQ(outcomes.size(), 3u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::restarted);
  EXPECT_EQ(outcomes[2].kind, Outcome::Kind::stays_failed);
  EXPECT_EQ(outcomes[2].reason, "sensor lost; all 2 restarts within 1s are used up");
  EXPECT_EQ(deployer.status("control").state, ComponentState::faulted);
  EXPECT_EQ(deployer.status("control").fault, "sensor lost");
  EXPECT_EQ(outcomes[0].incident->job, 3u);
  EXPECT_EQ(outcomes[1].incident->job, 6u) << "each has a record of its own";
  EXPECT_EQ(deployer.status("control").incident->job, 9u);
  // Two jobs each, three times; the fault ends a job that counts; each restart waited longer.
  EXPECT_EQ(deployer.status("control").releases, 9u);
  EXPECT_EQ(deployer.status("control").missed, 3u) << "one in 15 ms, two in 30 ms";
}

/// Somebody looks after the system while it runs its first job.
struct Watched : ramp::Down {
  void update() override {
    static_cast<void>(tend(*deployer()));
    ramp::Down::update();
  }
  static Deployer*& deployer() {
    static Deployer* deployer = nullptr;
    return deployer;
  }
};

TEST(Standby, IsNotLostWhenSomebodyLooksDuringItsFirstJob) {
  UnsteadyArchitecture architecture({.action = FaultPolicy::Action::fallback});
  architecture.control.fall_back_to(ComponentBase::Fallback{CoreType::of<Watched>("watched"), {}});
  Deployer deployer(architecture, {.simulated = true});
  Watched::deployer() = &deployer;
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(35ms);  // the third job throws, the fourth is that of the standby core

  EXPECT_EQ(tend(deployer).size(), 1u);
  EXPECT_EQ(deployer.status("control").core, "watched");
}

/// Throws in its very first job.
struct Broken : ramp::Up {
  void update() override { throw std::runtime_error("wrong from the start"); }
};

TEST(Standby, ComesWithTheChangeAndTakesOverFromItsFirstJob) {
  FallingBack architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(5ms);

  ASSERT_TRUE(deployer.apply({{ramp::to_core<Broken>("broken")}}));
  deployer.run_for(20ms);  // nobody looks after it meanwhile

  const auto outcomes = tend(deployer);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::fell_back);
  EXPECT_EQ(outcomes[0].reason, "wrong from the start");
  EXPECT_EQ(deployer.status("control").core, "ramp/down");
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
  EXPECT_EQ(deployer.status("control").missed, 0u) << "at the next release";
}

TEST(Standby, AFreshCoreComesWithTheChangeAsWell) {
  UnsteadyArchitecture architecture(
      {.action = FaultPolicy::Action::restart, .restarts = 1, .per = 10s, .back_off = 0ms});
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  ASSERT_TRUE(deployer.apply({{ramp::to_core<Broken>("broken")}}));
  deployer.run_for(30ms);

  const auto outcomes = tend(deployer);
  ASSERT_EQ(outcomes.size(), 2u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::restarted);
  EXPECT_EQ(outcomes[1].kind, Outcome::Kind::stays_failed);
  EXPECT_EQ(deployer.status("control").fault, "wrong from the start");
  EXPECT_EQ(deployer.status("control").state, ComponentState::faulted) << "the fresh one failed";
}

/// To a core that fails in its first job, with another fallback core than before.
Change to_broken_with_another_fallback() {
  Change change{{ramp::to_core<Broken>("broken")}};
  change.fallbacks.push_back(
      {"control", ComponentBase::Fallback{CoreType::of<ramp::Up>("ramp/up"), {}}});
  return change;
}

TEST(Standby, IsTheFallbackCoreThatTheChangeNames) {
  FallingBack architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  ASSERT_TRUE(deployer.apply(to_broken_with_another_fallback()));
  deployer.run_for(30ms);

  ASSERT_EQ(tend(deployer).size(), 1u);
  EXPECT_EQ(deployer.status("control").core, "ramp/up");
  EXPECT_EQ(architecture.control.fallback()->core.name, "ramp/up");
}

TEST(Standby, IsTheOneFromBeforeAfterARollBack) {
  FallingBack architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  Change change = to_broken_with_another_fallback();
  change.probation.emplace();

  ASSERT_TRUE(deployer.apply(change));
  EXPECT_EQ(architecture.control.fallback()->core.name, "ramp/up");
  deployer.run_for(15ms);

  ASSERT_EQ(tend(deployer).size(), 1u);
  EXPECT_EQ(architecture.control.fallback()->core.name, "ramp/down");
}

TEST(Standby, OfTheNewCoreGoesWithItsRollback) {
  FallingBack architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  Change change{{ramp::to_core<Broken>("broken")}};
  change.probation.emplace();

  ASSERT_TRUE(deployer.apply(change));
  deployer.run_for(15ms);

  const auto outcomes = tend(deployer);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(deployer.wanted_standby_cores().size(), 1u) << "of the old one";
}

TEST(Standby, StandsByOnceAFaultedComponentIsStartedAgain) {
  UnsteadyArchitecture architecture({.action = FaultPolicy::Action::fallback});
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(25ms);
  ASSERT_EQ(deployer.status("control").state, ComponentState::faulted) << "it has no fallback core";
  const auto stays_failed = tend(deployer);
  ASSERT_EQ(stays_failed.size(), 1u);
  EXPECT_EQ(stays_failed[0].reason, "sensor lost; there is no fallback core");
  architecture.control.fall_back_to(
      ComponentBase::Fallback{CoreType::of<ramp::Down>("ramp/down"), {}});

  prepare_standby_cores(deployer);
  EXPECT_EQ(deployer.status("control").state, ComponentState::faulted) << "nobody started it";
  ASSERT_TRUE(deployer.start({"control"}));
  deployer.run_for(50ms);

  ASSERT_EQ(tend(deployer).size(), 1u);
  EXPECT_EQ(deployer.status("control").core, "ramp/down");
}

TEST(Standby, AChangeMakesItAnew) {
  FallingBack architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.disconnect("control.ports.out"));

  EXPECT_TRUE(tend(deployer).empty());
  EXPECT_TRUE(deployer.wanted_standby_cores().empty()) << "it came with the change";
  deployer.run_for(60ms);

  ASSERT_EQ(tend(deployer).size(), 1u);
  EXPECT_EQ(deployer.status("control").core, "ramp/down");
}

/// Can be configured when it is asked again.
struct Reluctant : ramp::Down {
  mauve::Status on_configure() override {
    if (!std::exchange(refuses(), false)) return mauve::ok();
    return mauve::refuse(mauve::Errc::hook_failed, "reluctant", "not now");
  }
  static bool& refuses() {
    static bool refuses = false;
    return refuses;
  }
};

/// The standby core could not come with the change.
struct FallingBackOnProbation : FallingBack {
  FallingBackOnProbation() {
    control.fall_back_to(ComponentBase::Fallback{CoreType::of<Reluctant>("reluctant"), {}});
    EXPECT_TRUE(deployer.deploy());
    Reluctant::refuses() = true;
    Change change{{ramp::to_core<ramp::Up>("other")}};
    change.probation.emplace();
    EXPECT_TRUE(deployer.apply(change));
  }
  Deployer deployer{*this, {.simulated = true}};
};

TEST(Standby, OfAChangeThatWasLedBackMeanwhileDoesNotStandBy) {
  FallingBackOnProbation system;
  const std::vector<Change> wanted = system.deployer.wanted_standby_cores();
  ASSERT_EQ(wanted.size(), 1u);
  auto prepared = system.deployer.prepare(wanted[0]);
  ASSERT_TRUE(prepared) << to_string(prepared.error());
  ASSERT_TRUE(system.deployer.undo());
  system.deployer.run_for(15ms);  // it is back, and nobody has looked yet

  system.deployer.stand_by(*prepared);

  EXPECT_EQ(system.deployer.wanted_standby_cores().size(), 1u) << "one for what runs now";
  prepare_standby_cores(system.deployer);
  system.deployer.run_for(50ms);  // the old core throws
  const auto outcomes = tend(system.deployer);
  ASSERT_EQ(outcomes.size(), 2u);
  EXPECT_EQ(outcomes[1].kind, Outcome::Kind::fell_back);
  EXPECT_EQ(system.deployer.status("control").core, "reluctant");
}

TEST(Standby, IsNotWantedWhileAChangeIsLedBack) {
  FallingBackOnProbation system;
  system.deployer.run_for(10900us);
  ASSERT_TRUE(system.deployer.undo());  // one more job comes before its instant

  EXPECT_TRUE(system.deployer.wanted_standby_cores().empty());
  system.deployer.run_for(15ms);
  EXPECT_EQ(system.deployer.wanted_standby_cores().size(), 1u);
}

TEST(Standby, DeploymentIsRefusedWhenTheFallbackCoreCannotBeConfigured) {
  UnsteadyArchitecture architecture({.action = FaultPolicy::Action::fallback});
  architecture.control.fall_back_to(
      ComponentBase::Fallback{CoreType::of<ramp::ThrowingOnConfigure>("ramp/throwing"), {}});
  Deployer deployer(architecture, {.simulated = true});

  const Status refused = deployer.deploy();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::hook_threw);
  EXPECT_EQ(refused.error().at, "control.fallback_core") << "control.core is sound";
}

/// Each job takes longer than the period.
struct Late : ramp::Up {
  void update() override {
    ramp::Up::update();
    clock()->advance(12ms);
  }
  static ManualClock*& clock() {
    static ManualClock* clock = nullptr;
    return clock;
  }
};

TEST(Standby, TheFallbackTakesOverAfterTooManyOverruns) {
  ramp::One<Late> architecture;
  architecture.control.task().on_overrun = OnOverrun::fallback;
  architecture.control.task().overrun_limit = 3;
  architecture.control.fall_back_to(
      ComponentBase::Fallback{CoreType::of<ramp::Down>("ramp/down"), {}});
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  Late::clock() = const_cast<ManualClock*>(dynamic_cast<const ManualClock*>(&deployer.clock()));

  deployer.run_for(200ms);

  const auto outcomes = tend(deployer);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::fell_back);
  EXPECT_EQ(outcomes[0].reason, "overran 3 times in 64 jobs");
  EXPECT_EQ(deployer.status("control").overruns, 3u);
}

TEST(Standby, AComponentThatOverranTooOftenHasItsWholeLimitAgainAfterAStart) {
  ramp::One<Late> architecture;
  architecture.control.task().on_overrun = OnOverrun::stop;
  architecture.control.task().overrun_limit = 3;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  Late::clock() = const_cast<ManualClock*>(dynamic_cast<const ManualClock*>(&deployer.clock()));
  deployer.run_for(200ms);
  ASSERT_EQ(deployer.status("control").overruns, 3u);
  ASSERT_EQ(deployer.status("control").state, ComponentState::stopped);

  ASSERT_TRUE(deployer.start({"control"}));
  deployer.run_for(200ms);

  EXPECT_EQ(deployer.status("control").overruns, 6u);
  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
}

TEST(Standby, StaysInForceWhenATransactionComesThatDoesNotKnowOfIt) {
  FallingBack architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(30900us);  // the standby core comes 100 us later, before the change
  Change change{{}};
  change.edits.emplace_back().member = "control";
  change.edits.back().mode = Mode::run;

  ASSERT_TRUE(deployer.apply(change));
  deployer.run_for(50ms);

  ASSERT_EQ(tend(deployer).size(), 1u);
  EXPECT_EQ(deployer.status("control").core, "ramp/down");
  EXPECT_EQ(ramp::read(architecture.position), -5.0) << "it counts down in every job";
}

}  // namespace
}  // namespace mauve
