// SPDX-License-Identifier: LGPL-3.0-or-later
/// A robot in random worlds whose guidance core is replaced on its way, by the runtime and with the
/// real plugin: 300 worlds of each kind are driven by `scripts/bench robot`.
#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

#include "../../plugins/world/random.h"
#include "support/deployed_control.h"
#include "support/drive.h"

namespace {

using support::DeployedControl;
using support::SwapDrive;
namespace drive = support::drive;

constexpr const char* kField = "guidance/potential_field";
constexpr const char* kFiniteTime = "guidance/finite_time";

void expect_safe(const char* first, const char* second, const drive::Worlds& worlds, int count) {
  mauve::plugin::Catalog catalog({MAUVE_PLUGIN_DIR});
  world::Random random(5);
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(count); ++seed) {
    DeployedControl control(catalog, first);
    ASSERT_EQ(control.error(), "");
    const SwapDrive drive = support::drive_and_swap(control, second, random.uniform(0.0, 12.0),
                                                    worlds.world(seed), worlds.goal(), seed, {});

    EXPECT_TRUE(drive.swapped) << worlds.name << " " << seed;
    EXPECT_TRUE(drive.run.reached) << worlds.name << " " << seed;
    EXPECT_GT(drive.run.clearance, drive::kTouching) << worlds.name << " " << seed;
    EXPECT_LE(drive.run.jump, 1.0 + 1e-9) << worlds.name << " " << seed;
    EXPECT_EQ(drive.missed, 0U);
  }
}

TEST(GuidanceSwap, ChangesNothingInSafetyAtAnyMoment) {
  expect_safe(kField, kFiniteTime, drive::kOpen, 12);
  expect_safe(kFiniteTime, kField, drive::kOpen, 12);
  expect_safe(kField, kFiniteTime, drive::kDense, 12);
  expect_safe(kFiniteTime, kField, drive::kDense, 12);
}

TEST(GuidanceSwap, DrivesWithoutOneAsTheLawAloneDoes) {
  mauve::plugin::Catalog catalog({MAUVE_PLUGIN_DIR});
  const drive::World world = drive::kOpen.world(6);
  DeployedControl control(catalog, kFiniteTime);
  ASSERT_EQ(control.error(), "");

  const SwapDrive deployed =
      support::drive_and_swap(control, kField, drive::kNever, world, drive::kOpen.goal(), 6, {});
  const drive::Outcome alone =
      drive::drive(drive::driven_by(drive::finite_time()), world, drive::kOpen.goal(), 6, {});

  EXPECT_NEAR(deployed.run.seconds, alone.seconds, 0.5);
  EXPECT_NEAR(deployed.run.length, alone.length, 0.1);
  EXPECT_NEAR(deployed.run.clearance, alone.clearance, 0.05);
}

}  // namespace
