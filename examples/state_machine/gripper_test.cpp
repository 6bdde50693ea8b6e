// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include "gripping.h"

namespace {

TEST(Gripper, LooksForAPartEach50Milliseconds) {
  Gripping gripping;
  ASSERT_TRUE(gripping.deploy());
  gripping.run(95ms);
  EXPECT_EQ(gripping.status().releases, 2U);  // at 0 ms and 50 ms
  EXPECT_FALSE(gripping.ports().written(gripping.shell().current));
}

TEST(Gripper, ClosesInStepsOf5MillisecondsAndHoldsThePart) {
  Gripping gripping;
  ASSERT_TRUE(gripping.deploy());
  gripping.run(300ms);
  EXPECT_EQ(gripping.core().gripped_parts, 1);
  EXPECT_EQ(gripping.status().fsm_state, "held");
}

TEST(Gripper, OpensAndLooksForTheNextPart) {
  Gripping gripping;
  ASSERT_TRUE(gripping.deploy());
  gripping.run(2s);
  EXPECT_GE(gripping.core().gripped_parts, 4);
  EXPECT_EQ(gripping.status().missed, 0U);
}

}  // namespace
