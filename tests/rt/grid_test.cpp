// SPDX-License-Identifier: LGPL-3.0-or-later
/// The release grid on real threads: every release is T0 + k * period on the logical clock.
#include <gtest/gtest.h>

#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::eventually;

TEST(Grid, TwoTasksShareOneClockWhateverTheMachineDoes) {
  struct Two : Architecture {
    Component<ramp::Shell, ramp::Up, ramp::Fsm> fast{*this, "fast"};
    Component<ramp::Shell, ramp::Up, ramp::Fsm> slow{*this, "slow"};
    Status on_configure() override {
      fast.fsm().period = 1ms;
      slow.fsm().period = 4ms;
      slow.task().offset = 500us;
      return ok();
    }
  } architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  ASSERT_TRUE(eventually([&] { return deployer.status("slow").releases > 50; }));

  const ComponentStatus fast = deployer.status("fast");
  const ComponentStatus slow = deployer.status("slow");
  EXPECT_EQ(fast.next_release.count() % 1'000'000, 0);
  EXPECT_EQ(slow.next_release.count() % 4'000'000, 500'000);
  // Each release ran or was counted as missed: the clock never lost one.
  const ComponentStatus stopped = [&] {
    static_cast<void>(deployer.stop({"fast", "slow"}));
    return deployer.status("fast");
  }();
  EXPECT_EQ(stopped.releases + stopped.missed,
            static_cast<std::uint64_t>(stopped.next_release.count() / 1'000'000));
}

TEST(Grid, SwapsNeverShiftIt) {
  ramp::Architecture architecture;
  architecture.control.fsm().period = 1ms;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(i % 2 == 0 ? deployer.swap_core<ramp::Down>("control")
                           : deployer.swap_core<ramp::Up>("control"));
    EXPECT_EQ(deployer.status("control").next_release.count() % 1'000'000, 0);
  }
  ASSERT_TRUE(deployer.stop({"control"}));
  const ComponentStatus control = deployer.status("control");
  EXPECT_EQ(control.releases + control.missed,
            static_cast<std::uint64_t>(control.next_release.count() / 1'000'000));
}

}  // namespace
}  // namespace mauve
