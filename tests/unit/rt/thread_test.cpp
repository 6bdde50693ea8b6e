// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/thread.h"

#include <gtest/gtest.h>

#include "rt/process/process.h"

namespace mauve::rt {
namespace {

TEST(Threads, AreOrdinaryWhenTheyAskForItWhoeverStartsThem) {
  if (!may_use_fifo(2)) GTEST_SKIP() << "SKIPPED: no right to SCHED_FIFO";
  std::optional<ThreadFacts> seen;
  {
    const Boost boost(2);
    Thread thread;
    ASSERT_TRUE(thread.start({"ordinary", 0, {}, 64 * 1024}, [&] {
      if (const auto line = file_text("/proc/thread-self/stat")) seen = thread_facts(*line);
    }));
    thread.join();
  }

  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->policy, "SCHED_OTHER");
  EXPECT_FALSE(seen->urgent());
}

}  // namespace
}  // namespace mauve::rt
