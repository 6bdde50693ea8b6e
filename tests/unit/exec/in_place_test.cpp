// SPDX-License-Identifier: LGPL-3.0-or-later
/// Swaps in place, for a device that only one core can hold at a time.
#include <gtest/gtest.h>

#include "support/ramp.h"

namespace mauve {
namespace {

class InPlace : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(deployer.deploy()); }
  ComponentStatus control() { return deployer.status("control"); }

  ramp::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(InPlace, StopsCleansConfiguresAndStartsOnTheGrid) {
  deployer.run_for(100ms);

  const Result<Receipt> done = deployer.swap_core_in_place(ramp::to_core<ramp::Down>("ramp/down"));
  deployer.run_for(50ms);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_GE(done->components[0].pause, 1ms) << "the whole stop counts, not the exchange alone";
  EXPECT_EQ(control().core, "ramp/down");
  EXPECT_EQ(control().state, ComponentState::running);
  EXPECT_EQ(control().next_release.count() % 10'000'000, 0);
  EXPECT_LT(ramp::read(architecture.position), 10.0);
}

TEST_F(InPlace, MakesOneGeneration) {
  deployer.run_for(100ms);
  const auto before = deployer.generation();

  const Result<Receipt> done = deployer.swap_core_in_place(ramp::to_core<ramp::Down>("ramp/down"));

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->generation, before + 1);
  EXPECT_EQ(deployer.generation(), before + 1);
  EXPECT_FALSE(deployer.swap_core_in_place(ramp::to_core<ramp::ThrowingOnConfigure>("throwing")));
  EXPECT_EQ(deployer.generation(), before + 1) << "nothing is different";
}

TEST_F(InPlace, RollsBackInPlaceToTheCoreBefore) {
  const auto before = architecture.control.bundle();
  deployer.run_for(100ms);
  ASSERT_TRUE(deployer.swap_core_in_place(ramp::to_core<ramp::Down>("ramp/down")));
  deployer.run_for(50ms);

  auto back = deployer.prepare_back_in_place("control", before);
  ASSERT_TRUE(back) << to_string(back.error());
  ASSERT_TRUE(deployer.wait(*deployer.begin_in_place_park(*back)));
  const Status exchanged = deployer.in_place_exchange(*back);
  ASSERT_TRUE(exchanged);
  auto resumed = deployer.begin_in_place_resume(*back, exchanged);
  ASSERT_TRUE(resumed);
  ASSERT_TRUE(deployer.wait(**resumed));
  deployer.run_for(50ms);

  EXPECT_EQ(architecture.control.bundle(), before);
  EXPECT_EQ(control().state, ComponentState::running);
  EXPECT_EQ(control().next_release.count() % 10'000'000, 0);
}

/// The rollback of the change that brought a component takes it out, also while the rollback of a
/// swap in place is prepared for it.
TEST_F(InPlace, ParksNoComponentThatARollbackTookOut) {
  Change joins;
  joins.new_components.push_back(
      {std::make_shared<ComponentBase>("guest", architecture.control.type(),
                                       architecture.control.bundle()->core_type),
       {}});
  joins.probation.emplace();
  ASSERT_TRUE(deployer.apply(std::exchange(joins, {})));
  auto* const guest = architecture.find_component("guest");
  auto back = deployer.prepare_back_in_place("guest", guest->bundle());
  ASSERT_TRUE(back) << to_string(back.error());
  ASSERT_TRUE(deployer.undo());
  deployer.run_for(50ms);
  Retired retired;
  static_cast<void>(deployer.tend(retired));
  static_cast<void>(retired.release());

  const auto parked = deployer.wait(*deployer.begin_in_place_park(*back));

  ASSERT_FALSE(parked);
  EXPECT_EQ(parked.error().at, "guest");
  EXPECT_EQ(parked.error().code, Errc::conflict);
}

TEST_F(InPlace, LeavesAStoppedComponentStopped) {
  ASSERT_TRUE(deployer.stop({"control"}));

  const Result<Receipt> done = deployer.swap_core_in_place(ramp::to_core<ramp::Down>("ramp/down"));

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(control().core, "ramp/down");
  EXPECT_EQ(control().state, ComponentState::stopped);
}

TEST_F(InPlace, GoesBackToTheOldCoreWhenTheNewOneRefuses) {
  deployer.run_for(100ms);

  const Result<Receipt> refused =
      deployer.swap_core_in_place(ramp::to_core<ramp::ThrowingOnConfigure>("ramp/throwing"));
  deployer.run_for(50ms);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::hook_threw);
  EXPECT_EQ(control().state, ComponentState::running);
  EXPECT_GT(ramp::read(architecture.position), 10.0);
}

}  // namespace
}  // namespace mauve
