// SPDX-License-Identifier: LGPL-3.0-or-later
/// The time after which the guard ends a job.
#include <gtest/gtest.h>

#include "exec/system/make_update.h"
#include "support/ramp.h"

namespace mauve {
namespace {

TEST(BoundOfAJob, IsFiveOfItsBudgetsOrOfItsLongestWaits) {
  ramp::Architecture architecture;
  architecture.control.fsm().period = 30ms;
  ASSERT_TRUE(architecture.configure());
  EXPECT_EQ(exec::bound_of(*architecture.control.bundle()), 150ms);

  architecture.control.task().budget = 20ms;

  EXPECT_EQ(exec::bound_of(*architecture.control.bundle()), 100ms);

  architecture.control.task().budget = 1ms;

  EXPECT_EQ(exec::bound_of(*architecture.control.bundle()), 75ms)
      << "a healthy thread may be held up";
}

}  // namespace
}  // namespace mauve
