// SPDX-License-Identifier: LGPL-3.0-or-later
/// Cores that do not return, on real threads. The bound is wide, so that no healthy job runs into
/// it on a loaded machine.
#include <gtest/gtest.h>

#include <ctime>
#include <thread>

#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "exec/system/system.h"
#include "rt/thread/run_guarded.h"
#include "rt/thread/thread.h"
#include "support/block.h"
#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::await_outcomes;
using test::Block;
using test::block;
using test::eventually;
using test::is_faulted;
using test::runs_on;
constexpr Duration kBound = 500ms;

struct Endless final : ramp::Up {
  volatile bool forever = true;
  void update() override {
    ramp::Up::update();
    while (state->value >= 4 && forever) {
    }
  }
};

/// Blocks in its fourth job, and records the result of the write after it.
struct Blocked final : ramp::Up {
  void update() override {
    ramp::Up::update();
    if (state->value != 4) return;
    block()->wait();
    late_write() = shell().out.write(1234.0) ? 1 : 0;
  }
  /// -1: not done yet.
  static std::atomic<int>& late_write() {
    static std::atomic<int> result{-1};
    return result;
  }
};

/// Sleeps in its fourth job. The signal of the guard ends the sleep, and the job goes on.
struct Sleeping final : ramp::Up {
  void update() override {
    ramp::Up::update();
    if (state->value != 4) return;
    const timespec long_time{60, 0};
    nanosleep(&long_time, nullptr);
  }
};

/// In its fourth job it waits for somebody who takes its processor away.
struct Displaced final : ramp::Up {
  static std::atomic<bool>& waits() {
    static std::atomic<bool> waits{false};
    return waits;
  }
  static std::atomic<bool>& displaced() {
    static std::atomic<bool> displaced{false};
    return displaced;
  }
  void update() override {
    ramp::Up::update();
    if (state->value != 4) return;
    waits() = true;
    while (!displaced()) {
    }
  }
};

/// In its fourth job it makes itself the most urgent thread, and moves, past the C library.
struct Pushing final : ramp::Up {
  void update() override {
    ramp::Up::update();
    if (state->value != 4) return;
    sched_param most{};
    most.sched_priority = 99;
    syscall(SYS_sched_setscheduler, 0, SCHED_FIFO, &most);
    cpu_set_t all{};
    for (const int cpu : rt::usable_cpus()) CPU_SET(cpu, &all);
    syscall(SYS_sched_setaffinity, 0, sizeof all, &all);
  }
};

/// `left` does not return.
template <typename Core>
struct TwoWatched : ramp::FallingBack<Core, ramp::Down> {
  explicit TwoWatched(FaultPolicy::Action action = FaultPolicy::Action::fallback)
      : ramp::FallingBack<Core, ramp::Down>(action) {
    this->left.task().watchdog = kBound;
  }
};

class SinkCore : public Core<EmptyShell> {
 public:
  using Contract = SinkCore;
  static constexpr const char* contract = "sink/core/1";
  virtual void take(const double& value) = 0;
};
/// Does not return when it is given a safe value.
struct EndlessSink final : SinkCore {
  volatile bool forever = true;
  void take(const double& value) override {
    while (value == -1.0 && forever) {
    }
  }
};
/// Waits in the system when it is given a safe value.
struct BlockedSink final : SinkCore {
  void take(const double& value) override {
    if (value == -1.0) block()->wait();
  }
};
struct SinkInterface : Interface<SinkCore> {
  WriteService<double> write{*this, "write", &SinkCore::take};
};
template <typename Sink>
struct WithASink : Architecture {
  Resource<EmptyShell, Sink, SinkInterface> sink{*this, "sink"};
  SharedData<double> position{*this, "position"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> left{*this, "left"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> right{*this, "right"};

  Status on_configure() override {
    left.task().watchdog = kBound;
    if (auto done = left.shell().out.connect(sink.interface().write); !done) return done;
    return right.shell().out.connect(position.write_service());
  }
};

class Guard : public testing::Test {
 protected:
  void SetUp() override {
    block() = &block_;
    Blocked::late_write() = -1;
    ramp::Up::configured_cores() = 0;
  }
  Block block_;
};

TEST_F(Guard, PutsBackThePriorityAndCpusThatACoreChanged) {
  if (!rt::may_use_fifo(99)) GTEST_SKIP() << "NOT TESTED: needs SCHED_FIFO";
  TwoWatched<Pushing> architecture;
  architecture.left.task().cpus = {rt::usable_cpus().front()};
  Deployer deployer(architecture, {.realtime = Realtime::require});
  ASSERT_TRUE(deployer.deploy());

  ASSERT_TRUE(eventually([&] { return deployer.status("left").restored > 0; }));
  EXPECT_TRUE(runs_on(deployer, "left"));
  EXPECT_LE(deployer.status("left").restored, 2u) << "its priority, and perhaps then its CPUs";
}

/// The releases that the job under way has missed count before it returns.
TEST_F(Guard, CountsReleasesThatPassWhileAJobDoesNotReturn) {
  TwoWatched<Blocked> architecture;
  architecture.left.task().watchdog = 1h;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([&] { return block_.entered.load(); }));
  const auto before = deployer.status("left").missed;

  EXPECT_TRUE(eventually([&] { return deployer.status("left").missed > before + 5; }));
  const auto seen = deployer.status("left").missed;

  block_.let_go();
  ASSERT_TRUE(runs_on(deployer, "left"));
  EXPECT_GE(deployer.status("left").missed, seen) << "it counts them too when it comes to them";
}

TEST_F(Guard, DoesNotBlameAJobThatAMoreUrgentThreadKeepsFromItsProcessor) {
  if (!rt::may_use_fifo(90))
    GTEST_SKIP() << "NOT TESTED: nothing is more urgent without SCHED_FIFO";
  constexpr Duration kShort = 100ms;
  const int cpu = rt::usable_cpus().front();
  Displaced::waits() = false;
  Displaced::displaced() = false;
  TwoWatched<Displaced> architecture;
  architecture.left.task().watchdog = kShort;
  architecture.left.task().cpus = {cpu};
  Deployer deployer(architecture, {.realtime = Realtime::require});
  rt::Thread urgent;  // there before the job: who started it then might be late
  ASSERT_TRUE(urgent.start({"urgent", 90, {cpu}}, [&] {
    while (!Displaced::waits()) std::this_thread::sleep_for(1ms);
    const MonotonicClock clock;
    const Instant end = clock.now() + (3 * kShort).count();
    while (clock.now() < end) {
    }
    Displaced::displaced() = true;
  }));
  const Status up = deployer.deploy();
  if (!up) Displaced::waits() = true;
  urgent.join();
  ASSERT_TRUE(up);
  const std::uint64_t before = deployer.status("left").releases;

  EXPECT_TRUE(eventually([&] { return deployer.status("left").releases > before + 2; }));
  EXPECT_TRUE(test::tend(deployer).empty());
  EXPECT_TRUE(runs_on(deployer, "left"));
}

TEST_F(Guard, EndsAnEndlessLoopAndTheFallbackCoreTakesOver) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "under a sanitizer a loop cannot be ended";
  TwoWatched<Endless> architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  const auto outcomes = await_outcomes(deployer);

  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::fell_back);
  EXPECT_EQ(outcomes[0].reason, "its job ran longer than 500 ms");
  EXPECT_TRUE(runs_on(deployer, "left"));
  EXPECT_TRUE(runs_on(deployer, "right"));
  EXPECT_TRUE(deployer.shutdown(test::kPatience).empty())
      << "the same thread goes on: no thread is abandoned";
}

TEST_F(Guard, TakesASleepThatItCutsShortForAHang) {
  TwoWatched<Sleeping> architecture(FaultPolicy::Action::stop);
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  ASSERT_TRUE(is_faulted(deployer, "left"));

  EXPECT_EQ(deployer.status("left").fault, "its job ran longer than 500 ms");
  EXPECT_EQ(ramp::read(architecture.left_position), -1.0) << "the safe value";
  EXPECT_TRUE(runs_on(deployer, "right"));
}

TEST_F(Guard, EndsASafeValueThatIsWrittenWithoutAnEnd) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "the sanitizer handles signals itself";
  WithASink<EndlessSink> architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(runs_on(deployer, "left"));

  const auto stopped = deployer.stop({"left"});

  EXPECT_TRUE(stopped) << to_string(stopped.error());
  EXPECT_EQ(deployer.status("left").state, ComponentState::stopped);
  EXPECT_TRUE(architecture.sink.lock().poisoned());
  EXPECT_TRUE(runs_on(deployer, "right"));
  EXPECT_TRUE(deployer.shutdown(test::kPatience).empty());
}

TEST_F(Guard, GivesUpAThreadThatIsInTheSystemAndAFreshOneGoesOn) {
  TwoWatched<Blocked> architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  const auto outcomes = await_outcomes(deployer);

  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::fell_back);
  EXPECT_EQ(deployer.status("left").core, "ramp/down");
  EXPECT_TRUE(runs_on(deployer, "left"));
  EXPECT_TRUE(runs_on(deployer, "right"));
  EXPECT_GE(deployer.status("left").releases, 4u) << "it counts on";
  EXPECT_EQ(ramp::Up::configured_cores(), 1) << "nobody cleans up what a thread is in";
  EXPECT_LT(ramp::read(architecture.left_position), 1.0) << "no state is moved out of that core";

  block_.let_go();
  EXPECT_TRUE(eventually([] { return Blocked::late_write() != -1; }));
  EXPECT_EQ(Blocked::late_write(), 0) << "what it still writes is dropped";
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(test::tend(deployer));
    return ramp::Up::configured_cores() == 0;
  })) << "its thread was joined, its core cleaned up";
  EXPECT_TRUE(runs_on(deployer, "left"));
  EXPECT_TRUE(deployer.shutdown(test::kPatience).empty());
}

TEST_F(Guard, ParksAComponentWithoutAFallbackCoreAndItStartsAgain) {
  TwoWatched<Blocked> architecture(FaultPolicy::Action::stop);
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  ASSERT_TRUE(is_faulted(deployer, "left"));
  EXPECT_EQ(deployer.status("left").fault, "its job ran longer than 500 ms");
  EXPECT_EQ(ramp::read(architecture.left_position), -1.0) << "the safe value";

  ASSERT_TRUE(deployer.swap_core<ramp::Down>("left"));
  ASSERT_TRUE(deployer.start({"left"}));
  EXPECT_TRUE(runs_on(deployer, "left"));
  block_.let_go();
  EXPECT_TRUE(eventually([] { return Blocked::late_write() == 0; }));
  EXPECT_TRUE(runs_on(deployer, "left"));
}

TEST_F(Guard, AChangeOfAComponentThatHangsEndsWithIt) {
  TwoWatched<Blocked> architecture(FaultPolicy::Action::stop);
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([&] { return block_.entered.load(); }));

  static_cast<void>(deployer.swap_core<ramp::Down>("left"));

  ASSERT_TRUE(is_faulted(deployer, "left"));
  EXPECT_TRUE(eventually([&] { return !deployer.status("left").changing; }));
  if (deployer.status("left").core != "ramp/down") {
    ASSERT_TRUE(
        deployer.swap_core("left", CoreType::of<ramp::Down>("ramp/down")));  // rolled back in time
  }
  ASSERT_TRUE(deployer.start({"left"}));
  EXPECT_TRUE(runs_on(deployer, "left"));
  block_.let_go();
  EXPECT_TRUE(eventually([] { return Blocked::late_write() == 0; }));
}

TEST_F(Guard, ACoreIsNotCleanedUpInPlaceWhileAJobIsStillInIt) {
  TwoWatched<ramp::Down> architecture(FaultPolicy::Action::stop);
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  const auto before = architecture.left.bundle();
  Edit edit;
  edit.member = "left";
  edit.core = CoreType::of<Blocked>("ramp/blocked");
  ASSERT_TRUE(deployer.swap_core_in_place(edit));
  ASSERT_TRUE(is_faulted(deployer, "left"));
  edit.core = CoreType::of<ramp::Down>("ramp/down");
  EXPECT_EQ(deployer.swap_core_in_place(edit).error().id, "component_abandoned");
  auto back = deployer.prepare_back_in_place("left", before, std::nullopt);
  ASSERT_TRUE(back) << to_string(back.error());
  ASSERT_TRUE(deployer.wait(*deployer.begin_in_place_park(*back)));

  const Status exchanged = deployer.in_place_exchange(*back);
  const auto resumed = deployer.begin_in_place_resume(*back, exchanged);

  ASSERT_TRUE(exchanged) << to_string(exchanged.error());
  ASSERT_TRUE(resumed);
  ASSERT_TRUE(deployer.wait(**resumed));
  EXPECT_TRUE(runs_on(deployer, "left")) << "on the core before";
  EXPECT_EQ(architecture.left.bundle()->core, before->core);
  block_.let_go();
  EXPECT_TRUE(eventually([] { return Blocked::late_write() == 0; }));
}

TEST_F(Guard, AShutdownLeavesBehindWhatAThreadIsStillIn) {
  // Never freed: a thread stays in them.
  static auto* const kept = new std::vector<std::pair<TwoWatched<Blocked>*, Block*>>;
  const auto [architecture, forever] = kept->emplace_back(new TwoWatched<Blocked>, new Block);
  block() = forever;
  auto deployer = std::make_unique<Deployer>(*architecture);
  ASSERT_TRUE(deployer->deploy());
  ASSERT_EQ(await_outcomes(*deployer).size(), 1u);

  EXPECT_EQ(deployer->shutdown(), std::vector<std::string>{"left"});
  deployer.reset();
  forever->let_go();
  EXPECT_TRUE(eventually([] { return Blocked::late_write() == 0; }));
}

/// Of all threads of this process.
Duration processor_time() {
  timespec used{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  return std::chrono::seconds(used.tv_sec) + Duration{used.tv_nsec};
}

TEST_F(Guard, SleepsWhileAThreadWritesASafeValueAndMustNotBeAbandoned) {
  WithASink<BlockedSink> architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(runs_on(deployer, "left"));
  const auto stopping = deployer.begin_stop({"left"});
  ASSERT_TRUE(stopping);
  ASSERT_TRUE(eventually([&] { return block_.entered.load(); }));
  const MonotonicClock clock;
  const Instant begin = clock.now();
  const auto passed = [&](Duration time) {
    return eventually([&] { return clock.now() >= begin + time.count(); });
  };

  ASSERT_TRUE(passed(kBound + 100ms));  // from here on it can do nothing about that thread
  const Duration before = processor_time();
  ASSERT_TRUE(passed(kBound + 700ms));

  EXPECT_LT(processor_time() - before, 150ms) << "of 600 ms";
  block_.let_go();
  EXPECT_TRUE(deployer.wait(**stopping));
  EXPECT_TRUE(deployer.shutdown(test::kPatience).empty());
}

}  // namespace
}  // namespace mauve
