// SPDX-License-Identifier: LGPL-3.0-or-later
// What the kernel counts of a thread.
#include "thread_counts.h"

#include <gtest/gtest.h>
#include <pthread.h>

#include <atomic>
#include <string>
#include <thread>

#include "support/eventually.h"

namespace mauve::daemon {
namespace {

TEST(ThreadCountsTest, AreReadBehindANameWithBlanksAndParentheses) {
  const auto counts = read_counts("71 (a (b) c) S 1 2 3 4 5 6 700 8 9 10 11\n",
                                  "Name:\ta\nvoluntary_ctxt_switches:\t12\n"
                                  "nonvoluntary_ctxt_switches:\t3\n");

  ASSERT_TRUE(counts);
  EXPECT_EQ(counts->minor_faults, 700U);
  EXPECT_EQ(counts->major_faults, 9U);
  EXPECT_EQ(counts->waits, 12U);
  EXPECT_EQ(counts->preemptions, 3U);
}

TEST(ThreadCountsTest, AreNoneWhereTheFilesSaySomethingElse) {
  const std::string status = "x\nvoluntary_ctxt_switches:\t1\nnonvoluntary_ctxt_switches:\t1\n";
  for (const char* stat : {"", "71", "71 (a)", "71 (a) S 1 2", "71 (a) S 1 2 3 4 5 6 x 8 9 10"}) {
    EXPECT_FALSE(read_counts(stat, status)) << stat;
  }
  EXPECT_FALSE(read_counts("71 (a) S 1 2 3 4 5 6 7 8 9 10", "no counts"));
}

TEST(ThreadCountsTest, AreOfTheThreadOfThisNameUnlessTwoHaveIt) {
  std::atomic<bool> end{false};
  const auto named = [&](const char* name) {
    return std::thread([&end, name] {
      pthread_setname_np(pthread_self(), name);
      while (!end) std::this_thread::yield();
    });
  };
  std::thread one = named("alone");
  std::thread two = named("twice");
  std::thread three = named("twice");

  EXPECT_TRUE(test::eventually([] { return find_counts(thread_counts(), "alone") != nullptr; }));
  EXPECT_TRUE(test::eventually([] { return find_counts(thread_counts(), "twice") == nullptr; }));

  end = true;
  one.join();
  two.join();
  three.join();
}

}  // namespace
}  // namespace mauve::daemon
