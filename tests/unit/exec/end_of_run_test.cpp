// SPDX-License-Identifier: LGPL-3.0-or-later
/// The end of a run leaves the next start what ran and what stood.
#include <gtest/gtest.h>

#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve {
namespace {

TEST(EndOfARun, IsNoStopOfWhatRan) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.stop({"control"}));
  ASSERT_TRUE(deployer.start({"control"}));
  const auto generation = deployer.generation();

  EXPECT_TRUE(deployer.shutdown(test::kPatience).empty());

  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
  EXPECT_TRUE(deployer.status("control").ran_until_end);
  EXPECT_EQ(deployer.generation(), generation) << "the end makes none";
}

TEST(EndOfARun, LeavesStoppedWhatWasStopped) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.stop({"control"}));

  EXPECT_TRUE(deployer.shutdown(test::kPatience).empty());

  EXPECT_FALSE(deployer.status("control").ran_until_end);
}

/// The start is decided, but its instant has not come when the run ends.
TEST(EndOfARun, IsNoStopOfWhatWasBeingStarted) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.stop({"control"}));
  Change change;
  change.edits.emplace_back();
  change.edits.back().member = "control";
  change.edits.back().mode = Mode::run;
  change.ends_stops = true;
  Result<PreparedChange> prepared = deployer.prepare(change);
  ASSERT_TRUE(prepared) << to_string(prepared.error());
  const auto starting = deployer.begin(*prepared);

  EXPECT_TRUE(deployer.shutdown(test::kPatience).empty());

  const Result<Receipt> started = deployer.wait(*starting);
  EXPECT_EQ(deployer.status("control").ran_until_end, started.has_value());
  EXPECT_EQ(deployer.generation(), started ? started->generation : 2U);
}

}  // namespace
}  // namespace mauve
