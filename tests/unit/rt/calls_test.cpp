// SPDX-License-Identifier: LGPL-3.0-or-later
/// Calls that a job or hook may not make, each row of rt/calls/process_wide.def and those beside.
#include <algorithm>
#include <atomic>
#include <cassert>
#include <cfenv>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <locale>
#include <string>
#include <thread>
#include <vector>

#include <err.h>
#include <error.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <locale.h>
#include <pthread.h>
#include <sched.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <threads.h>
#include <unistd.h>

#include "refused_calls.h"
#include "rt/thread/ends.h"
#include "rt/thread/run_guarded.h"
#include "rt/thread/thread.h"
#include "rt/thread/user_threads.h"

namespace mauve::rt {
namespace {

Fault fault_of(Call call) {
  return run_guarded([](void* of) { (*static_cast<Call*>(of))(); }, &call, kUnwatched);
}

/// The function that ended the body, or "" if none did.
std::string refused(Call call) {
  const Fault fault = fault_of(call);
  return fault.call == nullptr || fault.because == nullptr ? "" : fault.call;
}

/// The same functions in calls that change nothing of the process or of mauve.
const std::map<std::string, Call> kHarmless{
    {"chdir",
     [] {
       use(chdir("."));
       use(chdir("/nowhere"));
     }},
    {"close",
     [] {
       use(close(open("/", O_PATH | O_CLOEXEC)));
       use(close(-1));
     }},
    {"close_range", [] { use(close_range(1000000, ~0U, 0)); }},
    {"dup2",
     [] {
       use(close(dup2(1, 999)));
       use(dup2(1, 1));
     }},
    {"dup3", [] { use(close(dup3(1, 999, O_CLOEXEC))); }},
    {"fclose", [] { use(fclose(fopen("/dev/null", "re"))); }},
    {"signalfd",
     [] {
       sigset_t other;
       sigemptyset(&other);
       sigaddset(&other, SIGUSR2);
       use(close(signalfd(-1, &other, SFD_CLOEXEC)));
     }},
    {"setenv",
     [] {
       use(setenv("PATH", "/nowhere", 0));
       use(unsetenv("MAUVE_NEVER_SET"));
     }},
    {"setlocale",
     [] {
       use(setlocale(LC_ALL, nullptr));
       use(setlocale(LC_ALL, setlocale(LC_ALL, nullptr)));
     }},
    {"sigaction",
     [] {
       struct sigaction now {};
       use(sigaction(SIGTERM, nullptr, &now));
       use(sigaction(SIGTERM, &now, nullptr));
     }},
    {"sigaltstack",
     [] {
       stack_t now{};
       use(sigaltstack(nullptr, &now));
     }},
    {"system", [] { use(system(nullptr)); }},
    {"popen", [] { use(pclose(popen("exit 0", "r"))); }},
    {"posix_spawn",
     [] {
       pid_t child = 0;
       use(posix_spawn(&child, "/nowhere", nullptr, nullptr, environ, environ));
     }},
    {"prlimit",
     [] {
       rlimit now{};
       use(prlimit(0, RLIMIT_CORE, nullptr, &now));
     }},
    {"prctl",
     [] {
       use(prctl(PR_SET_NAME, "harmless"));
       use(prctl(PR_GET_DUMPABLE));
     }},
};

class Calls : public testing::Test {
 protected:
  void SetUp() override {
    if (!kGuardsFaults) GTEST_SKIP() << "the sanitizer has functions of its own";
  }
};

TEST_F(Calls, OfTheWholeProcessEndTheBodyThatMakesThem) {
  for (const auto& [name, call] : kCalls) EXPECT_EQ(refused(call), name);
}

TEST_F(Calls, OfTheTableAreAllTried) {
  // A thread that is not real-time may start programs; Calls.StartAnUrgentProgramFromNoJob.
  const std::vector<std::string> urgent{"popen", "posix_spawn", "posix_spawnp"};
#define MAUVE_CALL(result, name, parameters, arguments, changes, because)     \
  EXPECT_TRUE(kCalls.contains(#name) ||                                       \
              std::find(urgent.begin(), urgent.end(), #name) != urgent.end()) \
      << #name;
#include "rt/calls/process_wide.def"
#undef MAUVE_CALL
}

/// Most of them call exit() within the C library.
TEST_F(Calls, ThatEndTheProcessOrAThreadOtherwiseEndTheBody) {
  const std::map<std::string, Call> ends{
      {"err", [] { err(1, "%s", "no answer"); }},
      {"errx", [] { errx(0, "%s", "no answer"); }},
      {"error", [] { error(1, 0, "%s", "no answer"); }},
      {"assert_perror", [] { __assert_perror_fail(1, __FILE__, __LINE__, __func__); }},
      {"thrd_exit", [] { thrd_exit(0); }},
      {"error_at_line", [] { error_at_line(1, 0, __FILE__, __LINE__, "%s", "no answer"); }},
  };
  const EndHandlers handlers;
  for (const auto& [name, call] : ends) EXPECT_EQ(fault_of(call).call, name);
  EXPECT_FALSE(fault_of([] { error(0, 0, "%s", "a message alone ends nothing"); }).happened());
}

TEST_F(Calls, ThatReportAnErrorDoSoInOtherCode) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(err(3, "no %s", "answer"), testing::ExitedWithCode(3), "no answer: ");
  EXPECT_EXIT(errx(4, "no %s", "answer"), testing::ExitedWithCode(4), "no answer");
  EXPECT_EXIT(error(5, 0, "no %s", "answer"), testing::ExitedWithCode(5), "no answer");
  EXPECT_EXIT(error_at_line(6, 0, "here", 7, "no %s", "answer"), testing::ExitedWithCode(6),
              "here:7: no answer");
}

TEST_F(Calls, ThatChangeNothingAreNotRefused) {
  for (const auto& [name, call] : kHarmless) EXPECT_EQ(refused(call), "") << name;
}

TEST_F(Calls, OfOtherCodeWorkAsEver) {
  const mode_t before = umask(0123);
  EXPECT_EQ(umask(before), 0123U);
  ASSERT_EQ(setenv("MAUVE_FOR_A_TEST", "1", 1), 0);
  EXPECT_STREQ(getenv("MAUVE_FOR_A_TEST"), "1");
  EXPECT_EQ(unsetenv("MAUVE_FOR_A_TEST"), 0);
  EXPECT_EQ(system("exit 3"), 3 << 8);
  EXPECT_EQ(prctl(PR_SET_DUMPABLE, prctl(PR_GET_DUMPABLE), 0, 0, 0), 0);
  EXPECT_EQ(std::set_terminate(std::get_terminate()), std::get_terminate());
  const std::locale now = std::locale::global(std::locale());
  EXPECT_EQ(now, std::locale());

  int status = 0;
  const pid_t child = vfork();
  if (child == 0)
    execle("/bin/sh", "sh", "-c", "exit $X", nullptr,
           std::vector<char*>{const_cast<char*>("X=5"), nullptr}.data());
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 5);
}

TEST_F(Calls, GiveAThreadThatTheBodyStartedAnotherPriority) {
  EXPECT_EQ(refused([] {
              pthread_t thread{};
              const sched_param none{};
              const auto body = [](void* self) { return self; };
              use(pthread_create(&thread, nullptr, body, nullptr));
              use(pthread_setschedparam(thread, SCHED_OTHER, &none));
              use(pthread_join(thread, nullptr));
            }),
            "");
}

TEST_F(Calls, GiveAThreadThatHasEndedAnotherPriority) {
  static std::atomic<bool> runs{false};
  for (int round = 0; round < 5; ++round) {
    EXPECT_EQ(refused([] {
                pthread_t thread{};
                const sched_param none{};
                const auto body = [](void* self) {
                  runs = true;
                  return self;
                };
                runs = false;
                use(pthread_create(&thread, nullptr, body, nullptr));
                while (!runs) std::this_thread::yield();
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
                use(pthread_setschedparam(thread, SCHED_OTHER, &none));
                use(pthread_join(thread, nullptr));
              }),
              "");
  }
}

TEST_F(Calls, StartAnUrgentProgramFromNoJob) {
  if (!may_use_fifo(1)) GTEST_SKIP() << "SKIPPED: no real-time rights";
  std::vector<std::string> answers;
  Thread job;
  ASSERT_TRUE(job.start({"job", 1, {}, 256 * 1024}, [&] {
    answers.push_back(refused([] { use(popen("exit 0", "r")); }));
    answers.push_back(refused([] {
      pid_t child = 0;
      use(posix_spawnp(&child, "/nowhere", nullptr, nullptr, environ, environ));
    }));
    answers.push_back(refused([] {
      pid_t child = 0;
      posix_spawnattr_t ordinary;
      use(posix_spawnattr_init(&ordinary));
      use(posix_spawnattr_setflags(&ordinary, POSIX_SPAWN_SETSCHEDULER));
      use(posix_spawn(&child, "/nowhere", nullptr, &ordinary, environ, environ));
    }));
  }));
  job.join();
  EXPECT_EQ(answers, (std::vector<std::string>{"popen", "posix_spawnp", ""}));
}

TEST_F(Calls, ForTheSignalMaskLeaveTheSignalsOfMauveAndHoldForTheBody) {
  static sigset_t within;
  EXPECT_EQ(refused([] {
              sigset_t all;
              sigfillset(&all);
              use(pthread_sigmask(SIG_SETMASK, &all, nullptr));
              use(sigprocmask(SIG_BLOCK, &all, nullptr));
              use(sigprocmask(SIG_BLOCK, nullptr, &within));
            }),
            "");
  for (const int signal : kSignalsOfBodies) EXPECT_EQ(sigismember(&within, signal), 0) << signal;
  EXPECT_EQ(sigismember(&within, SIGUSR1), 1);

  sigset_t behind;
  pthread_sigmask(SIG_BLOCK, nullptr, &behind);
  EXPECT_EQ(sigismember(&behind, SIGUSR1), 0);
}

TEST_F(Calls, ThatAreRefusedLeaveTheMaskToo) {
  EXPECT_EQ(refused([] {
              sigset_t one;
              sigemptyset(&one);
              sigaddset(&one, SIGUSR1);
              use(pthread_sigmask(SIG_BLOCK, &one, nullptr));
              use(nice(0));
            }),
            "nice");
  sigset_t behind;
  pthread_sigmask(SIG_BLOCK, nullptr, &behind);
  EXPECT_EQ(sigismember(&behind, SIGUSR1), 0);
}

TEST(BodiesOfAThread, LeaveItsLocaleAndItsFloatingPointEnvironmentAsTheyWere) {
  const locale_t before = uselocale(nullptr);
  static locale_t other;
  other = newlocale(LC_ALL_MASK, "C.UTF-8", nullptr);
  ASSERT_NE(other, nullptr);
  std::fesetround(FE_DOWNWARD);
  static int rounding;
  const Fault fault = run_guarded(
      [](void*) {
        rounding = std::fegetround();
        std::fesetround(FE_UPWARD);
        uselocale(other);
      },
      nullptr, kUnwatched);

  EXPECT_FALSE(fault.happened());
  EXPECT_EQ(rounding, FE_TONEAREST);
  EXPECT_EQ(std::fegetround(), FE_DOWNWARD);
  EXPECT_EQ(uselocale(nullptr), before);
  std::fesetround(FE_TONEAREST);
  uselocale(before);
  freelocale(other);
}

}  // namespace
}  // namespace mauve::rt
