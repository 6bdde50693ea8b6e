// SPDX-License-Identifier: LGPL-3.0-or-later
/// The preparation of real-time threads before their first release.
#include <gtest/gtest.h>

#include <cerrno>

#include <linux/membarrier.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "exec/run/threads.h"

namespace mauve::exec {
namespace {

/// Asking takes milliseconds, which the first release would come late.
TEST(Threads, HaveAskedTheKernelForItsBarrierBeforeT0IsChosen) {
  if (syscall(SYS_membarrier, MEMBARRIER_CMD_QUERY, 0, 0) < 0) GTEST_SKIP() << "no membarrier here";
  const auto runner = make_threads();

  runner->settle();

  EXPECT_EQ(syscall(SYS_membarrier, MEMBARRIER_CMD_PRIVATE_EXPEDITED, 0, 0), 0) << errno;
}

}  // namespace
}  // namespace mauve::exec
