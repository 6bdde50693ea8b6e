// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/commit/late_jobs.h"

#include <gtest/gtest.h>

namespace mauve::exec {
namespace {

TEST(LateJobs, NameTheCause) {
  EXPECT_EQ(reason_of_delay(1998ms, false, 2s),
            "its thread ran for 1998 ms of the last 2000 ms, so the job does not return");
  EXPECT_EQ(reason_of_delay(2ms, true, 2s),
            "its thread ran for 2 ms of the last 2000 ms and sleeps in a call of the job");
  EXPECT_EQ(reason_of_delay(2ms, false, 2s),
            "its thread got a processor for 2 ms of the last 2000 ms, so other threads or the host "
            "delay it, not its core");
}

}  // namespace
}  // namespace mauve::exec
