// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <unistd.h>

#include "exec/system/make_update.h"
#include "exec/task/task.h"
#include "exec/update/task_update.h"
#include "rt/thread/run_guarded.h"
#include "support/outcomes.h"
#include "support/ramp.h"

#include <mauve/host/ring_buffer.h>

namespace mauve {
namespace {

using TwoThrowing = ramp::Two<ramp::ThrowingInJob>;

TEST(Fault, ThrowingCoreFaultsOnlyItsComponentAndWritesSafeValues) {
  TwoThrowing architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(100ms);

  EXPECT_EQ(deployer.status("left").state, ComponentState::faulted);
  EXPECT_EQ(deployer.status("left").fault, "sensor lost");
  EXPECT_EQ(ramp::read(architecture.left_position), -1.0);
  EXPECT_EQ(deployer.status("right").releases, 10u);
  EXPECT_EQ(ramp::read(architecture.right_position), 10.0);
}

TEST(Fault, IsReportedWithItsText) {
  TwoThrowing architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(100ms);

  std::vector<std::string> reported;
  deployer.drain([&](const RuntimeEvent& h) {
    reported.push_back(h.component + " " + h.event + " " + h.text);
  });

  EXPECT_NE(std::find(reported.begin(), reported.end(),
                      "left faulted threw: sensor lost, in state update"),
            reported.end());
}

TEST(Fault, FaultedComponentStartsAgainWithAnotherCore) {
  TwoThrowing architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(100ms);

  ASSERT_TRUE(deployer.swap_core<ramp::Down>("left"));
  ASSERT_TRUE(deployer.start({"left"}));
  deployer.run_for(50ms);

  EXPECT_EQ(deployer.status("left").state, ComponentState::running);
}

/// A stop is an order of the user, which a saved generation keeps; that of a fault is none.
TEST(Fault, EndsWithTheStopOfItsComponent) {
  TwoThrowing architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(100ms);
  const auto before = deployer.generation();

  const Result<Receipt> stopped = deployer.stop({"left"});

  ASSERT_TRUE(stopped) << to_string(stopped.error());
  EXPECT_EQ(stopped->state, ChangeState::applied);
  EXPECT_EQ(stopped->generation, before + 1);
  EXPECT_EQ(deployer.status("left").state, ComponentState::stopped);
  EXPECT_EQ(deployer.status("left").faults, 1U) << "it is counted all the same";
  EXPECT_EQ(ramp::read(architecture.left_position), -1.0);
  EXPECT_EQ(deployer.status("right").state, ComponentState::running);
  const Result<Receipt> again = deployer.stop({"left"});
  ASSERT_TRUE(again) << to_string(again.error());
  EXPECT_EQ(again->state, ChangeState::unchanged);
  ASSERT_TRUE(deployer.swap_core<ramp::Down>("left"));
  ASSERT_TRUE(deployer.start({"left"}));
  deployer.run_for(50ms);
  EXPECT_EQ(deployer.status("left").state, ComponentState::running);
}

/// Reads what `left` writes and passes it on, like a driver.
struct Pass : ramp::RampCore {
  void update() override { shell().out.write(shell().speed.read()); }
};

TEST(StopAll, LetsReadersActOnSafeValuesBeforeTheyStop) {
  struct Line : Architecture {
    SharedData<double> wanted{*this, "wanted"};
    SharedData<double> hardware{*this, "hardware"};
    Component<ramp::Shell, Pass, ramp::Fsm> driver{*this, "driver"};
    Component<ramp::Shell, ramp::Up, ramp::Fsm> control{*this, "control"};
    Status on_configure() override {
      if (auto done = control.shell().out.connect(wanted.write_service()); !done) return done;
      if (auto done = driver.shell().speed.connect(wanted.read_service()); !done) return done;
      return driver.shell().out.connect(hardware.write_service());
    }
  } line;
  Deployer deployer(line, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(50ms);
  const std::uint64_t before = deployer.status("driver").releases;

  const Result<Receipt> done = deployer.stop_all();

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->components.size(), 2u);
  EXPECT_GT(deployer.status("driver").releases, before) << "it ran after control had stopped";
  EXPECT_EQ(deployer.status("driver").state, ComponentState::stopped);
  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
}

/// A core that tries to change its own component from its job.
struct Meddling : ramp::Up {
  static inline Deployer* deployer = nullptr;
  static inline Status answer = ok();
  void update() override {
    const Result<Receipt> refused = deployer->set("control.core.step", 2.0);
    if (!refused) answer = refused.error();
  }
};

TEST(Fault, DeployerRefusesToBeCalledFromARealTimeJob) {
  struct Alone : Architecture {
    Component<ramp::Shell, Meddling, ramp::Fsm> control{*this, "control"};
  } architecture;
  Deployer deployer(architecture, {.simulated = true});
  Meddling::deployer = &deployer;
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(10ms);

  ASSERT_FALSE(Meddling::answer);
  EXPECT_EQ(Meddling::answer.error().code, Errc::wrong_state);
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
}

struct TakerShell : Shell {
  ReadPort<double> in{*this, "in", 0.0};
};
struct Taker : Core<TakerShell> {
  using Contract = Taker;
  static constexpr const char* contract = "taker/core/1";
  Stateless stateless{*this};
  virtual void update() = 0;
};
struct Content final : Taker {
  void update() override {
    shell().in.look([](const double& /*item*/) {});
  }
};
struct Disgusted final : Taker {
  void update() override {
    shell().in.look([](const double& /*item*/) { throw std::runtime_error("sour"); });
  }
};

struct Queued : Architecture {
  RingBuffer<double> queue{*this, "queue"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> giver{*this, "giver"};
  Component<TakerShell, Content, PeriodicFsm<Taker>> taker{*this, "taker"};
  Status on_configure() override {
    if (Status done = giver.shell().out.connect(queue.write_service()); !done) return done;
    return taker.shell().in.connect(queue.read_service());
  }
};

TEST(Fault, OfALookAtAQueueIsThatOfItsCore) {
  Queued architecture;
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(20ms);
  Change change{{ramp::to_core<Disgusted>("disgusted", "taker")}};
  change.probation.emplace();
  ASSERT_TRUE(deployer.apply(change));

  deployer.run_for(50ms);

  const auto outcomes = test::tend(deployer);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(outcomes[0].reason, "threw: sour");
  EXPECT_EQ(outcomes[0].cores, std::vector<std::string>{"disgusted"});
}

struct MotorShell : Shell {
  ReadPort<double> wanted{*this, "wanted", 0.0};
};
/// Writes on standard error that it got the order to stand, as hardware would show it.
struct Motor final : Core<MotorShell> {
  Stateless stateless{*this};
  void update() {
    if (shell().wanted.read() != -1.0) return;
    constexpr char kText[] = "the motor stands\n";
    if (write(STDERR_FILENO, kText, sizeof kText - 1) < 0) return;
  }
};
struct Motored : Architecture {
  SharedData<double> wanted{*this, "wanted"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> control{*this, "control"};
  Component<MotorShell, Motor, PeriodicFsm<Motor>> motor{*this, "motor"};
  Status on_configure() override {
    if (Status done = control.shell().out.connect(wanted.write_service()); !done) return done;
    return motor.shell().wanted.connect(wanted.read_service());
  }
};

void end_while_it_drives() {
  Motored architecture;
  Deployer deployer(architecture);
  if (!deployer.deploy()) std::_Exit(2);
  if (!deployer.swap_core<ramp::Down>("control")) std::_Exit(2);
  while (deployer.status("motor").releases < 3) std::this_thread::sleep_for(1ms);
  kill(getpid(), SIGTERM);
  std::this_thread::sleep_for(20s);
  std::_Exit(3);
}

TEST(EndOfAProcessDeathTest, LetsDriversActOnSafeValuesThenReportsRuntimeEvents) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "the sanitizer handles signals itself";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT((std::signal(SIGTERM, SIG_DFL), end_while_it_drives()),
              testing::KilledBySignal(SIGTERM),
              "the safe values of 1 components are written.*the motor stands.*"
              "mauve: [0-9.]+ s after T0: control: swapped");
}

/// An update at an instant after the next release is not taken while the failed core waits for
/// another one. When that wait ends, no thread wakes the parked task for it.
TEST(Fault, ThatNoCoreRecoversTakesTheUpdateThatWaitsForItsRelease) {
  constexpr Instant kT0 = 1'000'000'000;
  ramp::Architecture architecture;
  architecture.control.task().on_fault.action = FaultPolicy::Action::restart;
  ASSERT_TRUE(architecture.control.configure());
  ManualClock clock{kT0};
  exec::Task task{"control", clock};
  auto first = exec::first_bundle(architecture.control, Mode::run);
  task.begin(std::move(first), kT0);
  clock.set(task.next_release());
  task.core_failure().fail(exec::Cause::threw, clock.now());
  ASSERT_TRUE(task.run_release());
  exec::Decision decision(clock.now() + Duration(1s).count(), exec::Decision::State::committed);
  auto* const next = exec::first_bundle(architecture.control, Mode::run).release();
  const auto answer = next->answer;
  next->decision = &decision;
  task.mailbox().publish(*next);
  ASSERT_TRUE(task.serve());
  ASSERT_NE(answer->progress.load(), exec::TaskUpdate::Progress::done) << "it runs until then";

  task.core_failure().declare_hopeless(task.core_failure().at());
  ASSERT_TRUE(task.serve());

  EXPECT_EQ(answer->progress.load(), exec::TaskUpdate::Progress::done);
  EXPECT_TRUE(task.running()) << "the update starts it";
}

/// The guard parks the task of an abandoned thread for which it gets no other thread.
TEST(Fault, OfATaskWithoutAThreadIsCountedTracedAndLogged) {
  constexpr Instant kT0 = 1'000'000'000;
  ramp::Architecture architecture;
  ASSERT_TRUE(architecture.control.configure());
  const ManualClock clock{kT0};
  exec::Task task{"control", clock};
  task.begin(exec::first_bundle(architecture.control, Mode::run), kT0);

  task.park_for_good("there is no new thread");

  EXPECT_EQ(task.counters().state.load(), ComponentState::faulted);
  EXPECT_EQ(task.counters().faults.load(), 1U);
  EXPECT_STREQ(task.report().fault().text.data(), "there is no new thread");
  std::vector<std::string> causes;
  task.report().trace().ring.drain(
      [&](const rt::TraceEntry& entry) {
        if (entry.kind == TraceKind::fault) {
          causes.emplace_back(exec::word_of(static_cast<exec::Cause>(entry.name)));
        }
      },
      [](std::uint64_t /*lost*/) {});
  EXPECT_THAT(causes, testing::ElementsAre("hung"));
  rt::Event event;
  ASSERT_TRUE(task.report().events().pop(event));
  EXPECT_EQ(event.kind, rt::EventKind::faulted);
  EXPECT_STREQ(event.text.data(), "there is no new thread");
}

}  // namespace
}  // namespace mauve
