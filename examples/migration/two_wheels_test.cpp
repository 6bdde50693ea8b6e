// SPDX-License-Identifier: LGPL-3.0-or-later
/// The controller alone with poses that the test gives, and the whole robot on a simulated clock.
#include <gtest/gtest.h>
#include <mauve/test_kit.h>

#include "base.h"
#include "controller.h"

namespace {

using namespace two_wheels;

struct GoToTest : testing::Test {
  GoToTest() { EXPECT_TRUE(bench.configure()); }
  /// One job each 10 ms.
  Wheels command_after(int jobs) {
    for (int i = 0; i < jobs; ++i) {
      bench.advance(10ms);
      bench.core().update();
    }
    return bench.written(bench.shell().wheels).value();
  }
  mauve::CoreBench<ControllerShell, GoTo> bench;
};

TEST_F(GoToTest, StandsWhileThePoseIsNotKnown) {
  EXPECT_EQ(command_after(100).left, 0.0);
  EXPECT_EQ(command_after(100).right, 0.0);
}

TEST_F(GoToTest, TurnsLeftToAGoalOnTheLeft) {
  bench.give(bench.shell().pose, Pose{});
  const Wheels command = command_after(100);
  EXPECT_GT(command.right, command.left);
}

TEST_F(GoToTest, ChangesNoWheelByMoreThanOneStepInAJob) {
  bench.give(bench.shell().pose, Pose{});
  EXPECT_NEAR(command_after(1).right, 0.02, 1e-12);
  EXPECT_NEAR(command_after(1).right, 0.04, 1e-12);
}

TEST_F(GoToTest, UsesNeitherHeapNorKernelInAJob) {
  bench.give(bench.shell().pose, Pose{});
  command_after(1);
  const mauve::JobCost cost = bench.cost([&] { bench.core().update(); });
  EXPECT_EQ(cost.heap_calls.value_or(0), 0U);
  EXPECT_EQ(cost.system_calls.value_or(0), 0U);
}

struct Robot : mauve::Architecture {
  mauve::SharedData<Pose> pose{*this, "pose"};
  mauve::SharedData<Wheels> wheels{*this, "wheels"};
  mauve::Component<BaseShell, Base, mauve::PeriodicFsm<Base>> base{*this, "base"};
  mauve::Component<ControllerShell, GoTo, mauve::PeriodicFsm<Controller>> controller{*this,
                                                                                     "controller"};

  mauve::Status on_configure() override {
    base.shell().wheels.connect(wheels.read_service());
    base.shell().pose.connect(pose.write_service());
    controller.shell().pose.connect(pose.read_service());
    controller.shell().wheels.connect(wheels.write_service());
    return mauve::ok();
  }
};

struct RobotTest : testing::Test {
  RobotTest() { EXPECT_TRUE(deployer.deploy()); }
  Robot robot;
  mauve::Deployer deployer{robot, {.realtime = mauve::Realtime::off, .simulated = true}};
};

TEST_F(RobotTest, DrivesToItsGoal) {
  deployer.run_for(30s);
  const Pose pose = *robot.base.core().state;
  EXPECT_NEAR(std::hypot(pose.x - 2.0, pose.y - 1.0), 0.0, 0.06);
  EXPECT_EQ(deployer.status("controller").missed, 0U);
}

TEST_F(RobotTest, SlowsDownStepByStepAfterASwap) {
  deployer.run_for(2s);
  const double before = robot.controller.core().command->left;
  ASSERT_GT(before, 0.1);
  ASSERT_TRUE(deployer.swap_core<Stop>("controller"));
  deployer.run_for(10ms);
  EXPECT_NEAR(robot.controller.core().command->left, before - 0.02, 1e-12);
}

}  // namespace
