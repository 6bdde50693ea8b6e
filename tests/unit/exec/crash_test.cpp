// SPDX-License-Identifier: LGPL-3.0-or-later
/// Cores that crash, on real threads.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <thread>

#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rt/thread/run_guarded.h"
#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

/// Goes wrong in its fourth job.
struct Wrong : ramp::Up {
  void update() override {
    if (++jobs_ == 4) go_wrong();
    ramp::Up::update();
  }
  virtual void go_wrong() = 0;

 private:
  int jobs_ = 0;
};

struct NullDereference final : Wrong {
  int* volatile nobody = nullptr;
  void go_wrong() override { *nobody = 1; }
};

struct DivisionByZero final : Wrong {
  volatile int zero = 0;
  volatile int quotient = 1;
  void go_wrong() override { quotient = quotient / zero; }
};

volatile bool deeper = true;

int fill_stack(int depth) {
  volatile char frame[256] = {};
  frame[depth % 256] = 1;
  return deeper ? fill_stack(depth + 1) + frame[0] : 0;
}

struct StackOverflow final : Wrong {
  void go_wrong() override { static_cast<void>(fill_stack(0)); }
};

struct CrashInLibc final : Wrong {
  const char* volatile nothing = nullptr;
  volatile std::size_t length = 0;
  void go_wrong() override { length = std::strlen(nothing); }
};

struct SentAbort final : Wrong {
  void go_wrong() override { raise(SIGABRT); }
};

// Calls that end a thread or a process.
struct Aborting final : Wrong {
  void go_wrong() override { std::abort(); }
};
struct Terminating final : Wrong {
  static void throws() { throw 1; }
  static void must_not_throw() noexcept { throws(); }
  void go_wrong() override { must_not_throw(); }
};
struct Asserting final : Wrong {
  void go_wrong() override { __assert_fail("false", __FILE__, __LINE__, "go_wrong"); }
};
struct Exiting final : Wrong {
  void go_wrong() override { std::exit(3); }
};
struct QuickExiting final : Wrong {
  void go_wrong() override { std::quick_exit(0); }
};
struct UnderscoreExiting final : Wrong {
  void go_wrong() override { _exit(0); }
};
struct ThreadExiting final : Wrong {
  void go_wrong() override { pthread_exit(nullptr); }
};
/// Its child leaves; so must not the job of the parent, nor go on in the child.
struct Forking final : Wrong {
  void go_wrong() override {
    const auto child = static_cast<pid_t>(syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0));
    if (child == 0) _exit(7);
    int status = 0;
    waitpid(child, &status, 0);
    if (WEXITSTATUS(status) == 7) throw std::runtime_error("the child has left with 7");
  }
};

class Crash : public testing::Test {
 protected:
  void SetUp() override {
    if (!rt::kGuardsFaults) GTEST_SKIP() << "the sanitizer handles faults itself";
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
    EXPECT_TRUE(test::runs_on(deployer, "right"));
    EXPECT_EQ(deployer.status("left").state, ComponentState::running);
    EXPECT_EQ(deployer.status("left").core, "ramp/down");
  }
};

TEST_F(Crash, ANullPointerIsContainedAndTheFallbackCoreTakesOver) {
  falls_back<NullDereference>("SIGSEGV at address 0x0");
}

TEST_F(Crash, ADivisionByZeroIsContained) {
#if defined(__x86_64__)
  falls_back<DivisionByZero>("SIGFPE at address 0x");
#else
  GTEST_SKIP() << "this processor divides by zero without a fault";
#endif
}

TEST_F(Crash, AFullStackIsContained) { falls_back<StackOverflow>("SIGSEGV at address 0x"); }

TEST_F(Crash, ACallThatWouldEndTheProcessEndsItsJobOnly) {
  falls_back<Aborting>("abort()");
  falls_back<Terminating>("abort()");
  falls_back<Asserting>("assert()");
  falls_back<Exiting>("exit(3)");
  falls_back<QuickExiting>("quick_exit()");
  falls_back<UnderscoreExiting>("_exit()");
  falls_back<ThreadExiting>("pthread_exit()");
}

TEST_F(Crash, AChildOfAJobLeavesAsItAskedFor) { falls_back<Forking>("the child has left with 7"); }

TEST_F(Crash, WithoutAFallbackCoreItsComponentIsParkedAndItsOutputsAreSafe) {
  ramp::FallingBack<NullDereference> architecture(FaultPolicy::Action::stop);
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  ASSERT_TRUE(test::is_faulted(deployer, "left"));

  EXPECT_EQ(deployer.status("left").fault, "SIGSEGV at address 0x0");
  EXPECT_EQ(ramp::read(architecture.left_position), -1.0);
  std::vector<std::string> reported;
  deployer.drain([&](const RuntimeEvent& h) {
    if (h.event == "faulted") reported.push_back(h.component + ": " + h.text);
  });
  EXPECT_EQ(reported,
            std::vector<std::string>{"left: crashed: SIGSEGV at address 0x0, in state update"});
}

// --- a resource that is held
// -----------------------------------------------------------------------

class MeterCore : public Core<EmptyShell> {
 public:
  using Contract = MeterCore;
  static constexpr const char* contract = "meter/core/1";
  virtual void note(const double& value) = 0;
};
struct ThrowingMeter final : MeterCore {
  void note(const double& value) override {
    if (value == 4.0) throw std::runtime_error("out of range");
  }
};
struct FragileMeter final : MeterCore {
  Property<double> breaks_at{*this, "breaks_at", 4.0, "crashes when it is given this value"};
  int* volatile nobody = nullptr;
  void note(const double& value) override {
    if (value == breaks_at) *nobody = 1;
  }
};
struct MeterInterface : Interface<MeterCore> {
  WriteService<double> write{*this, "write", &MeterCore::note};
};

template <typename Left, typename Meter = FragileMeter>
struct Fragile : Architecture {
  Resource<EmptyShell, Meter, MeterInterface> meter{*this, "meter"};
  Component<ramp::Shell, Left, ramp::Fsm> left{*this, "left"};
  Status on_configure() override { return left.shell().out.connect(meter.interface().write); }
};

/// How a new core of `left` on probation ends.
template <typename Core, typename System>
Outcome end_of() {
  System architecture;
  Deployer deployer(architecture);
  EXPECT_TRUE(deployer.deploy());
  Change change{{ramp::to_core<Core>("new", "left")}};
  change.edits[0].state = StatePolicy::drop;
  change.probation.emplace();
  EXPECT_TRUE(deployer.apply(change));
  const auto outcomes = test::await_outcomes(deployer);
  EXPECT_EQ(outcomes.size(), 1u);
  return outcomes.empty() ? Outcome() : outcomes[0];
}

/// A core in quarantine is made nowhere any more, so it must be the one that failed.
TEST_F(Crash, InAResourceTakesTheChangeOfItsUserBackWithoutBlamingTheCoreOfThatUser) {
  const Outcome end = end_of<ramp::Up, Fragile<ramp::Down>>();
  EXPECT_EQ(end.kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(end.component, "left");
  EXPECT_EQ(end.reason, "crashed: SIGSEGV at address 0x0, in a call of meter");
  EXPECT_TRUE(end.cores.empty());
}

TEST(Throw, InAResourceIsNotBlamedOnTheCoreOfItsUser) {
  const Outcome end = end_of<ramp::Up, Fragile<ramp::Down, ThrowingMeter>>();
  EXPECT_EQ(end.kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(end.reason, "threw: out of range, in a call of meter");
  EXPECT_TRUE(end.cores.empty());
}

/// It fills the value of a data resource in place: that is code of the core.
struct BadFiller final : ramp::RampCore {
  Stateless stateless{*this};
  int* volatile nobody = nullptr;
  void update() override {
    shell().out.fill([this](double& value) { value = *nobody; });
  }
};

TEST_F(Crash, InTheCodeOfTheCallerUnderTheLockOfADataResourceIsTheFaultOfThatCore) {
  const Outcome end = end_of<BadFiller, ramp::Two<ramp::Down>>();
  EXPECT_EQ(end.kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(end.reason, "crashed: SIGSEGV at address 0x0");
  EXPECT_EQ(end.cores, std::vector<std::string>{"new"});
}

TEST_F(Crash, InAResourceIsReportedToItsNextUserAndANewCoreClearsIt) {
  Fragile<ramp::Up> architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(test::is_faulted(deployer, "left"));

  EXPECT_TRUE(architecture.meter.lock().poisoned());
  const double value = 1;
  EXPECT_FALSE(architecture.meter.interface().write.write(&value)) << "it may be half written";
  {
    ScopedLock held(architecture.meter.lock());
    EXPECT_EQ(held.refusal(), DataStatus::poisoned);
  }
  ASSERT_TRUE(architecture.meter.lock().try_enter()) << "the lock itself was left";
  architecture.meter.lock().leave();

  const Result<Receipt> healed =
      deployer.set("meter.core.breaks_at", Value(0.0), StatePolicy::drop);
  ASSERT_TRUE(healed) << to_string(healed.error());
  EXPECT_FALSE(architecture.meter.lock().poisoned());
  EXPECT_TRUE(architecture.meter.interface().write.write(&value));
}

// --- what is not contained
// ---------------------------------------------------------------------------

/// Writes on standard error what it is given, as hardware would show it.
struct Shown final : MeterCore {
  void note(const double& value) override {
    if (value != -1.0) return;
    constexpr char kText[] = "the motor is safe\n";
    if (write(STDERR_FILENO, kText, sizeof kText - 1) < 0) return;
  }
};

struct Deadly : Architecture {
  Resource<EmptyShell, Shown, MeterInterface> motor{*this, "motor"};
  SharedData<double> position{*this, "position"};
  Component<ramp::Shell, CrashInLibc, ramp::Fsm> left{*this, "left"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> right{*this, "right"};
  Status on_configure() override {
    if (auto done = left.shell().out.connect(position.write_service()); !done) return done;
    return right.shell().out.connect(motor.interface().write);
  }
};

void die_in_libc() {
  Deadly architecture;
  Deployer deployer(architecture);
  if (!deployer.deploy()) std::exit(2);
  std::this_thread::sleep_for(20s);
  std::exit(3);
}

using CrashDeathTest = Crash;

TEST_F(CrashDeathTest, InTheCLibraryEndsTheProcessWithItsOutputsSafe) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(die_in_libc(), testing::KilledBySignal(SIGSEGV),
              "the motor is safe[^\\0]*mauve: SIGSEGV at address 0x0 in thread left: the safe "
              "values of 2 components are written");
}

/// As glibc does when it finds the heap damaged: it may hold locks.
TEST_F(CrashDeathTest, ByASignalOfTheCLibraryEndsTheProcessWithItsOutputsSafe) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto die = [] {
    ramp::FallingBack<SentAbort> architecture;
    Deployer deployer(architecture);
    if (!deployer.deploy()) std::exit(2);
    std::this_thread::sleep_for(20s);
    std::exit(3);
  };
  EXPECT_EXIT(die(), testing::KilledBySignal(SIGABRT),
              "mauve: SIGABRT in thread left: the safe values of 2 components are written");
}

/// Runs two components with safe values until `end` ends the process.
void run_until(const std::function<void()>& end) {
  ramp::FallingBack<ramp::Up> architecture;
  Deployer deployer(architecture);
  if (!deployer.deploy()) std::_Exit(2);
  end();
  std::this_thread::sleep_for(20s);
  kill(getpid(), SIGKILL);
}

TEST_F(CrashDeathTest, ByASignalThatNobodyHandlesEndsTheProcessWithItsOutputsSafe) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const int signal : {SIGQUIT, SIGUSR1, SIGALRM, SIGXCPU, SIGTERM, SIGPROF}) {
    const auto end = [signal] { kill(getpid(), signal); };
    // A shell may have started this with some of them ignored.
    EXPECT_EXIT((std::signal(signal, SIG_DFL), run_until(end)), testing::KilledBySignal(signal),
                "mauve: SIG[A-Z0-9]+ in thread .*: the safe values of 2 components are written");
  }
}

TEST_F(CrashDeathTest, ByAnExitEndsTheProcessWithItsOutputsSafe) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  constexpr const char* kSafe = "mauve: exit.. in thread .*: the safe values of 2 components";
  EXPECT_EXIT(run_until([] { std::exit(0); }), testing::ExitedWithCode(0), kSafe);
  EXPECT_EXIT(run_until([] { _exit(0); }), testing::ExitedWithCode(0), kSafe);
  EXPECT_EXIT(run_until([] { std::quick_exit(0); }), testing::ExitedWithCode(0), kSafe);
}

/// Forks a child that leaves at once; ends with the code of the child if the components run on.
void leave_by_child() {
  ramp::FallingBack<ramp::Up> architecture;
  Deployer deployer(architecture);
  if (!deployer.deploy()) std::_Exit(2);
  const pid_t child = fork();
  if (child == 0) _exit(7);
  int status = 0;
  waitpid(child, &status, 0);
  const bool runs_on = deployer.status("left").state == ComponentState::running;
  static_cast<void>(deployer.shutdown());
  std::_Exit(runs_on ? WEXITSTATUS(status) : 1);
}

TEST_F(CrashDeathTest, OfAChildIsNoEndOfItsParent) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(leave_by_child(), testing::ExitedWithCode(7), "");
}

/// Its thread has no body that could end, but it has a stack to handle the fault on.
TEST_F(CrashDeathTest, InAThreadOfAPluginWhoseStackIsFullEndsTheProcessWithItsOutputsSafe) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto end = [] {
    const auto hook = [](void*) { std::thread([] { static_cast<void>(fill_stack(0)); }).detach(); };
    static_cast<void>(rt::run_guarded(hook, nullptr, rt::kUnwatched));
  };
  EXPECT_EXIT(run_until(end), testing::KilledBySignal(SIGSEGV),
              "mauve: SIGSEGV at address 0x[0-9a-f]+ in thread .*: the safe values of 2 components "
              "are written");
}

TEST_F(CrashDeathTest, OutsideAJobEndsTheProcessWithItsOutputsSafe) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto die = [] {
    ramp::FallingBack<ramp::Up> architecture;
    Deployer deployer(architecture);
    if (!deployer.deploy()) std::exit(2);
    int* volatile nobody = nullptr;
    *nobody = 1;
    std::exit(3);
  };
  EXPECT_EXIT(die(), testing::KilledBySignal(SIGSEGV), "the safe values of 2 components");
}

}  // namespace
}  // namespace mauve
