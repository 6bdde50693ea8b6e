// SPDX-License-Identifier: LGPL-3.0-or-later
/// Converters that crash or never return, at the boundary of a component on real threads.
#include <gtest/gtest.h>

#include <cstdlib>

#include "rt/thread/run_guarded.h"
#include "support/block.h"
#include "support/outcomes.h"
#include "support/positions.h"

namespace mauve {
namespace {

using ramp::PositionV1;
using ramp::PositionV2;
using test::Block;
using test::block;
using test::runs_on;

struct OldRevision : ramp::RampCore {
  State<PositionV1> state{*this};
  void update() override {
    state->metres = 20;
    shell().out.write(state->metres);
  }
};

using Converter = void (*)(const PositionV1&, PositionV2&) noexcept;

template <Converter Convert>
struct NewRevision : ramp::RampCore {
  State<PositionV2> state{*this};
  Converts<PositionV1, PositionV2> from_v1{state, Convert};
  void update() override { shell().out.write(7); }
};

void crash(const PositionV1& /*old*/, PositionV2& now) noexcept {
  int* volatile nobody = nullptr;
  now.jobs = 13;
  *nobody = 1;
}
void give_up(const PositionV1& /*old*/, PositionV2& /*now*/) noexcept { std::abort(); }
void spin(const PositionV1& /*old*/, PositionV2& /*now*/) noexcept {
  for (volatile bool for_ever = true; for_ever;) {
  }
}
void wait_for_ever(const PositionV1& /*old*/, PositionV2& /*now*/) noexcept { block()->wait(); }

struct Converting : ramp::Two<OldRevision> {
  Converting() { left.task().watchdog = 300ms; }
};

class Converters : public testing::Test {
 protected:
  void SetUp() override {
    if (!rt::kGuardsFaults) GTEST_SKIP() << "the sanitizer handles faults itself";
    block() = &blocks;
    ASSERT_TRUE(deployer.deploy());
    ASSERT_TRUE(runs_on(deployer, "left"));
  }
  template <Converter Convert>
  Result<Receipt> swap(bool on_probation) {
    Edit edit;
    edit.member = "left";
    edit.core = CoreType::of<NewRevision<Convert>>("new");
    Change change;
    change.edits.push_back(std::move(edit));
    if (on_probation) change.probation = Probation{};
    return deployer.apply(change);
  }
  template <Converter Convert>
  void expect_revoked() {
    const auto result = swap<Convert>(true);

    ASSERT_FALSE(result) << "it is not reported as applied";
    EXPECT_EQ(result.error().code, Errc::hook_threw) << to_string(result.error());
    EXPECT_EQ(result.error().at, "left");
    EXPECT_TRUE(test::eventually([&] {
      static_cast<void>(test::tend(deployer));
      return !deployer.on_probation();
    }));
    EXPECT_TRUE(runs_on(deployer, "left"));
    EXPECT_TRUE(runs_on(deployer, "right"));
    EXPECT_EQ(deployer.status("left").state, ComponentState::running);
    EXPECT_NE(deployer.status("left").core, "new");
    EXPECT_EQ(ramp::read(architecture.left_position), 20.0);
  }

  Block blocks;
  Converting architecture;
  Deployer deployer{architecture};
};

TEST_F(Converters, ThatCrashRevokeTheirChange) { expect_revoked<crash>(); }

TEST_F(Converters, ThatGiveUpRevokeTheirChange) { expect_revoked<give_up>(); }

TEST_F(Converters, ThatRunForEverRevokeTheirChange) { expect_revoked<spin>(); }

TEST_F(Converters, ThatWaitForEverLoseTheirThreadAndRevokeTheirChange) {
  expect_revoked<wait_for_ever>();
  blocks.let_go();
}

TEST_F(Converters, ThatCrashWithoutProbationStopTheirComponentWithSafeValues) {
  const auto result = swap<crash>(false);

  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Errc::partly) << to_string(result.error());
  EXPECT_EQ(deployer.status("left").state, ComponentState::faulted);
  EXPECT_EQ(deployer.status("left").fault, "its converter: SIGSEGV at address 0x0");
  EXPECT_EQ(ramp::read(architecture.left_position), -1.0);
  EXPECT_TRUE(runs_on(deployer, "right"));
}

/// A resource whose new core cannot take the state over.
struct MotorCore : Core<EmptyShell> {
  using Contract = MotorCore;
  static constexpr const char* contract = "motor/core/1";
  virtual void drive(const double& value) = 0;
};
struct OldMotor final : MotorCore {
  State<PositionV1> state{*this};
  void drive(const double& value) override { state->metres = value; }
};
template <Converter Convert>
struct NewMotor final : MotorCore {
  State<PositionV2> state{*this};
  Converts<PositionV1, PositionV2> from_v1{state, Convert};
  void drive(const double& /*value*/) override {}
};
struct MotorInterface : Interface<MotorCore> {
  WriteService<double> drive{*this, "drive", &MotorCore::drive};
};
struct WithMotor : Architecture {
  Resource<EmptyShell, OldMotor, MotorInterface> motor{*this, "motor"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> left{*this, "left"};
  Status on_configure() override { return left.shell().out.connect(motor.interface().drive); }
};

template <Converter Convert>
Change to_new_motor(const WithMotor& architecture) {
  Edit edit;
  edit.member = "motor";
  edit.resource = architecture.motor.type();
  edit.resource->core = CoreType::of<NewMotor<Convert>>("new");
  Change change;
  change.edits.push_back(std::move(edit));
  return change;
}

/// It is exchanged at a barrier, so nothing of it came into force.
template <Converter Convert>
void expect_resource_as_it_was(Errc why) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "the sanitizer handles faults itself";
  WithMotor architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(runs_on(deployer, "left"));

  const auto result = deployer.apply(to_new_motor<Convert>(architecture));

  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, why) << to_string(result.error());
  EXPECT_EQ(result.error().at, "motor");
  EXPECT_FALSE(architecture.motor.lock().poisoned());
  EXPECT_TRUE(runs_on(deployer, "left"));
  EXPECT_GT(architecture.motor.core().state->metres, 0.0) << "the state that it had";
}

TEST(ResourceConverters, ThatCrashLeaveTheirResourceAsItWas) {
  expect_resource_as_it_was<crash>(Errc::hook_threw);
}

TEST(ResourceConverters, ThatRunForEverLeaveTheirResourceAsItWas) {
  expect_resource_as_it_was<spin>(Errc::timed_out);
}

void to_millimetres(const PositionV1& old, PositionV2& now) noexcept { ramp::convert(old, now); }

TEST(ResourceConverters, AreInTheReceiptBesideTheDataThatARollbackBringsBack) {
  WithMotor architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(50ms);
  Change change = to_new_motor<to_millimetres>(architecture);
  change.probation = Probation{};
  const std::vector<std::string> notes = {
      "motor: a rollback brings the replaced resource back with its data from before the change, "
      "so outputs may jump"};
  const auto converted = [](const Receipt& receipt) {
    for (const MemberReceipt& row : receipt.components) {
      if (row.name == "motor") return row.converted;
    }
    return std::string("no row");
  };

  auto prepared = deployer.prepare(change);
  ASSERT_TRUE(prepared) << to_string(prepared.error());
  EXPECT_EQ(deployer.foresee(*prepared).notes, notes);
  EXPECT_EQ(converted(deployer.foresee(*prepared)), "ramp_position/1 -> ramp_position/2");
  Retired retired;
  const Result<Receipt> done = deployer.commit(*prepared, retired);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->notes, notes);
  EXPECT_EQ(converted(*done), "ramp_position/1 -> ramp_position/2");
  ASSERT_EQ(deployer.probations().size(), 1u);
  EXPECT_EQ(deployer.probations()[0].notes, notes) << "which undo says";
}

/// One that writes its safe values into a resource which crashes at them.
struct FragileMotor final : Core<EmptyShell> {
  Stateless stateless{*this};
  int* volatile nobody = nullptr;
  void drive(const double& value) {
    if (value < 0) *nobody = 1;
  }
};
struct FragileMotorInterface : Interface<FragileMotor> {
  WriteService<double> drive{*this, "drive", &FragileMotor::drive};
};
struct WithFragileMotor : Architecture {
  Resource<EmptyShell, FragileMotor, FragileMotorInterface> motor{*this, "motor"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> left{*this, "left"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> right{*this, "right"};
  Status on_configure() override { return left.shell().out.connect(motor.interface().drive); }
};

TEST(SafeValues, ThatCrashTheirResourcePoisonItAndNothingElse) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "the sanitizer handles faults itself";
  WithFragileMotor architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(runs_on(deployer, "left"));

  ASSERT_TRUE(deployer.stop({"left"}));

  EXPECT_TRUE(architecture.motor.lock().poisoned());
  EXPECT_EQ(deployer.status("left").state, ComponentState::stopped);
  EXPECT_TRUE(runs_on(deployer, "right"));
}

/// The same, but it keeps who gives it one; and a core that never comes back to write its own.
struct EndlessMotor final : Core<EmptyShell> {
  Stateless stateless{*this};
  void drive(const double& value) {
    for (volatile bool for_ever = value < 0; for_ever;) {
    }
  }
};
struct EndlessMotorInterface : Interface<EndlessMotor> {
  WriteService<double> drive{*this, "drive", &EndlessMotor::drive};
};
struct WaitingUp final : ramp::Up {
  void update() override {
    ramp::Up::update();
    if (state->value == 4) block()->wait();
  }
};
struct WithEndlessMotor : Architecture {
  Resource<EmptyShell, EndlessMotor, EndlessMotorInterface> motor{*this, "motor"};
  Component<ramp::Shell, WaitingUp, ramp::Fsm> left{*this, "left"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> right{*this, "right"};
  Status on_configure() override {
    left.task().watchdog = 1h;
    return left.shell().out.connect(motor.interface().drive);
  }
};

TEST(SafeValues, ThatNeverReturnDoNotHoldUpAStopOfAHungComponent) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "the sanitizer handles faults itself";
  Block blocks;
  block() = &blocks;
  WithEndlessMotor architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(test::eventually([&] { return blocks.entered.load(); }));

  const auto stopped = deployer.stop({"left"});

  ASSERT_FALSE(stopped) << "it is still in its job";
  EXPECT_EQ(stopped.error().code, Errc::partly);
  EXPECT_TRUE(architecture.motor.lock().poisoned()) << "the writer was aborted in it";
  EXPECT_TRUE(runs_on(deployer, "right"));
  blocks.let_go();
}

}  // namespace
}  // namespace mauve
