// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rules of changing a running component, on a clock that is moved by hand.
#include <gtest/gtest.h>

#include "support/ramp.h"

namespace mauve {
namespace {

/// A simulated deployment: logical time only.
class Swap : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(deployer.deploy()); }
  ComponentStatus control() { return deployer.status("control"); }

  ramp::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(Swap, RunsOneJobEachPeriodFromT0) {
  deployer.run_for(100ms);

  EXPECT_EQ(control().releases, 10u);
  EXPECT_EQ(ramp::read(architecture.position), 10.0);
}

TEST_F(Swap, ReplacesTheCoreAndHandsTheStateOver) {
  deployer.run_for(100ms);

  const Result<Receipt> receipt = deployer.swap_core<ramp::Down>("control");
  deployer.run_for(50ms);

  ASSERT_TRUE(receipt) << to_string(receipt.error());
  EXPECT_EQ(receipt->state, ChangeState::applied);
  EXPECT_EQ(receipt->generation, 2u);
  ASSERT_EQ(receipt->components.size(), 1u);
  EXPECT_EQ(receipt->components[0].name, "control");
  EXPECT_EQ(receipt->components[0].missed, 0u);
  EXPECT_EQ(receipt->components[0].bytes, sizeof(ramp::Position));
  EXPECT_EQ(ramp::read(architecture.position), 5.0);
}

TEST_F(Swap, KeepsTheReleaseGridOverManySwaps) {
  for (int i = 0; i < 50; ++i) {
    const Result<Receipt> done = i % 2 == 0 ? deployer.swap_core<ramp::Down>("control")
                                            : deployer.swap_core<ramp::Up>("control");
    ASSERT_TRUE(done) << to_string(done.error());
    deployer.run_for(10ms);
    EXPECT_EQ(control().next_release.count() % 10'000'000, 0);
  }

  EXPECT_EQ(control().missed, 0u);
  EXPECT_GE(control().releases, 50u);
}

TEST_F(Swap, NeverJumpsTheOutputByMoreThanOneStep) {
  double last = 0;
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(i % 2 == 0 ? deployer.swap_core<ramp::Down>("control")
                           : deployer.swap_core<ramp::Up>("control"));
    deployer.run_for(10ms);
    const double now = ramp::read(architecture.position);
    EXPECT_LE(std::abs(now - last), 1.0);
    last = now;
  }
}

TEST_F(Swap, CleansUpAndFreesTheOldCore) {
  const int before = ramp::Up::configured_cores();

  ASSERT_TRUE(deployer.swap_core<ramp::Up>("control"));

  EXPECT_EQ(ramp::Up::configured_cores(), before);
}

TEST_F(Swap, ChangesNothingWhenTheNewCoreRefusesItsConfiguration) {
  deployer.run_for(50ms);
  Edit edit = ramp::to_core<ramp::Up>("ramp/up");
  edit.properties.emplace_back("core.step", 7.0);

  const Result<Receipt> refused = deployer.apply({{edit}});
  deployer.run_for(50ms);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "control.core.step");
  EXPECT_EQ(refused.error().message, "must not be seven");
  EXPECT_EQ(deployer.generation(), 1u);
  EXPECT_EQ(ramp::read(architecture.position), 10.0);
}

TEST_F(Swap, ChangesNothingWhenTheNewCoreThrows) {
  const Result<Receipt> hook = deployer.swap_core<ramp::ThrowingOnConfigure>("control");
  const Result<Receipt> constructor = deployer.swap_core<ramp::ThrowingConstructor>("control");

  ASSERT_FALSE(hook);
  EXPECT_EQ(hook.error().code, Errc::hook_threw);
  EXPECT_NE(hook.error().message.find("no such device"), std::string::npos);
  ASSERT_FALSE(constructor);
  EXPECT_EQ(constructor.error().code, Errc::hook_threw);
  EXPECT_EQ(deployer.generation(), 1u);
}

TEST(SwapBefore, RefusesAComponentThatWasNeverConfigured) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.simulated = true});

  const Result<Receipt> refused = deployer.swap_core<ramp::Down>("control");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::wrong_state);
  EXPECT_NE(refused.error().message.find("is not deployed"), std::string::npos);
  EXPECT_FALSE(architecture.control.configured());
  EXPECT_TRUE(deployer.deploy()) << "nothing was spoilt";
}

TEST_F(Swap, RefusesACoreOfAnotherContract) {
  const Result<Receipt> refused = deployer.swap_core<ramp::Stranger>("control");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::type_mismatch);
  EXPECT_NE(refused.error().message.find("stranger/core/1"), std::string::npos);
}

TEST_F(Swap, RefusesAnUnknownComponentWithTheNearestName) {
  const Result<Receipt> refused = deployer.swap_core<ramp::Down>("contrl");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::unknown_name);
  EXPECT_EQ(refused.error().hint, "did you mean control?");
}

TEST_F(Swap, SetsAPropertyOfARunningCoreAndKeepsItsState) {
  deployer.run_for(100ms);

  const Result<Receipt> done = deployer.set("control.core.step", 5.0);
  deployer.run_for(10ms);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(ramp::read(architecture.position), 15.0);
  EXPECT_EQ(control().releases, 11u);
}

TEST_F(Swap, KeepsCountersOfACoreWhosePropertyIsSet) {
  deployer.run_for(100ms);
  ASSERT_TRUE(deployer.set("control.core.step", 5.0));
  deployer.run_for(10ms);

  EXPECT_EQ(architecture.control.ComponentBase::core().find_observable("jobs")->value(), Value(11));
}

TEST_F(Swap, RefusesAPropertyOutOfRange) {
  const Result<Receipt> refused = deployer.set("control.core.step", 11.0);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "control.core.step");
  EXPECT_EQ(refused.error().message, "11 is above the maximum 10 m");
}

TEST_F(Swap, RefusesToResetAnIntegratorSilently) {
  const CoreType forgetful = CoreType::of<ramp::Forgetful>("ramp/forgetful");
  ASSERT_TRUE(deployer.swap_core("control", forgetful, StatePolicy::drop));
  deployer.run_for(50ms);

  const Result<Receipt> refused = deployer.set("control.core.step", 2.0);
  const Result<Receipt> dropped = deployer.set("control.core.step", 2.0, StatePolicy::drop);

  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().hint.find("--state drop"), std::string::npos);
  EXPECT_TRUE(dropped);
}

TEST_F(Swap, ChangesThePeriodAtARelease) {
  deployer.run_for(100ms);

  ASSERT_TRUE(deployer.set("control.fsm.period", "20ms"));
  deployer.run_for(100ms);

  EXPECT_EQ(control().releases, 15u);
  EXPECT_EQ(control().missed, 0u);
  EXPECT_EQ(ramp::read(architecture.position), 15.0);
}

TEST_F(Swap, StopsWithTheSafeValueAndStartsOnTheGrid) {
  deployer.run_for(55ms);

  const Result<Receipt> stopped = deployer.stop({"control"});
  deployer.run_for(42ms);
  EXPECT_EQ(control().state, ComponentState::stopped);
  EXPECT_EQ(ramp::read(architecture.position), -1.0);
  EXPECT_EQ(control().releases, 6u);

  const Result<Receipt> started = deployer.start({"control"});
  deployer.run_for(20ms);

  ASSERT_TRUE(stopped);
  ASSERT_TRUE(started);
  EXPECT_EQ(control().state, ComponentState::running);
  EXPECT_EQ(control().next_release.count() % 10'000'000, 0);
  EXPECT_GT(ramp::read(architecture.position), 6.0) << "the core kept its state";
}

TEST_F(Swap, StartsFreshWhenTheChangeSaysDrop) {
  deployer.run_for(100ms);
  ASSERT_TRUE(deployer.stop({"control"}));

  ASSERT_TRUE(deployer.start({"control"}, true));
  deployer.run_for(20ms);

  EXPECT_LE(ramp::read(architecture.position), 3.0);
}

TEST_F(Swap, AnswersUnchangedWhenStoppingWhatIsStopped) {
  ASSERT_TRUE(deployer.stop({"control"}));
  const Result<Receipt> again = deployer.stop({"control"});

  ASSERT_TRUE(again);
  EXPECT_EQ(again->state, ChangeState::unchanged);
  EXPECT_EQ(again->generation, 2u);
}

TEST_F(Swap, DisconnectsWithTheSafeValueAndConnectsAgain) {
  deployer.run_for(50ms);

  ASSERT_TRUE(deployer.disconnect("control.ports.out"));
  deployer.run_for(50ms);
  EXPECT_EQ(ramp::read(architecture.position), -1.0);

  ASSERT_TRUE(deployer.connect("control.ports.out", "position.write"));
  deployer.run_for(10ms);
  EXPECT_EQ(control().missed, 0u);
  EXPECT_GE(ramp::read(architecture.position), 10.0);
}

TEST_F(Swap, RefusesToConnectTwiceOrToAnotherKind) {
  const Result<Receipt> twice = deployer.connect("control.ports.out", "position.write");
  const Result<Receipt> kind = deployer.connect("control.ports.speed", "speed.write");
  const Result<Receipt> port = deployer.connect("control.ports.sped", "speed.read");
  const Result<Receipt> service = deployer.connect("control.ports.speed", "speed.reed");

  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().code, Errc::duplicate);
  ASSERT_FALSE(kind);
  EXPECT_EQ(kind.error().code, Errc::type_mismatch);
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().hint, "did you mean control.ports.speed?");
  ASSERT_FALSE(service);
  EXPECT_EQ(service.error().hint, "did you mean speed.read?");
}

TEST_F(Swap, RefusesTheSameComponentTwiceInOneTransaction) {
  Edit edit;
  edit.member = "control";

  const Result<Receipt> refused = deployer.apply({{edit, edit}});

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::duplicate);
}

TEST_F(Swap, RefusesAChangeThatSomebodyElseOvertook) {
  Result<PreparedChange> slow = deployer.prepare({{ramp::to_core<ramp::Down>("ramp/down")}});
  ASSERT_TRUE(slow);
  ASSERT_TRUE(deployer.swap_core<ramp::Up>("control"));

  Retired retired;
  const Result<Receipt> refused = deployer.commit(*slow, retired);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::conflict);
}

TEST_F(Swap, CommitsAPreparedChangeOnAComponentThatWasStoppedMeanwhile) {
  Result<PreparedChange> slow = deployer.prepare({{ramp::to_core<ramp::Down>("ramp/down")}});
  ASSERT_TRUE(slow);
  ASSERT_TRUE(deployer.stop({"control"}));

  Retired retired;
  const Result<Receipt> done = deployer.commit(*slow, retired);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(control().core, "ramp/down");
  EXPECT_EQ(control().state, ComponentState::stopped) << "a swap does not start it";
}

TEST_F(Swap, MovesNothingWhileACoreIsPrepared) {
  deployer.run_for(50ms);
  struct Eager : ramp::Up {
    Status on_configure() override {
      shell().out.write(1000.0);
      return ok();
    }
  };

  ASSERT_TRUE(deployer.swap_core<Eager>("control"));

  EXPECT_LT(ramp::read(architecture.position), 1000.0);
}

TEST_F(Swap, ToAFreshCoreOfTheSameTypeKeepsItsProperties) {
  ASSERT_TRUE(deployer.set("control.core.step", 2.0));
  ASSERT_TRUE(deployer.stop({"control"}));

  ASSERT_TRUE(deployer.start({"control"}, true));

  EXPECT_EQ(architecture.control.bundle()->core->find_property("step")->value(), Value(2.0));
}

TEST(Set, KeepsTheOtherPropertiesOfTheCore) {
  struct Tuned : ramp::Up {
    Property<double> gain{*this, "gain", 1.0, "any"};
  };
  ramp::One<Tuned> architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.set("control.core.step", 2.0));

  ASSERT_TRUE(deployer.set("control.core.gain", 5.0));

  const CoreBase& core = *architecture.control.bundle()->core;
  EXPECT_EQ(core.find_property("gain")->value(), Value(5.0));
  EXPECT_EQ(core.find_property("step")->value(), Value(2.0));
}

}  // namespace
}  // namespace mauve
