// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/process/process.h"

#include <gtest/gtest.h>

#include "support/temp_dir.h"

namespace mauve::rt {
namespace {

using test::TempDir;

/// proc(5), with a name that holds what separates the fields.
constexpr const char* kPipewire =
    "812 (pipe) wire (x) S 1 812 812 0 -1 4194304 10 0 0 0 5 6 0 0 -89 0 3 0 777 1000 200 "
    "18446744073709551615 1 1 0 0 0 0 0 4096 16384 0 0 0 -1 3 88 1 0 0 0 0 0 0 0 0 0 0 0";

TEST(ThreadFactsOf, ALineInProcKeepAnyName) {
  const auto thread = thread_facts(kPipewire,
                                   "Name:\tpipe\nvoluntary_ctxt_switches:\t12\n"
                                   "nonvoluntary_ctxt_switches:\t3");

  ASSERT_TRUE(thread);
  EXPECT_EQ(thread->ticks, 11U);
  EXPECT_EQ(thread->minor_faults, 10U);
  EXPECT_EQ(thread->major_faults, 0U);
  EXPECT_EQ(thread->waits, 12U);
  EXPECT_EQ(thread->preemptions, 3U);
  EXPECT_EQ(thread->id, 812);
  EXPECT_EQ(thread->name, "pipe) wire (x");
  EXPECT_EQ(thread->policy, "SCHED_FIFO");
  EXPECT_EQ(thread->priority, 88);
  EXPECT_EQ(thread->cpu, 3);
  EXPECT_FALSE(thread->kernel);
  EXPECT_TRUE(thread->urgent());
}

TEST(ThreadFactsOf, NonsenseAreNothing) {
  EXPECT_FALSE(thread_facts(""));
  EXPECT_FALSE(thread_facts("12 (half) S 1 2 3"));
  EXPECT_FALSE(thread_facts(") 12 ("));
}

TEST(ThreadsOf, ThisProcessAreThere) {
  const auto threads = threads_of("/", "self");

  ASSERT_FALSE(threads.empty());
  EXPECT_FALSE(threads.front().kernel);
  EXPECT_TRUE(threads_of("/nowhere", "self").empty());
}

class OfAProcess : public testing::Test {
 protected:
  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((tree_ / file).parent_path());
    static_cast<void>(tree_.write(file, text));
  }
  void write_process(const std::string& priority, const std::string& memory,
                     const std::string& capabilities) const {
    write("proc/7/limits",
          "Limit                     Soft Limit           Hard Limit  Units\n"
          "Max locked memory         " +
              memory +
              "    unlimited   bytes\n"
              "Max realtime priority     " +
              priority + "    99\n");
    write("proc/7/status", "Name:\tmauved\nUid:\t1000\t0\t0\t0\nVmLck:\t    4096 kB\nCapEff:\t" +
                               capabilities + "\n");
  }

  TempDir tree_;
};

TEST_F(OfAProcess, LimitsAndCapabilitiesAreRead) {
  write_process("90", "8388608", "0000000000804000");

  const auto facts = process_facts(tree_.path(), "7");

  EXPECT_TRUE(facts.root);
  EXPECT_EQ(facts.priority_limit, 90U);
  EXPECT_EQ(facts.lock_limit, 8388608U);
  EXPECT_EQ(facts.locked_kib, 4096U);
  EXPECT_TRUE(facts.nice_capability);
  EXPECT_TRUE(facts.lock_capability);
  EXPECT_FALSE(facts.group_runtime_us);
}

TEST_F(OfAProcess, OnlyPagesInMemoryAreLocked) {
  write_process("90", "8388608", "0000000000804000");
  write("proc/7/smaps_rollup", "00400000-7fff Rollup\nRss:  900 kB\nLocked:   92 kB\n");

  EXPECT_EQ(process_facts(tree_.path(), "7").locked_kib, 92U);
}

TEST_F(OfAProcess, NoLimitIsNone) {
  write_process("unlimited", "unlimited", "0000000000000000");

  const auto facts = process_facts(tree_.path(), "7");

  EXPECT_EQ(facts.priority_limit, 99U);
  EXPECT_FALSE(facts.lock_limit);
  EXPECT_FALSE(facts.nice_capability);
}

TEST_F(OfAProcess, TheRunTimeIsThatOfItsControlGroup) {
  write("proc/7/cgroup", "5:cpuset:/\n4:cpu,cpuacct:/robot\n0::/\n");
  write("sys/fs/cgroup/cpu/robot/cpu.rt_runtime_us", "0\n");

  const auto facts = process_facts(tree_.path(), "7");

  EXPECT_EQ(facts.cpu_group, "/robot");
  EXPECT_EQ(facts.group_runtime_us, 0);
}

TEST_F(OfAProcess, WhatCannotBeReadIsNotGranted) {
  const auto facts = process_facts(tree_.path(), "7");

  EXPECT_EQ(facts.priority_limit, 0U);
  EXPECT_EQ(facts.lock_limit, 0U);
  EXPECT_FALSE(facts.nice_capability);
}

TEST_F(OfAProcess, AFolderIsNoText) {
  std::filesystem::create_directories(tree_ / "proc");

  EXPECT_EQ(file_text(tree_ / "proc").value_or(""), "");
  EXPECT_FALSE(file_text(tree_ / "absent"));
}

}  // namespace
}  // namespace mauve::rt
