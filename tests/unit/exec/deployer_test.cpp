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
  EXPECT_TRUE(deployer.shutdown(test::kPatience).empty());
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

TEST(Deployer, MakesNoGenerationBeforeTheCallerOfTheChangeBeforeKnowsItsOwn) {
  ramp::Two<ramp::Up> architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  const std::uint64_t before = deployer.generation();
  Change change{{ramp::to_core<ramp::Down>("down", "left")}};
  Result<PreparedChange> prepared = deployer.prepare(change);
  ASSERT_TRUE(prepared);

  const auto swap = deployer.begin(*prepared);
  const auto stop = deployer.begin_stop({"right"});
  ASSERT_TRUE(stop);
  deployer.run_for(30ms);  // both are carried out
  ASSERT_TRUE(swap->advance());
  EXPECT_FALSE((*stop)->advance());
  EXPECT_EQ(deployer.generation(), before + 1);
  EXPECT_EQ(swap->result()->generation, before + 1);

  for (int looks = 0; looks < 5 && !(*stop)->advance(); ++looks) deployer.run_for(30ms);
  ASSERT_TRUE((*stop)->advance());
  EXPECT_EQ((*stop)->result()->generation, before + 2);
}

TEST(Deployer, MakesTheNextGenerationWhenNobodyLooksAtTheOneBefore) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  Change change{{ramp::to_core<ramp::Down>("down", "control")}};
  Result<PreparedChange> prepared = deployer.prepare(change);
  ASSERT_TRUE(prepared);
  const auto swap = deployer.begin(*prepared);
  deployer.run_for(30ms);
  ASSERT_TRUE(swap->advance());

  EXPECT_TRUE(deployer.stop({"control"}));
}

TEST(Deployer, CountsGenerationsOnFromTheFirst) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.simulated = true, .first_generation = 41});
  ASSERT_TRUE(deployer.deploy());
  EXPECT_EQ(deployer.generation(), 41u);

  const Result<Receipt> done = deployer.swap_core<ramp::Down>("control");

  ASSERT_TRUE(done);
  EXPECT_EQ(done->generation, 42u);
}

TEST(Deployer, ShowsNoChangeWhileItStandsStill) {
  ramp::Architecture architecture;
  architecture.control.fsm().period = 1ms;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());
  auto change = deployer.prepare({{ramp::to_core<ramp::Down>("down", "control")}});
  ASSERT_TRUE(change);
  const auto before = deployer.status("control").core;

  const auto ongoing = deployer.begin(*change);
  deployer.stand_still(true);
  const auto releases = deployer.status("control").releases;
  ASSERT_TRUE(eventually([&] { return deployer.status("control").releases > releases + 5; }));
  EXPECT_EQ(deployer.status("control").core, before);
  EXPECT_EQ(deployer.generation(), 1u);

  deployer.stand_still(false);
  EXPECT_TRUE(eventually([&] { return deployer.status("control").core == "down"; }));
  EXPECT_EQ(deployer.generation(), 2u);
  EXPECT_TRUE(ongoing->advance());
}

TEST(Deployer, LetsAComponentJoinThatWaitsForTheNextReleaseOfItsGrid) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([&] { return deployer.status("control").releases > 1; }));
  auto joining = std::make_shared<ComponentBase>(
      "second",
      ComponentType{"ramp", ShellType::of<ramp::Shell>(), FsmType::of<ramp::Fsm>("ramp"), "up"},
      CoreType::of<ramp::Up>("up"));
  static_cast<ramp::Fsm&>(joining->fsm()).period = 60s;
  Change change;
  change.new_components.push_back({joining, {}});

  const Result<Receipt> done = deployer.apply(change);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(deployer.status("second").state, ComponentState::running);
  EXPECT_EQ(deployer.status("second").releases, 0u) << "T0 is long over";
  EXPECT_EQ(deployer.status("second").next_release, 60s);
  EXPECT_EQ(deployer.status("second").missed, 0u);
  static_cast<void>(deployer.shutdown());
}

struct Amplifier : Core<Shell> {
  Property<double> gain{*this, "gain", 2.0, "of the amplifier"};
  State<ramp::Position> state{*this};
  double read() { return gain; }
};
struct AmplifierInterface : Interface<Amplifier> {
  ReadService<double> read{*this, "read", &Amplifier::read};
};
struct AmplifierArchitecture : Architecture {
  Resource<Shell, Amplifier, AmplifierInterface> amplifier{*this, "amplifier"};
};

TEST(Deployer, HandsTheStateOfAResourceOverAndSaysHowMuch) {
  AmplifierArchitecture architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  const Result<Receipt> done = deployer.set("amplifier.core.gain", 3.0);

  ASSERT_TRUE(done) << to_string(done.error());
  ASSERT_EQ(done->components.size(), 1u);
  EXPECT_EQ(done->components[0].bytes, sizeof(ramp::Position));
  EXPECT_EQ(done->generation, 2u);
}

TEST(Deployer, RefusesToChangeAResourceThatACallerDoesNotLeave) {
  AmplifierArchitecture architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  std::atomic<bool> held{false};
  std::atomic<bool> released{false};
  std::thread caller([&] {
    const ScopedLock scope(architecture.amplifier.lock());
    held = true;
    while (!released) std::this_thread::sleep_for(1ms);
  });
  ASSERT_TRUE(eventually([&] { return held.load(); }));

  const Result<Receipt> refused = deployer.set("amplifier.core.gain", 3.0);
  released = true;
  caller.join();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::timed_out);
  EXPECT_EQ(refused.error().at, "amplifier");
  EXPECT_EQ(deployer.generation(), 1u);
  EXPECT_EQ(architecture.amplifier.core().gain.get(), 2.0);
  EXPECT_TRUE(deployer.set("amplifier.core.gain", 3.0));
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
