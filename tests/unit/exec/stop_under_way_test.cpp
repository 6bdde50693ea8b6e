// SPDX-License-Identifier: LGPL-3.0-or-later
/// A stop that is not over, and one that a start had ended which is undone.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>

#include <mauve/host/user_stops.h>

#include "support/eventually.h"
#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

DeployOptions simulated_with(UserStops& stops) {
  DeployOptions how;
  how.simulated = true;
  how.stops = &stops;
  return how;
}

TEST(StopUnderWay, IsNamedUntilItIsOver) {
  UserStops stops;
  ramp::Two<ramp::Up> architecture;
  Deployer deployer{architecture, simulated_with(stops)};
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(20ms);

  auto one = deployer.begin_stop({"left"});
  ASSERT_TRUE(one);
  EXPECT_TRUE(stops.is_under_way("left"));
  EXPECT_FALSE(stops.is_under_way("right"));
  while (!(*one)->advance()) deployer.run_for(10ms);
  one->reset();
  EXPECT_FALSE(stops.is_under_way("left"));

  auto all = deployer.begin_stop_all();
  EXPECT_TRUE(stops.is_under_way("left")) << "it stands already";
  EXPECT_TRUE(stops.is_under_way("right"));
  while (!all->advance()) deployer.run_for(10ms);
  all.reset();
  EXPECT_FALSE(stops.is_under_way("right"));
}

/// Stays in its job while the test says so, as one does that gets no processor.
struct Held : ramp::Up {
  static std::atomic<bool>& hold() {
    static std::atomic<bool> value{false};
    return value;
  }
  static std::atomic<bool>& holding() {
    static std::atomic<bool> value{false};
    return value;
  }
  void update() override {
    while (hold()) {
      holding() = true;
      std::this_thread::sleep_for(1ms);
    }
    ramp::Up::update();
  }
};

/// Shows the value that it reads.
struct Driver : ramp::Up {
  static std::atomic<double>& seen() {
    static std::atomic<double> value{0};
    return value;
  }
  void update() override { seen() = shell().speed.read(); }
};

struct HeldAndDriver : Architecture {
  SharedData<double> command{*this, "command"};
  Component<ramp::Shell, Held, ramp::Fsm> held{*this, "held"};
  Component<ramp::Shell, Driver, ramp::Fsm> driver{*this, "driver"};
  Status on_configure() override {
    held.task().watchdog = 1h;
    if (Status done = held.shell().out.connect(command.write_service()); !done) return done;
    return driver.shell().speed.connect(command.read_service());
  }
};

TEST(StopOfALateComponent, WritesItsSafeValuesBeforeItsJobHasEnded) {
  HeldAndDriver architecture;
  Deployer deployer{architecture, {.realtime = Realtime::off, .admission = Admission::off}};
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(test::eventually([] { return Driver::seen() > 0; }));
  Held::hold() = true;
  ASSERT_TRUE(test::eventually([] { return Held::holding().load(); }));

  const auto stop = deployer.begin_stop({"held"});

  ASSERT_TRUE(stop);
  bool over = false;
  EXPECT_TRUE(test::eventually([&] {
    over = over || (*stop)->advance();
    return Driver::seen() == -1.0;
  }));
  Held::hold() = false;
  EXPECT_TRUE(test::eventually([&] { return over || (*stop)->advance(); }));
  EXPECT_TRUE((*stop)->result()) << "its job has ended in time";
  EXPECT_EQ(deployer.status("held").state, ComponentState::stopped);
}

/// The change of a user that starts what a user had stopped, and gives it another core.
Change start_with_another_core() {
  Edit edit = ramp::to_core<ramp::Down>("down");
  edit.mode = Mode::run;
  Change change{{edit}};
  change.ends_stops = true;
  change.probation.emplace();
  return change;
}

class StartThatIsUndone : public testing::Test {
 protected:
  void SetUp() override {
    deployer_ = std::make_unique<Deployer>(architecture_, simulated_with(stops_));
    ASSERT_TRUE(deployer_->deploy());
    deployer_->run_for(20ms);
    ASSERT_TRUE(deployer_->stop({"control"}));
    ASSERT_NE(stops_.of("control"), nullptr);
    number_ = stops_.of("control")->number;
    ASSERT_TRUE(deployer_->apply(start_with_another_core()));
    ASSERT_EQ(stops_.of("control"), nullptr);
    deployer_->run_for(20ms);
  }
  void undo() {
    ASSERT_TRUE(deployer_->undo("asked for"));
    deployer_->run_for(50ms);
    static_cast<void>(test::tend(*deployer_));
  }

  UserStops stops_;  // outlives the deployer
  ramp::One<ramp::Up> architecture_;
  std::unique_ptr<Deployer> deployer_;
  std::uint64_t number_ = 0;
};

TEST_F(StartThatIsUndone, BringsTheStopOfTheUserBack) {
  undo();

  EXPECT_EQ(deployer_->status("control").state, ComponentState::stopped);
  ASSERT_NE(stops_.of("control"), nullptr);
  EXPECT_EQ(stops_.of("control")->number, number_);
}

TEST_F(StartThatIsUndone, LeavesALaterStop) {
  ASSERT_TRUE(deployer_->stop({"control"}));
  ASSERT_NE(stops_.of("control"), nullptr);
  const auto later = stops_.of("control")->number;

  undo();

  ASSERT_NE(stops_.of("control"), nullptr);
  EXPECT_EQ(stops_.of("control")->number, later);
}

/// Its change starts what a change before it had stopped, which both undo.
TEST(StartThatJoins, BringsNoStopBackAgainstWhatRunsOn) {
  UserStops stops;
  ramp::One<ramp::Up> architecture;
  Deployer deployer{architecture, simulated_with(stops)};
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(20ms);
  Edit stop = ramp::to_core<ramp::Down>("down");
  stop.mode = Mode::park;
  Change first{{stop}};
  first.stops = {"control"};
  first.probation.emplace();
  ASSERT_TRUE(deployer.apply(first));
  deployer.run_for(20ms);
  ASSERT_NE(stops.of("control"), nullptr);
  ASSERT_TRUE(deployer.apply(start_with_another_core()));
  deployer.run_for(20ms);

  ASSERT_TRUE(deployer.undo("asked for"));
  deployer.run_for(50ms);
  static_cast<void>(test::tend(deployer));

  const bool runs = deployer.status("control").state == ComponentState::running;
  EXPECT_NE(runs, stops.of("control") != nullptr) << "a stop stands, or it runs";
}

TEST_F(StartThatIsUndone, BringsNoStopBackOnceItIsConfirmed) {
  ASSERT_TRUE(deployer_->confirm());
  deployer_->run_for(50ms);
  static_cast<void>(test::tend(*deployer_));

  EXPECT_EQ(deployer_->status("control").state, ComponentState::running);
  EXPECT_EQ(stops_.of("control"), nullptr);
}

}  // namespace
}  // namespace mauve
