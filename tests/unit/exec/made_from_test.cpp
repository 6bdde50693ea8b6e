// SPDX-License-Identifier: LGPL-3.0-or-later
// A change may name the generation that it was made from: the difference between a file and the
// running system does. The deployer refuses it when a rollback or another change has come since.
#include <gtest/gtest.h>

#include "support/ramp.h"

namespace mauve {
namespace {

class MadeFrom : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(deployer.deploy());
    Change tried{{ramp::to_core<ramp::Down>("ramp/down", "left")}};
    tried.probation.emplace();
    ASSERT_TRUE(deployer.apply(tried));
    wanted.edits = {ramp::to_core<ramp::Down>("ramp/down", "right")};
    wanted.made_from = deployer.generation(/*before_stops=*/true);
  }
  void roll_back() {
    ASSERT_TRUE(deployer.undo());
    deployer.run_for(50ms);
    Retired retired;
    ASSERT_EQ(deployer.tend(retired).size(), 1U);
  }

  ramp::Two<ramp::Up> architecture;
  Deployer deployer{architecture, {.simulated = true}};
  Change wanted;
};

TEST_F(MadeFrom, WhatARollbackEndedIsRefusedWhenItIsPrepared) {
  EXPECT_TRUE(deployer.prepare(wanted));
  ASSERT_NO_FATAL_FAILURE(roll_back());

  const auto prepared = deployer.prepare(wanted);

  ASSERT_FALSE(prepared);
  EXPECT_EQ(prepared.error().id, "changed_meanwhile");
}

TEST_F(MadeFrom, WhatARollbackEndedIsRefusedWhenItIsPreparedAlready) {
  auto prepared = deployer.prepare(wanted);
  ASSERT_TRUE(prepared) << to_string(prepared.error());
  ASSERT_NO_FATAL_FAILURE(roll_back());
  Retired retired;

  const auto committed = deployer.commit(*prepared, retired);

  ASSERT_FALSE(committed);
  EXPECT_EQ(committed.error().id, "changed_meanwhile");
  EXPECT_NE(deployer.status("right").core, "ramp/down");
}

TEST_F(MadeFrom, WhatWasThereBeforeAStopIsCommitted) {
  ASSERT_TRUE(deployer.stop({"left"}));
  EXPECT_TRUE(deployer.apply(wanted));
}

}  // namespace
}  // namespace mauve
