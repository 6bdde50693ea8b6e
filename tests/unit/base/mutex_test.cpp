// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/mutex.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <thread>

#include "rt/thread/thread.h"
#include "support/eventually.h"

namespace mauve {
namespace {

/// That of the kernel's list: negative for a thread at SCHED_FIFO.
int priority_of(pid_t thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/stat");
  std::string text;
  std::getline(file, text);
  std::size_t at = text.rfind(')') + 1;
  constexpr int kBetween = 15;  // fields between the name and the priority
  for (int i = 0; i <= kBetween; ++i) at = text.find(' ', at) + 1;
  return std::stoi(text.substr(at));
}

TEST(Mutex, LendsItsHolderThePriorityOfWhoWaitsForIt) {
  if (!rt::may_use_fifo(2)) GTEST_SKIP() << "NOT TESTED: no right to SCHED_FIFO";
  Mutex mutex;
  mutex.lock();
  const pid_t me = gettid();
  EXPECT_GE(priority_of(me), 0);

  std::thread urgent([&] {
    rt::raise_this_thread(2);
    const MutexLock lock(mutex);
  });

  EXPECT_TRUE(test::eventually([&] { return priority_of(me) == -3; }))
      << "SCHED_FIFO 2 is -3 there, and this thread has " << priority_of(me);
  mutex.unlock();
  urgent.join();
  EXPECT_GE(priority_of(me), 0);
}

}  // namespace
}  // namespace mauve
