// SPDX-License-Identifier: LGPL-3.0-or-later
/// Deployment on real threads; assertions on counts and the logical clock only.
#include <gtest/gtest.h>

#include <thread>

#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::eventually;

TEST(Deployer, RunsComponentsOnThreads) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());

  EXPECT_TRUE(eventually([&] { return deployer.status("control").releases > 20; }));
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
  EXPECT_TRUE(deployer.shutdown().empty());
  EXPECT_EQ(ramp::read(architecture.position), -1.0) << "safe value at shutdown";
}

TEST(Deployer, SwapsWhileItRuns) {
  ramp::Architecture architecture;
  architecture.control.fsm().period = 1ms;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());

  for (int i = 0; i < 200; ++i) {
    const Result<Receipt> done = i % 2 == 0 ? deployer.swap_core<ramp::Down>("control")
                                            : deployer.swap_core<ramp::Up>("control");
    ASSERT_TRUE(done) << to_string(done.error());
    EXPECT_EQ(done->generation, static_cast<std::uint64_t>(i + 2));
  }
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
}

TEST(Deployer, ChangesAComponentThatSleepsLongAtOnce) {
  ramp::Architecture architecture;
  architecture.control.fsm().period = 60s;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([&] { return deployer.status("control").releases == 1; }));

  const Result<Receipt> swapped = deployer.swap_core<ramp::Down>("control");
  const Result<Receipt> stopped = deployer.stop({"control"});

  EXPECT_TRUE(swapped);
  EXPECT_TRUE(stopped);
  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
}

struct Hanging : ramp::Up {
  void update() override {
    while (!released().load()) std::this_thread::sleep_for(1ms);
  }
  static std::atomic<bool>& released() {
    static std::atomic<bool> flag{false};
    return flag;
  }
};

struct HangingArchitecture : Architecture {
  SharedData<double> position{*this, "position"};
  Component<ramp::Shell, Hanging, ramp::Fsm> control{*this, "control"};
  Status on_configure() override { return control.shell().out.connect(position.write_service()); }
};

TEST(Deployer, TakesAChangeBackWhenTheComponentNeverEndsItsJob) {
  Hanging::released() = false;
  HangingArchitecture architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([&] { return deployer.status("control").releases == 1; }));

  const Result<Receipt> refused = deployer.swap_core<ramp::Down>("control");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::timed_out);
  EXPECT_EQ(deployer.generation(), 1u);
  Hanging::released() = true;
  EXPECT_TRUE(eventually([&] { return deployer.status("control").releases > 3; }));
  EXPECT_TRUE(deployer.swap_core<ramp::Down>("control")) << "the mailbox is free again";
}

TEST(Deployer, TellsHowLateAJobIsThatDoesNotEnd) {
  Hanging::released() = false;
  HangingArchitecture architecture;
  architecture.control.fsm().period = 1ms;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());

  EXPECT_TRUE(eventually([&] { return deployer.status("control").late > 20ms; }));
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
  EXPECT_EQ(deployer.status("control").overruns, 0u) << "counted when the job has ended";

  Hanging::released() = true;
  EXPECT_TRUE(eventually([&] { return deployer.status("control").late == Duration{0}; }));
}

TEST(Deployer, SaysOfNoComponentThatItIsLateWhileItWaitsOrIsParked) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off, .simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(55ms);

  EXPECT_EQ(deployer.status("control").late, Duration{0});
  ASSERT_TRUE(deployer.stop({"control"}));
  deployer.run_for(1s);
  EXPECT_EQ(deployer.status("control").late, Duration{0});
}

TEST(Deployer, ConnectsWithALimitOnTheAge) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off, .simulated = true});
  ASSERT_TRUE(deployer.deploy());

  ASSERT_TRUE(deployer.connect("control.ports.speed", "speed.read", 50ms));

  const ComponentBase& control = architecture.control;
  const auto& bindings = *control.bundle()->bindings;
  EXPECT_EQ(bindings[control.shell().find_port("speed")->index()]->max_age(), 50ms);
}

TEST(Deployer, RefusesALimitOnTheAgeOfWhatAPortWrites) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off, .simulated = true});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.disconnect("control.ports.out"));

  const Result<Receipt> refused = deployer.connect("control.ports.out", "position.write", 50ms);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::invalid_value);
  EXPECT_EQ(refused.error().at, "control.ports.out");
}

TEST(Deployer, ShutsDownInBoundedTimeAndWritesSafeValuesForACoreThatHangs) {
  Hanging::released() = false;
  // Never freed: a thread stays in them.
  static auto* const architecture = new HangingArchitecture;
  static auto* const deployer = new Deployer(*architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer->deploy());
  ASSERT_TRUE(eventually([&] { return deployer->status("control").releases == 1; }));

  const std::vector<std::string> left_behind = deployer->shutdown(200ms);

  EXPECT_EQ(left_behind, std::vector<std::string>{"control"});
  EXPECT_EQ(ramp::read(architecture->position), -1.0);
}

TEST(Deployer, RefusesACpuThatTheMachineDoesNotHave) {
  ramp::Architecture architecture;
  architecture.control.task().cpus = {999};
  Deployer deployer(architecture, {.realtime = Realtime::off});

  const Status refused = deployer.deploy();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "control.task.cpus");
}

TEST(Deployer, ParksComponentsThatAreNotToStart) {
  ramp::Architecture architecture;
  architecture.control.task().start = false;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());

  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
  ASSERT_TRUE(deployer.start({"control"}));
  EXPECT_TRUE(eventually([&] { return deployer.status("control").releases > 3; }));
}

}  // namespace
}  // namespace mauve
