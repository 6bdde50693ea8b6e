// SPDX-License-Identifier: LGPL-3.0-or-later
// The runtime calls on_stop() of a core once for each orderly stop of its component. The call comes
// after the last job, and before the safe values of the ports. The component stands then, also when
// the core throws or hangs.
#include <gtest/gtest.h>

#include <stdexcept>

#include "support/block.h"
#include "support/eventually.h"
#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::eventually;

/// The last doings of the cores of this test.
struct Told {
  std::atomic<int> stops{0};
  std::atomic<int> jobs{0};
  std::atomic<int> jobs_at_stop{0};
  std::atomic<bool> configured_at_stop{false};
  std::atomic<bool> wrote{false};
};
Told& told() {
  static Told told;
  return told;
}

struct Listening : ramp::Up {
  void update() override {
    ramp::Up::update();
    ++told().jobs;
  }
  void on_stop() override {
    ++told().stops;
    told().jobs_at_stop = told().jobs.load();
    told().configured_at_stop = configured();
    told().wrote = shell().out.write(4711.0);
  }
};
struct ThrowingInStop : Listening {
  void on_stop() override {
    Listening::on_stop();
    throw std::runtime_error("the device does not answer");
  }
};
struct HangingInStop : Listening {
  volatile bool forever = true;
  void on_stop() override {
    Listening::on_stop();
    while (forever) {
    }
  }
};
struct Failing : Listening {
  void update() override {
    Listening::update();
    if (state->value > 3) throw std::runtime_error("sensor lost");
  }
};

template <typename Core>
class Stopped : public testing::Test {
 protected:
  void SetUp() override {
    told().stops = told().jobs = told().jobs_at_stop = 0;
    told().wrote = false;
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(95ms);
  }
  [[nodiscard]] ComponentStatus control() const { return deployer.status("control"); }

  ramp::One<Core> architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

class StopHook : public Stopped<Listening> {};

TEST_F(StopHook, IsCalledAfterTheLastJobAndBeforeTheSafeValues) {
  ASSERT_TRUE(deployer.stop({"control"}));
  deployer.run_for(50ms);

  EXPECT_EQ(told().stops, 1);
  EXPECT_EQ(told().jobs_at_stop, told().jobs) << "no job comes after it";
  EXPECT_TRUE(told().wrote) << "it may write";
  EXPECT_EQ(ramp::read(architecture.position), -1.0) << "and the safe value has the last word";
  EXPECT_EQ(control().state, ComponentState::stopped);
  EXPECT_EQ(control().faults, 0U);
}

TEST_F(StopHook, IsNotCalledAgainWhileTheComponentStands) {
  ASSERT_TRUE(deployer.stop({"control"}));
  ASSERT_TRUE(deployer.stop({"control"}));
  ASSERT_TRUE(deployer.start({"control"}));
  deployer.run_for(30ms);
  EXPECT_EQ(told().stops, 1);

  ASSERT_TRUE(deployer.stop_all());
  EXPECT_EQ(told().stops, 2) << "once for each stop";
}

TEST_F(StopHook, IsCalledAtTheEndOfTheSystem) {
  deployer.shutdown();
  EXPECT_EQ(told().stops, 1);
}

TEST_F(StopHook, IsCalledWhenTheComponentLeaves) {
  Change leaves;
  leaves.remove = {"control"};

  ASSERT_TRUE(deployer.apply(leaves));

  EXPECT_EQ(told().stops, 1);
  EXPECT_TRUE(told().configured_at_stop) << "before it is cleaned up";
}

TEST_F(StopHook, IsCalledBeforeASwapInPlace) {
  ASSERT_TRUE(deployer.swap_core_in_place(ramp::to_core<ramp::Down>("ramp/down")));

  EXPECT_EQ(told().stops, 1);
  EXPECT_TRUE(told().configured_at_stop);
}

TEST_F(StopHook, IsNotCalledWhenAnotherCoreTakesOver) {
  ASSERT_TRUE(deployer.apply({{ramp::to_core<ramp::Down>("ramp/down")}}));
  deployer.run_for(50ms);
  EXPECT_EQ(told().stops, 0) << "the device goes on with the next core";
}

class StopHookOfACoreThatFails : public Stopped<Failing> {};

TEST_F(StopHookOfACoreThatFails, IsNotCalled) {
  ASSERT_EQ(control().state, ComponentState::faulted);
  ASSERT_TRUE(deployer.stop({"control"}));
  EXPECT_EQ(told().stops, 0) << "no failure leads back to the core that failed";
}

class StopHookThatThrows : public Stopped<ThrowingInStop> {};

TEST_F(StopHookThatThrows, HoldsNoStopUpAndIsAFault) {
  ASSERT_TRUE(deployer.stop({"control"}));

  EXPECT_EQ(control().state, ComponentState::stopped);
  EXPECT_EQ(control().faults, 1U);
  EXPECT_EQ(ramp::read(architecture.position), -1.0);
  ASSERT_TRUE(deployer.start({"control"}));
  const auto jobs = told().jobs.load();
  deployer.run_for(50ms);
  EXPECT_GT(told().jobs, jobs);
}

/// On threads: the guard ends what does not return.
class StopHookOnThreads : public testing::Test {
 protected:
  void SetUp() override { told().stops = told().jobs = 0; }
};

TEST_F(StopHookOnThreads, IsCalledForADirectStop) {
  ramp::One<Listening> architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off, .admission = Admission::off});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([] { return told().jobs > 3; }));

  const auto stop = deployer.begin_direct_stop({});
  ASSERT_TRUE(stop);
  ASSERT_TRUE(eventually([&] { return stop->advance(); }));

  EXPECT_EQ(told().stops, 1);
  EXPECT_EQ(ramp::read(architecture.position), -1.0);
  ASSERT_TRUE(deployer.stop_all());
  EXPECT_EQ(told().stops, 1) << "the ordinary stop finds it standing";
}

TEST_F(StopHookOnThreads, IsEndedByTheGuardAndTheComponentStands) {
  ramp::Two<HangingInStop, Listening> architecture;
  architecture.left.task().watchdog = 300ms;
  Deployer deployer(architecture, {.realtime = Realtime::off, .admission = Admission::off});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([&] { return deployer.status("left").releases > 3; }));

  static_cast<void>(deployer.stop({"left"}));

  ASSERT_TRUE(eventually([&] { return deployer.status("left").faults > 0; }));
  EXPECT_TRUE(eventually([&] { return ramp::read(architecture.left_position) == -1.0; }));
  const auto releases = deployer.status("left").releases;
  EXPECT_NE(deployer.status("left").state, ComponentState::running);
  const auto others = deployer.status("right").releases;
  EXPECT_TRUE(eventually([&] { return deployer.status("right").releases > others + 5; }));
  EXPECT_EQ(deployer.status("left").releases, releases) << "it runs no more job";
  ASSERT_TRUE(deployer.start({"left"}, /*reset=*/true));
  EXPECT_TRUE(eventually([&] { return deployer.status("left").releases > releases + 3; }));
}

}  // namespace
}  // namespace mauve
