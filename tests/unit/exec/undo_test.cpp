// SPDX-License-Identifier: LGPL-3.0-or-later
/// An undo takes back what its caller was shown, on real threads.
#include <gtest/gtest.h>

#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::eventually;

TEST(UndoOfWhatWasShown, BringsNoChangeIntoForceBetweenTheLookAtAProbationAndItsUndo) {
  ramp::Architecture architecture;
  architecture.control.fsm().period = 1ms;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());
  Change wanted{{ramp::to_core<ramp::Down>("down", "control")}};
  wanted.probation = Probation{.confirm_within = 1h};
  auto change = deployer.prepare(wanted);
  ASSERT_TRUE(change);
  const auto before = deployer.status("control").core;
  const auto ongoing = deployer.begin(*change);
  deployer.stand_still(true);
  const auto releases = deployer.status("control").releases;
  ASSERT_TRUE(eventually([&] { return deployer.status("control").releases > releases + 5; }));
  deployer.stand_still(false);

  EXPECT_FALSE(deployer.undo("of a change that has ended", {1}));

  EXPECT_EQ(deployer.generation(), 1u) << "the undo took no other change further";
  ASSERT_TRUE(eventually([&] { return ongoing->advance(); }));
  ASSERT_TRUE(ongoing->result());
  ASSERT_EQ(deployer.probations().size(), 1u);
  EXPECT_FALSE(deployer.probations()[0].rolls_back);
  EXPECT_TRUE(deployer.undo("of what was shown", deployer.probations()[0].generations));
  EXPECT_TRUE(eventually([&] { return deployer.status("control").core == before; }));
}

}  // namespace
}  // namespace mauve
