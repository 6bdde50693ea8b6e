// SPDX-License-Identifier: LGPL-3.0-or-later
/// Calls in a job that change the whole process: the folder, the umask, the environment, signals.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "rt/thread/run_guarded.h"
#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

/// Makes the call in its fourth job.
template <typename Call>
struct Changing final : ramp::Up {
  void update() override {
    if (++jobs_ == 4) static_cast<void>(Call()());
    ramp::Up::update();
  }

 private:
  int jobs_ = 0;
};
using ChangingFolder = Changing<decltype([] { return chdir("/"); })>;
using ChangingFolderByNumber = Changing<decltype([] { return fchdir(open("/", O_PATH)); })>;
using ChangingMask = Changing<decltype([] { return umask(0); })>;
using ChangingEnvironment = Changing<decltype([] { return setenv("PATH", "/nowhere", 1); })>;
using ClearingEnvironment = Changing<decltype([] { return unsetenv("PATH"); })>;
using IgnoringTheEnd = Changing<decltype([] { return std::signal(SIGTERM, SIG_IGN); })>;
using HandlingFaults = Changing<decltype([] {
  struct sigaction action {};
  action.sa_handler = [](int) {};
  return sigaction(SIGSEGV, &action, nullptr);
})>;
using UnlockingMemory = Changing<decltype([] { return munlockall(); })>;
using Copying = Changing<decltype([] { return fork(); })>;

/// The same calls, which change nothing.
struct Harmless final : ramp::Down {
  void update() override {
    struct sigaction now {};
    const bool asked = chdir(".") == 0 && setenv("PATH", "/nowhere", 0) == 0 &&
                       setenv("PATH", std::string(getenv("PATH")).c_str(), 1) == 0 &&
                       unsetenv("MAUVE_NEVER_SET") == 0 && sigaction(SIGTERM, nullptr, &now) == 0 &&
                       sigaction(SIGTERM, &now, nullptr) == 0;
    if (!asked) throw std::runtime_error("a call failed");
    ramp::Down::update();
  }
};

class ProcessWide : public testing::Test {
 protected:
  void SetUp() override {
    if (!rt::kGuardsFaults) GTEST_SKIP() << "the sanitizer handles signals itself";
  }

  template <typename Core>
  void falls_back(const std::string& text) {
    ramp::FallingBack<Core> architecture;
    Deployer deployer(architecture);
    ASSERT_TRUE(deployer.deploy());
    const auto outcomes = test::await_outcomes(deployer);
    ASSERT_FALSE(outcomes.empty());
    EXPECT_EQ(outcomes[0].kind, Outcome::Kind::fell_back);
    EXPECT_EQ(outcomes[0].reason.rfind(text, 0), 0u) << outcomes[0].reason;
    EXPECT_TRUE(test::runs_on(deployer, "left"));
  }
};

TEST_F(ProcessWide, ACallThatWouldChangeTheWholeProcessEndsItsJobAndChangesNothing) {
  const std::string path = getenv("PATH");
  const auto folder = std::filesystem::current_path();
  struct sigaction before {};
  sigaction(SIGTERM, nullptr, &before);

  falls_back<ChangingFolder>("chdir(), which changes the whole process");
  falls_back<ChangingFolderByNumber>("fchdir(), ");
  falls_back<ChangingMask>("umask(), ");
  falls_back<ChangingEnvironment>("setenv(), ");
  falls_back<ClearingEnvironment>("unsetenv(), ");
  falls_back<IgnoringTheEnd>("signal(), ");
  falls_back<HandlingFaults>("sigaction(), ");
  falls_back<UnlockingMemory>("munlockall(), ");
  falls_back<Copying>("fork(), ");

  struct sigaction after {};
  sigaction(SIGTERM, nullptr, &after);
  EXPECT_EQ(after.sa_handler, before.sa_handler);
  EXPECT_EQ(getenv("PATH"), path);
  EXPECT_EQ(std::filesystem::current_path(), folder);
}

TEST_F(ProcessWide, ACallThatChangesNothingIsNone) {
  ramp::FallingBack<Harmless> architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  EXPECT_TRUE(test::runs_on(deployer, "left"));
  EXPECT_EQ(deployer.status("left").faults, 0U) << deployer.status("left").fault;
}

}  // namespace
}  // namespace mauve
