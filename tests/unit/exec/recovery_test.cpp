// SPDX-License-Identifier: LGPL-3.0-or-later
/// A core that fails before its standby stands by, on a clock that is moved by hand.
#include <gtest/gtest.h>

#include <vector>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::tend;

/// Throws in its very first job.
struct Dead : ramp::Up {
  void update() override { throw std::runtime_error("wrong from the start"); }
};

struct WithFallback : ramp::One<ramp::Up> {
  WithFallback() {
    control.task().on_fault = {.action = FaultPolicy::Action::fallback};
    control.fall_back_to(ComponentBase::Fallback{CoreType::of<ramp::Down>("ramp/down"), {}});
    EXPECT_TRUE(deployer.deploy());
  }
  Deployer deployer{*this, {.simulated = true}};
};

void make_standby_cores(Deployer& deployer) {
  for (const Change& change : deployer.wanted_standby_cores()) {
    auto prepared = deployer.prepare(change);
    ASSERT_TRUE(prepared) << to_string(prepared.error());
    deployer.stand_by(*prepared);
  }
}

/// Its device is unplugged: every core fails in its first job.
struct Unplugged : ramp::One<Dead> {
  explicit Unplugged(FaultPolicy policy) {
    control.task().on_fault = policy;
    EXPECT_TRUE(deployer.deploy());
  }
  Deployer deployer{*this, {.simulated = true}};
};

TEST(Recovery, AFreshCoreThatFailsInItsFirstJobIsRestartedAsOftenAsThePolicyAllows) {
  Unplugged system({.action = FaultPolicy::Action::restart, .restarts = 3, .back_off = 20ms});
  Deployer& deployer = system.deployer;
  std::vector<Instant> restarted;
  std::vector<Outcome> outcomes;

  for (int i = 0; i < 60; ++i) {
    deployer.run_for(5ms);
    for (Outcome& one : tend(deployer)) {
      if (one.kind == Outcome::Kind::restarted) restarted.push_back(deployer.clock().now());
      outcomes.push_back(std::move(one));
    }
    if (i % 2 == 1) make_standby_cores(deployer);  // always later than the release after the fault
  }

  ASSERT_EQ(restarted.size(), 3u);
  EXPECT_EQ(restarted[1] - restarted[0], std::chrono::nanoseconds(40ms).count()) << "twice 20 ms";
  EXPECT_EQ(restarted[2] - restarted[1], std::chrono::nanoseconds(80ms).count()) << "twice that";
  ASSERT_EQ(outcomes.size(), 4u);
  EXPECT_EQ(outcomes[3].kind, Outcome::Kind::stays_failed);
  EXPECT_EQ(deployer.status("control").state, ComponentState::faulted);
  EXPECT_EQ(deployer.status("control").releases, 4u);
  EXPECT_EQ(deployer.status("control").missed, 1u + 3u + 7u) << "the releases of the back-off";
}

TEST(Recovery, AComponentWhoseStandbyCoreIsNotReadyIsSeenToRecover) {
  Unplugged system({.action = FaultPolicy::Action::restart, .restarts = 2, .back_off = 30ms});
  Deployer& deployer = system.deployer;
  deployer.run_for(35ms);  // the standby core of the deployment has failed as well
  ASSERT_EQ(tend(deployer).size(), 1u);

  const ComponentStatus status = deployer.status("control");

  EXPECT_EQ(status.state, ComponentState::recovering);
  EXPECT_EQ(status.fault, "wrong from the start");
  EXPECT_EQ(status.recovery.way, Recovery::Way::restart);
  EXPECT_EQ(status.recovery.restarts_left, 1u);
  EXPECT_GT(status.recovery.in, 50ms) << "of 60 ms from the fault on";
  EXPECT_EQ(ramp::read(system.position), -1.0) << "its output is safe";
  deployer.run_for(200ms);
  EXPECT_EQ(deployer.status("control").state, ComponentState::recovering) << "nobody made it yet";
}

TEST(Recovery, AComponentWhoseStandbyCoreIsRefusedIsFaultedAndSaysWhy) {
  Unplugged system({.action = FaultPolicy::Action::restart, .restarts = 3, .back_off = 0ms});
  Deployer& deployer = system.deployer;
  deployer.run_for(35ms);
  ASSERT_EQ(tend(deployer).size(), 1u);

  deployer.refuse_standby("control", "no device");

  EXPECT_EQ(deployer.status("control").state, ComponentState::faulted);
  const auto outcomes = tend(deployer);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::stays_failed);
  EXPECT_EQ(outcomes[0].component, "control");
  EXPECT_EQ(outcomes[0].reason, "wrong from the start; no device");
  make_standby_cores(deployer);
  deployer.run_for(50ms);
  EXPECT_EQ(deployer.status("control").state, ComponentState::faulted);
  EXPECT_TRUE(tend(deployer).empty());
}

TEST(Recovery, ARefusalForAComponentThatRunsChangesNothing) {
  WithFallback system;
  Deployer& deployer = system.deployer;

  deployer.refuse_standby("control", "no device");
  ASSERT_TRUE(deployer.apply({{ramp::to_core<Dead>("dead")}}));
  deployer.run_for(50ms);

  ASSERT_EQ(tend(deployer).size(), 1u);
  EXPECT_EQ(deployer.status("control").core, "ramp/down");
}

/// Waits for its second restart.
struct Recovering : Unplugged {
  Recovering()
      : Unplugged({.action = FaultPolicy::Action::restart, .restarts = 3, .back_off = 0ms}) {
    deployer.run_for(35ms);
    EXPECT_EQ(tend(deployer).size(), 1u);
    EXPECT_EQ(deployer.status("control").state, ComponentState::recovering);
  }
};

TEST(Recovery, AStopEndsTheWait) {
  Recovering system;
  Deployer& deployer = system.deployer;

  ASSERT_TRUE(deployer.stop({"control"}));
  make_standby_cores(deployer);
  deployer.run_for(50ms);

  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
  EXPECT_EQ(deployer.status("control").releases, 2u);
  EXPECT_TRUE(tend(deployer).empty());
}

TEST(Recovery, ADirectStopEndsTheWait) {
  Recovering system;
  Deployer& deployer = system.deployer;
  const auto stop = deployer.begin_direct_stop({"control"});
  while (!stop->advance()) deployer.run_for(1ms);

  make_standby_cores(deployer);
  deployer.run_for(50ms);

  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
  EXPECT_EQ(deployer.status("control").releases, 2u);
}

TEST(Recovery, AStartEndsTheWaitWithTheCoreThatFailed) {
  Recovering system;
  Deployer& deployer = system.deployer;

  ASSERT_TRUE(deployer.start({"control"}));
  deployer.run_for(15ms);

  EXPECT_EQ(deployer.status("control").releases, 3u);
  EXPECT_EQ(deployer.status("control").state, ComponentState::recovering) << "it failed again";
}

TEST(Recovery, AChangeOfTheCoreEndsTheWait) {
  Recovering system;
  Deployer& deployer = system.deployer;

  ASSERT_TRUE(deployer.swap_core<ramp::Down>("control"));
  make_standby_cores(deployer);
  deployer.run_for(50ms);

  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
  EXPECT_GE(deployer.status("control").releases, 6u);
  EXPECT_TRUE(tend(deployer).empty());
}

TEST(Recovery, AChangeThatKeepsTheFailedCoreDoesNotRunItAgain) {
  Recovering system;
  Deployer& deployer = system.deployer;

  ASSERT_TRUE(deployer.disconnect("control.ports.out"));

  EXPECT_EQ(deployer.status("control").state, ComponentState::recovering);
  EXPECT_EQ(deployer.status("control").releases, 2u)
      << "the standby core that came with it is next";
  deployer.run_for(15ms);
  ASSERT_EQ(tend(deployer).size(), 1u);
  EXPECT_EQ(deployer.status("control").releases, 3u);
}

TEST(Recovery, UndoOfAChangeEndsTheWait) {
  WithFallback system;
  Deployer& deployer = system.deployer;
  deployer.run_for(5ms);
  Change change{{ramp::to_core<Dead>("broken")}};
  change.probation.emplace();
  ASSERT_TRUE(deployer.apply(change));

  static_cast<void>(deployer.undo());
  deployer.run_for(15ms);

  ASSERT_EQ(tend(deployer).size(), 1u);
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
}

TEST(Recovery, ASwapInPlaceToACoreThatFailsAtOnceReachesTheFallbackCore) {
  WithFallback system;
  Deployer& deployer = system.deployer;
  deployer.run_for(5ms);

  ASSERT_TRUE(deployer.swap_core_in_place(ramp::to_core<Dead>("broken")));
  deployer.run_for(30ms);  // nobody has made its standby yet
  EXPECT_EQ(deployer.status("control").state, ComponentState::recovering);
  EXPECT_EQ(deployer.status("control").recovery.way, Recovery::Way::fallback);
  make_standby_cores(deployer);
  deployer.run_for(15ms);

  const auto outcomes = tend(deployer);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::fell_back);
  EXPECT_EQ(deployer.status("control").core, "ramp/down");
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
}

TEST(Recovery, AComponentCanBeRemovedWhileItWaits) {
  Recovering system;
  Deployer& deployer = system.deployer;
  const auto wanted = deployer.wanted_standby_cores();
  ASSERT_EQ(wanted.size(), 1u);
  Change change;
  change.remove.push_back("control");

  ASSERT_TRUE(deployer.apply(change));
  deployer.run_for(50ms);

  EXPECT_TRUE(tend(deployer).empty());
  EXPECT_TRUE(deployer.wanted_standby_cores().empty());
  EXPECT_TRUE(deployer.status().empty());
}

}  // namespace
}  // namespace mauve
