// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/thread_role.h"

#include <thread>

#include <gtest/gtest.h>

namespace mauve {
namespace {

void call_from(ThreadRole role, void (*function)()) {
  std::thread([&] {
    begin_thread(role);
    function();
  }).join();
}

void begin_change() { check_thread_role(ThreadRole::control, __func__); }

TEST(ThreadRole, IsThatOfItsThreadAlone) {
  ThreadRole there = ThreadRole::none;
  std::thread([&] {
    begin_thread(ThreadRole::disk);
    there = thread_role();
  }).join();

  EXPECT_EQ(there, ThreadRole::disk);
  EXPECT_EQ(thread_role(), ThreadRole::none);
  EXPECT_EQ(to_string(there), "disk");
}

TEST(ThreadRole, LetsItsOwnThreadAndThreadsWithoutARoleCall) {
  call_from(ThreadRole::control, begin_change);
  begin_change();
}

TEST(ThreadRoleDeathTest, EndsACallFromAnotherThreadWithASentence) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_DEATH(
      call_from(ThreadRole::factory, begin_change),
      "begin_change\\(\\) belongs to thread \\[control\\], but thread \\[factory\\] called");
}

#if defined(MAUVE_CHECK_THREADS)
void commit() { MAUVE_ON_THREAD(control); }

TEST(ThreadRoleDeathTest, IsCheckedByTheMacroInThisBuild) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_DEATH(call_from(ThreadRole::realtime, commit), "commit\\(\\) belongs to thread");
}
#endif

}  // namespace
}  // namespace mauve
