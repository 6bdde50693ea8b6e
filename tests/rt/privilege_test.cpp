// SPDX-License-Identifier: LGPL-3.0-or-later
/// What the deployer says and does without real-time privileges.
#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rt/thread.h"
#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::eventually;

/// Runs `body` in a child that has given up root and all limits for real time.
template <typename Body>
int without_privileges(Body body) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit none{0, 0};
    setrlimit(RLIMIT_RTPRIO, &none);
    if (geteuid() == 0 && setuid(65534) != 0) _exit(99);
    _exit(body());
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
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
    int told = 0;
    for (const std::string& warning : deployer.warnings()) {
      told += warning.find("SCHED_FIFO") != std::string::npos ? 1 : 0;
    }
    return told == 1 ? 0 : 4;
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
