// SPDX-License-Identifier: LGPL-3.0-or-later
/// On a simulated clock: no change loses a tick, and a state that cannot be converted is refused.
#include <gtest/gtest.h>
#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

#include "wheel.h"

namespace {

using namespace wheel;

struct Cart : mauve::Architecture {
  mauve::Component<Shell, V1, mauve::PeriodicFsm<Counter>> wheel{*this, "wheel"};
};

struct Versions : testing::Test {
  Versions() { EXPECT_TRUE(deployer.deploy()); }
  [[nodiscard]] double shown() const { return cart.wheel.core().shown; }

  Cart cart;
  mauve::Deployer deployer{cart, {.realtime = mauve::Realtime::off, .simulated = true}};
};

TEST_F(Versions, LoseNoTickInTwoChanges) {
  deployer.run_for(95ms);
  EXPECT_EQ(shown(), 10.0);
  ASSERT_TRUE(deployer.swap_core<V2>("wheel"));
  deployer.run_for(100ms);
  EXPECT_EQ(shown(), 20.0);
  ASSERT_TRUE(deployer.swap_core<V3>("wheel"));
  deployer.run_for(100ms);
  EXPECT_NEAR(shown(), 30 * kTick, 1e-12);
  EXPECT_EQ(deployer.status("wheel").missed, 0U);
}

TEST_F(Versions, RefuseAStateThatNobodyConverts) {
  deployer.run_for(95ms);
  const auto refused = deployer.swap_core<V3>("wheel");  // V3 converts from V2 only
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, mauve::Errc::type_mismatch);
  deployer.run_for(100ms);
  EXPECT_EQ(shown(), 20.0);  // V1 continues as if nothing had happened
}

TEST_F(Versions, BeginAnewOnlyWhenTheChangeSaysSo) {
  deployer.run_for(95ms);
  const auto core = mauve::CoreType::of<V3>("v3");
  ASSERT_TRUE(deployer.swap_core("wheel", core, mauve::StatePolicy::drop));
  deployer.run_for(100ms);
  EXPECT_NEAR(shown(), 10 * kTick, 1e-12);
}

}  // namespace
