// SPDX-License-Identifier: LGPL-3.0-or-later
/// Stops that go on while [control] is held up: here by a converter at a barrier.
#include <gtest/gtest.h>

#include <sys/syscall.h>
#include <unistd.h>

#include <csignal>
#include <optional>
#include <thread>

#include "support/block.h"
#include "support/eventually.h"
#include "support/ramp.h"
#include "support/store.h"

namespace mauve {
namespace {

using test::eventually;

/// Holds the thread that converts until the test lets it go. Nothing interrupts it.
void hold(const store::Total1& old, store::Total2& now) noexcept {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGURG);
  syscall(SYS_rt_sigprocmask, SIG_BLOCK, &set, nullptr, 8);  // libmauve permits no mask with it
  test::block()->wait();
  store::convert(old, now);
}
struct Holding : store::StoreCore<store::Total2, true> {
  Converts<store::Total1, store::Total2> forth{state, hold};
};

class DirectStops : public testing::Test {
 protected:
  void SetUp() override {
    store::forget_counts();
    test::block() = &blocks;
    architecture.left.fsm().period = 3ms;
    architecture.left.task().watchdog = 1h;  // no guard ends the job that is held
    architecture.right.fsm().period = 1ms;
    ASSERT_TRUE(deployer.deploy());
    ASSERT_TRUE(eventually([] { return store::counts().written > 10; }));
  }
  /// From now on a converter holds the thread that the deployer's calls belong to.
  void hold_control() {
    control = std::thread(
        [this] { done.emplace(deployer.apply(store::change_to(store::make<Holding>("two")))); });
    ASSERT_TRUE(eventually([this] { return blocks.entered.load(); }));
  }
  void let_control_go() {
    blocks.let_go();
    control.join();
  }
  void TearDown() override {
    store::counts().hold = false;
    if (control.joinable()) let_control_go();
  }
  [[nodiscard]] static bool ends(DirectStop& stop) {
    return eventually([&] { return stop.advance(); });
  }
  /// The sum of what was written but for the safe values.
  [[nodiscard]] ComponentState state(const char* name) const { return deployer.status(name).state; }

  test::Block blocks;
  store::Architecture architecture;
  Deployer deployer{architecture, {.realtime = Realtime::off, .admission = Admission::off}};
  std::thread control;
  std::optional<Result<Receipt>> done;
};

TEST_F(DirectStops, ParkWhoWaitsAtABarrierThatDoesNotEnd) {
  ASSERT_NO_FATAL_FAILURE(hold_control());

  const auto stop = deployer.begin_direct_stop({});

  ASSERT_TRUE(stop);
  EXPECT_TRUE(ends(*stop));
  EXPECT_EQ(stop->ran(), (std::vector<std::string>{"left", "right"}));
  EXPECT_TRUE(stop->run_still().empty());
  EXPECT_EQ(store::writes(architecture), static_cast<double>(store::counts().written) + 2)
      << "their safe values are written";
}

TEST_F(DirectStops, CallTheChangeOffThatHeldControlUp) {
  ASSERT_NO_FATAL_FAILURE(hold_control());
  const auto stop = deployer.begin_direct_stop({"right"});
  ASSERT_TRUE(stop);
  ASSERT_TRUE(ends(*stop));

  let_control_go();

  ASSERT_FALSE(*done);
  EXPECT_EQ(done->error().code, Errc::conflict) << to_string(done->error());
  EXPECT_EQ(done->error().at, "right");
  EXPECT_EQ(deployer.generation(), 1u);
  EXPECT_EQ(architecture.find_resource("store"), &architecture.resource);
  EXPECT_EQ(state("right"), ComponentState::stopped);
  const auto releases = deployer.status("left").releases;
  EXPECT_TRUE(eventually([&] { return deployer.status("left").releases > releases + 5; }))
      << "who was not stopped goes on as before";
  EXPECT_EQ(store::counts().wrong, 0);
}

TEST_F(DirectStops, AreOverWhenAnOrdinaryStopHasDoneTheBooks) {
  ASSERT_NO_FATAL_FAILURE(hold_control());
  const auto direct = deployer.begin_direct_stop({});
  ASSERT_TRUE(direct);
  ASSERT_TRUE(ends(*direct));
  let_control_go();

  const Result<Receipt> stopped = deployer.stop_all();

  ASSERT_TRUE(stopped) << to_string(stopped.error());
  EXPECT_EQ(state("left"), ComponentState::stopped);
  ASSERT_TRUE(deployer.start({"left", "right"}));
  const auto releases = deployer.status("left").releases;
  EXPECT_TRUE(eventually([&] { return deployer.status("left").releases > releases + 5; }));
  EXPECT_TRUE(deployer.apply(store::change_to(store::make<store::Second>("two"))));
  EXPECT_EQ(store::counts().wrong, 0);
}

TEST_F(DirectStops, OutlastAStartThatIsUnderWay) {
  ASSERT_TRUE(deployer.stop({"right"}));
  const auto stop = deployer.begin_direct_stop({"right"});
  ASSERT_TRUE(stop);
  EXPECT_TRUE(stop->ran().empty());

  ASSERT_TRUE(deployer.start({"right"}));

  EXPECT_EQ(state("right"), ComponentState::stopped) << "nobody has ended the direct stop";
  deployer.end_direct_stop({"right"});
  ASSERT_TRUE(deployer.start({"right"}));
  EXPECT_EQ(state("right"), ComponentState::running);
}

TEST_F(DirectStops, EndAJobThatDoesNotEnd) {
  store::counts().hold = true;
  ASSERT_TRUE(eventually([] { return store::counts().holding.load(); }));

  const auto stop = deployer.begin_direct_stop({"left"});

  ASSERT_TRUE(stop);
  EXPECT_EQ(stop->run_still(), (std::vector<std::string>{"left"}));
  EXPECT_TRUE(ends(*stop)) << "in bounded time";
  EXPECT_TRUE(eventually([&] { return state("left") != ComponentState::running; }))
      << "although its watchdog allows an hour";
}

TEST_F(DirectStops, OfUnknownComponentsAreNone) {
  EXPECT_EQ(deployer.begin_direct_stop({"left", "nobody"}), nullptr);
  EXPECT_EQ(state("left"), ComponentState::running);
}

TEST_F(DirectStops, WriteSafeValuesIntoWhatAChangeConnectedMeanwhile) {
  const auto stop = deployer.begin_direct_stop({"left", "right"});
  ASSERT_TRUE(stop);
  ASSERT_TRUE(ends(*stop));
  Change change = store::change_to(store::make<store::Lone>("two"));
  change.sync = Sync::cut;

  const Result<Receipt> applied = deployer.apply(change);

  ASSERT_TRUE(applied) << to_string(applied.error());
  EXPECT_GE(store::writes(architecture), 2.0) << "of each, as it took the change";
  EXPECT_EQ(state("left"), ComponentState::stopped);
}

/// Writes -1 when it parks; the other one writes down which values it read before it parks itself.
struct Driver : ramp::Up {
  static std::atomic<double>& seen() {
    static std::atomic<double> value{0};
    return value;
  }
  void update() override { seen() = shell().speed.read(); }
};

TEST_F(DirectStops, OfAllLetADriverActOnTheSafeValuesFirst) {
  struct Chain : Architecture {
    SharedData<double> command{*this, "command"};
    Component<ramp::Shell, ramp::Up, ramp::Fsm> writer{*this, "writer"};
    Component<ramp::Shell, Driver, ramp::Fsm> driver{*this, "driver"};
    Status on_configure() override {
      writer.fsm().period = 2ms;
      driver.fsm().period = 10ms;
      if (Status done = writer.shell().out.connect(command.write_service()); !done) return done;
      return driver.shell().speed.connect(command.read_service());
    }
  } chain;
  Deployer other{chain, {.realtime = Realtime::off, .admission = Admission::off}};
  ASSERT_TRUE(other.deploy());
  ASSERT_TRUE(eventually([] { return Driver::seen() > 1; }));

  const auto stop = other.begin_direct_stop({});

  ASSERT_TRUE(stop);
  EXPECT_TRUE(ends(*stop));
  EXPECT_EQ(Driver::seen(), -1.0);
  EXPECT_EQ(other.status("driver").state, ComponentState::stopped);
}

}  // namespace
}  // namespace mauve
