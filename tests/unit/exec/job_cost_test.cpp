// SPDX-License-Identifier: LGPL-3.0-or-later
/// The test kit counts what jobs ask of heap and kernel.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <memory>

#include <mauve/plugin.h>
#include <mauve/test_kit.h>

namespace mauve {
namespace {

struct PlainShell : Shell {
  ReadPort<double> target{*this, "target"};
  WritePort<double> command{*this, "command"};
};

struct Plain : Core<PlainShell> {
  virtual void update() { shell().command.write(shell().target.read()); }
};

/// One allocation, its free, and two system calls in each job.
struct Wasteful : Plain {
  void update() override {
    const std::unique_ptr<double> copy(new double(shell().target.read()));
    static_cast<void>(getppid());
    static_cast<void>(getppid());
    shell().command.write(*copy);
  }
};

/// The core, and the cost of its second job.
template <typename Core>
struct Measured {
  Measured() {
    EXPECT_TRUE(bench.configure());
    bench.give(bench.shell().target, 8.0);
    bench.core().update();
    cost = bench.cost([&] { bench.core().update(); });
  }
  CoreBench<PlainShell, Core> bench;
  JobCost cost;
};

constexpr const char* kNotCounted = "SKIPPED: this kernel does not dispatch system calls";

/// On the x86-64 of a kernel that has it. It is asked before the test kit makes use of it, since
/// the question ends that of its thread.
#if defined(__x86_64__)
const bool kDispatches = prctl(PR_SET_SYSCALL_USER_DISPATCH, PR_SYS_DISPATCH_OFF, 0L, 0L, 0L) == 0;
#else
const bool kDispatches = false;
#endif

TEST(JobCost, OfACoreThatKeepsTheRulesIsNothing) {
  const Measured<Plain> plain;

  EXPECT_EQ(plain.cost.heap_calls, 0U);
  EXPECT_EQ(plain.cost.page_faults, 0U);
  if (!kDispatches) GTEST_SKIP() << kNotCounted;
  EXPECT_EQ(plain.cost.system_calls, 0U);
}

TEST(JobCost, CountsHeapCallsAndSystemCalls) {
  Measured<Wasteful> wasteful;

  EXPECT_EQ(wasteful.bench.written(wasteful.bench.shell().command), 8.0) << "it works as ever";
  EXPECT_EQ(wasteful.cost.heap_calls, 2U);
  if (!kDispatches) GTEST_SKIP() << kNotCounted;
  EXPECT_EQ(wasteful.cost.system_calls, 2U);
}

TEST(JobCost, CountsPagesThatAreTouchedForTheFirstTime) {
  constexpr std::size_t kPages = 16;
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* const memory =
      mmap(nullptr, kPages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  ASSERT_EQ(madvise(memory, kPages * page, MADV_NOHUGEPAGE), 0);
  const auto touch = [&] {
    for (std::size_t i = 0; i < kPages; ++i) static_cast<volatile char*>(memory)[i * page] = 1;
  };

  EXPECT_GE(cost_of(touch).page_faults, kPages);
  EXPECT_EQ(cost_of(touch).page_faults, 0U) << "only the first time";
  munmap(memory, kPages * page);
}

TEST(JobCost, GivesResultsAndErrorsOfSystemCallsUnchanged) {
  pid_t parent = 0;
  int closed = 0;
  const JobCost cost = cost_of([&] {
    parent = getppid();
    closed = close(-1);
  });

  EXPECT_EQ(parent, getppid());
  EXPECT_EQ(closed, -1);
  EXPECT_EQ(errno, EBADF);
  if (!kDispatches) GTEST_SKIP() << kNotCounted;
  EXPECT_EQ(cost.system_calls, 2U);
}

TEST(JobCost, OfAComponentIsThatOfItsJobsAlone) {
  ComponentBench<PlainShell, Wasteful, PeriodicFsm<Wasteful>> wasteful;
  ASSERT_TRUE(wasteful.deploy());
  wasteful.run_for(100ms);
  const auto before = wasteful.status().releases;
  wasteful.run_for(100ms);
  const auto jobs = wasteful.status().releases - before;

  EXPECT_GT(jobs, 0U);
  EXPECT_EQ(wasteful.cost().heap_calls, 2 * jobs);

  ComponentBench<PlainShell, Plain, PeriodicFsm<Plain>> plain;
  ASSERT_TRUE(plain.deploy());
  plain.run_for(100ms);
  EXPECT_EQ(plain.cost().heap_calls, 0U);
  if (!kDispatches) GTEST_SKIP() << kNotCounted;
  EXPECT_EQ(wasteful.cost().system_calls, 2 * jobs);
  EXPECT_EQ(plain.cost().system_calls, 0U);
}

}  // namespace
}  // namespace mauve
