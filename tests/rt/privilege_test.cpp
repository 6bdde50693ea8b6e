// SPDX-License-Identifier: LGPL-3.0-or-later
/// The deployer without real-time privileges: its messages and its behaviour.
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rt/process/fifo.h"
#include "rt/process/memory.h"
#include "rt/thread/thread.h"
#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::eventually;

/// The result of `body` in a child process.
template <typename Body>
int in_a_child(Body body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Runs `body` in a child that has given up root and all limits for real time.
template <typename Body>
int without_privileges(Body body) {
  return in_a_child([&] {
    const rlimit none{0, 0};
    setrlimit(RLIMIT_RTPRIO, &none);
    if (geteuid() == 0 && setuid(65534) != 0) return 99;
    return body();
  });
}

/// Gives up CAP_SYS_NICE and the limit, but stays the same user.
bool drop_nice() {
  const rlimit none{0, 0};
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct sets[_LINUX_CAPABILITY_U32S_3]{};
  if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || syscall(SYS_capget, &header, sets) != 0) return false;
  sets[CAP_TO_INDEX(CAP_SYS_NICE)].effective &= ~CAP_TO_MASK(CAP_SYS_NICE);
  return syscall(SYS_capset, &header, sets) == 0;
}

/// Becomes a user who is not root, keeps only this capability, and gets a limit of 64 KiB of locked
/// memory.
bool become_user_with(unsigned capability) {
  const rlimit small{65536, 65536};
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct sets[_LINUX_CAPABILITY_U32S_3]{};
  sets[CAP_TO_INDEX(capability)].permitted = CAP_TO_MASK(capability);
  sets[CAP_TO_INDEX(capability)].effective = CAP_TO_MASK(capability);
  return setrlimit(RLIMIT_MEMLOCK, &small) == 0 && prctl(PR_SET_KEEPCAPS, 1) == 0 &&
         setuid(65534) == 0 && syscall(SYS_capset, &header, sets) == 0;
}

bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

TEST(FifoRefusal, NamesTheMissingCapabilityAndItsRemedy) {
  const Error user = rt::fifo_refusal({.priority = 40});
  EXPECT_EQ(user.code, Errc::not_permitted);
  EXPECT_TRUE(has(user.message, "SCHED_FIFO priority 40: CAP_SYS_NICE is missing"));
  EXPECT_TRUE(has(user.hint, "`USER - rtprio 99` in /etc/security/limits.conf"));
  const Error root = rt::fifo_refusal({.priority = 40, .root = true, .group_runtime = 0});
  EXPECT_TRUE(has(root.message, "CAP_SYS_NICE is missing, although the user is root"));
  EXPECT_TRUE(has(root.hint, "CapabilityBoundingSet"));
  EXPECT_FALSE(has(root.message + root.hint, "group"));
}

TEST(FifoRefusal, NamesALimitThatIsTooLow) {
  const Error error = rt::fifo_refusal({.priority = 40, .priority_limit = 39});
  EXPECT_TRUE(has(error.message, "RLIMIT_RTPRIO is 39"));
  EXPECT_TRUE(has(error.hint, "LimitRTPRIO=99"));
}

TEST(FifoRefusal, NamesAControlGroupWithoutRunTimeOnlyWhenAllElseAllows) {
  for (const rt::FifoFacts& facts : {rt::FifoFacts{.priority = 40, .nice_capability = true},
                                     rt::FifoFacts{.priority = 40, .priority_limit = 40}}) {
    rt::FifoFacts in_group = facts;
    in_group.group_runtime = 0;
    EXPECT_TRUE(has(rt::fifo_refusal(in_group).message, "cpu.rt_runtime_us is 0"));
    EXPECT_TRUE(has(rt::fifo_refusal(in_group).hint, "rt_group_sched=0"));
    in_group.group_runtime = 950'000;
    EXPECT_FALSE(has(rt::fifo_refusal(in_group).message, "cpu.rt_runtime_us"));
    EXPECT_TRUE(has(rt::fifo_refusal(facts).hint, "user namespace"));
  }
}

TEST(FifoRefusal, FindsTheGroupOfTheCpuController) {
  EXPECT_EQ(rt::cpu_group("3:cpuset:/a\n2:cpuacct,cpu:/robot/x:y\n0::/b\n"), "/robot/x:y");
  EXPECT_EQ(rt::cpu_group("1:cpu:/"), "");
  EXPECT_EQ(rt::cpu_group("3:cpuset:/a\n2:cpuacct:/b\n0::/\nnonsense\n"), std::nullopt);
  EXPECT_EQ(rt::cpu_group(""), std::nullopt);
}

TEST(Privilege, RootWithoutTheCapabilityIsWarnedOfThatAndNotAboutControlGroups) {
  const int answer = in_a_child([] {
    if (!drop_nice()) return 98;
    const Status refused = rt::may_use_fifo(40);
    if (refused) return 1;
    const Error& error = refused.error();
    if (!has(error.message, "CAP_SYS_NICE is missing")) return 2;
    if (has(error.message, "although the user is root") != (geteuid() == 0)) return 3;
    return has(error.message + error.hint, "control group") ? 4 : 0;
  });
  EXPECT_EQ(answer, 0);
}

TEST(Privilege, OnlyTheCapabilityLocksMoreMemoryThanTheLimit) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become a user with one capability";

  EXPECT_EQ(in_a_child([] {
              if (!become_user_with(CAP_IPC_LOCK)) return 98;
              return rt::lock_memory() ? 0 : 1;
            }),
            0);
  EXPECT_EQ(in_a_child([] {
              if (!become_user_with(CAP_SYS_NICE)) return 98;
              const Status refused = rt::lock_memory();
              return !refused && has(refused.error().message, "RLIMIT_MEMLOCK is 64 KiB") ? 0 : 1;
            }),
            0);
}

TEST(Privilege, RequireRefusesAndSaysHowToGrantIt) {
  const int answer = without_privileges([] {
    ramp::Architecture architecture;
    Deployer deployer(architecture, {.realtime = Realtime::require});
    const Status refused = deployer.deploy();
    if (refused) return 1;
    if (refused.error().code != Errc::not_permitted) return 2;
    return refused.error().hint.find("CAP_SYS_NICE") != std::string::npos ? 0 : 3;
  });
  EXPECT_EQ(answer, 0);
}

TEST(Privilege, PreferRunsAndSaysThatTimingIsNotGuaranteed) {
  const int answer = without_privileges([] {
    ramp::Architecture architecture;
    Deployer deployer(architecture, {.realtime = Realtime::prefer});
    if (!deployer.deploy()) return 1;
    if (deployer.realtime()) return 2;
    if (!eventually([&] { return deployer.status("control").releases > 2; })) return 3;
    int warned = 0;
    for (const std::string& warning : deployer.warnings()) {
      warned += warning.find("SCHED_FIFO") != std::string::npos ? 1 : 0;
    }
    return warned == 1 ? 0 : 4;
  });
  EXPECT_EQ(answer, 0);
}

TEST(Privilege, ThreadsReallyGetThePolicyTheyAskFor) {
  if (!rt::may_use_fifo(20)) GTEST_SKIP() << "no permission for SCHED_FIFO here";
  ramp::Architecture architecture;
  architecture.control.task().priority = 20;
  Deployer deployer(architecture, {.realtime = Realtime::require});

  ASSERT_TRUE(deployer.deploy());

  EXPECT_TRUE(deployer.realtime());
  EXPECT_TRUE(deployer.status("control").realtime);
}

}  // namespace
}  // namespace mauve
