// SPDX-License-Identifier: LGPL-3.0-or-later
/// A stop by a user stands against every other way by which a component gets to run: for each way,
/// a stop before it. The clock is moved by hand.
#include <mauve/host/user_stops.h>

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

TEST(UserStopsList, EndsAStopWithAStartThatKnowsIt) {
  UserStops stops;
  stops.stop("arm", {1000, "noon", 0});
  const auto known = stops.newest();
  ASSERT_NE(stops.of("arm"), nullptr);
  EXPECT_EQ(stops.of("arm")->uid, 1000u);
  EXPECT_EQ(stops.of("base"), nullptr);

  stops.stop("arm", {1001, "later", 0});
  stops.start("arm", known);
  ASSERT_NE(stops.of("arm"), nullptr) << "the newer stop came while it was being started";
  EXPECT_EQ(stops.of("arm")->uid, 1001u);
  stops.start("arm", stops.newest());
  EXPECT_EQ(stops.of("arm"), nullptr);
}

TEST(UserStopsList, KeepsAStopOfAllForEachComponentThatNobodyStarted) {
  UserStops stops;
  stops.stop_all({1000, "noon", 0});
  EXPECT_NE(stops.of("joins_later"), nullptr);

  stops.start("arm", stops.newest());
  EXPECT_EQ(stops.of("arm"), nullptr);
  EXPECT_NE(stops.of("joins_later"), nullptr);
  stops.stop("arm", {1000, "again", 0});
  EXPECT_NE(stops.of("arm"), nullptr);

  const auto known = stops.newest();
  stops.stop("base", {1000, "at the same time", 0});
  stops.start_all(known);
  EXPECT_EQ(stops.of("arm"), nullptr);
  EXPECT_EQ(stops.of("joins_later"), nullptr);
  EXPECT_NE(stops.of("base"), nullptr);
  stops.stop_all({1000, "all again", 0});
  EXPECT_NE(stops.of("arm"), nullptr);
}

/// Throws in its tenth job.
struct ThrowsLate : ramp::Up {
  void update() override {
    if (++jobs_ == 10) throw std::runtime_error("sensor lost");
    ramp::Up::update();
  }

 private:
  int jobs_ = 0;
};

/// Whom the user stops: `left` by name, or all.
class UserStopsStand : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override { begin(); }
  void begin(UserStops* kept = nullptr) {
    deployer = std::make_unique<Deployer>(architecture, options(kept));
    ASSERT_TRUE(deployer->deploy());
    deployer->run_for(50ms);
  }
  static DeployOptions options(UserStops* kept) {
    DeployOptions how;
    how.simulated = true;
    how.stops = kept;
    return how;
  }
  static Edit mode(const char* component, Mode mode) {
    Edit edit;
    edit.member = component;
    edit.mode = mode;
    return edit;
  }
  static Edit step(const char* component, double value) {
    Edit edit;
    edit.member = component;
    edit.properties.emplace_back("core.step", Value(value));
    return edit;
  }
  void apply(std::vector<Edit> edits, std::optional<Probation> probation = Probation{}) {
    Change change{std::move(edits)};
    change.probation = probation;
    const auto receipt = deployer->apply(change);
    ASSERT_TRUE(receipt) << to_string(receipt.error());
    deployer->run_for(20ms);
  }
  void stop() {
    const auto stopped = GetParam() ? deployer->stop_all() : deployer->stop({"left"});
    ASSERT_TRUE(stopped) << to_string(stopped.error());
  }
  /// Also after a while, in which mauved looks after the system.
  void stands(const char* when) {
    for (int i = 0; i < 10; ++i) {
      deployer->run_for(20ms);
      static_cast<void>(test::tend(*deployer));
      for (const Change& change : deployer->wanted_standby_cores()) {
        auto prepared = deployer->prepare(change);
        if (prepared) deployer->stand_by(*prepared);
      }
    }
    const auto status = deployer->status("left");
    EXPECT_NE(status.state, ComponentState::running) << when;
    EXPECT_NE(status.state, ComponentState::recovering) << when;
    const auto jobs = status.releases;
    deployer->run_for(50ms);
    EXPECT_EQ(deployer->status("left").releases, jobs) << when;
  }
  void starts_by_hand() {
    const auto started = deployer->start({"left"});
    ASSERT_TRUE(started) << to_string(started.error());
    deployer->run_for(50ms);
    EXPECT_EQ(deployer->status("left").state, ComponentState::running);
  }

  ramp::Two<ramp::Up> architecture;
  std::unique_ptr<Deployer> deployer;
};

INSTANTIATE_TEST_SUITE_P(ByNameAndOfAll, UserStopsStand, testing::Bool());

using Up = ramp::Up;

TEST_P(UserStopsStand, AgainstTheUndoOfAChangeThatParkedIt) {
  apply({mode("left", Mode::park), step("right", 2.0)});
  stop();
  ASSERT_TRUE(deployer->undo());
  stands("after the undo");
  starts_by_hand();
}

TEST_P(UserStopsStand, AgainstTheRollbackWhenTheParkingChangeIsNotConfirmed) {
  Probation waits;
  waits.confirm_within = 100ms;
  apply({mode("left", Mode::park), step("right", 2.0)}, waits);
  stop();
  stands("after the time to confirm");
  EXPECT_FALSE(deployer->on_probation());
}

/// `right` fails after a stop of `left` only.
TEST_P(UserStopsStand, AgainstTheRollbackWhenAnotherComponentOfTheChangeFails) {
  apply({mode("left", Mode::park), ramp::to_core<ThrowsLate>("late", "right")});
  stop();
  stands("after the failure");
  starts_by_hand();
}

TEST_P(UserStopsStand, AgainstTheUndoOfSeveralChangesThatJoined) {
  apply({mode("left", Mode::park), step("right", 2.0)});
  apply({step("left", 3.0)});
  stop();
  apply({step("left", 4.0)});
  ASSERT_TRUE(deployer->undo());
  stands("after the undo of all three");
}

TEST_P(UserStopsStand, AlsoIfTheStopCameWhileTheRollbackWasUnderWay) {
  apply({mode("left", Mode::park), step("right", 2.0)});
  ASSERT_TRUE(deployer->undo());
  stop();
  stands("after the undo");
}

TEST_P(UserStopsStand, AgainstTheUndoOfAChangeThatSwappedItsCore) {
  apply({ramp::to_core<ramp::Down>("ramp/down", "left")});
  stop();
  ASSERT_TRUE(deployer->undo());
  stands("after the undo");
}

TEST_P(UserStopsStand, AgainstAChangeThatStartsItWithoutTheWordOfAUser) {
  stop();
  Change change{{mode("left", Mode::run), step("right", 2.0)}};
  const auto receipt = deployer->apply(change);
  ASSERT_TRUE(receipt) << to_string(receipt.error());
  ASSERT_EQ(receipt->notes.size(), 1u);
  EXPECT_EQ(receipt->notes[0].find("left stays stopped: a user stopped it"), 0u);
  stands("after the change");
  starts_by_hand();
}

/// It was under way already when the stop came.
TEST_P(UserStopsStand, AgainstAStartThatIsUnderWay) {
  ASSERT_TRUE(deployer->stop({"left"}));
  Change change{{mode("left", Mode::run)}};
  change.ends_stops = true;
  auto prepared = deployer->prepare(change);
  ASSERT_TRUE(prepared);
  const auto starting = deployer->begin(*prepared);
  stop();
  ASSERT_TRUE(deployer->wait(*starting));
  stands("after the start");
  starts_by_hand();
}

/// It fails in its third job, and gets a fresh core 30 ms later.
TEST_P(UserStopsStand, AgainstAStandbyCoreWhileTheComponentRecovers) {
  deployer.reset();
  architecture.left.task().on_fault = {.action = FaultPolicy::Action::restart, .back_off = 30ms};
  begin();
  apply({ramp::to_core<ramp::ThrowingInJob>("throwing", "left")}, {});
  for (int i = 0; i < 50; ++i) {
    if (deployer->status("left").state == ComponentState::recovering) break;
    deployer->run_for(5ms);
  }
  ASSERT_EQ(deployer->status("left").state, ComponentState::recovering);
  stop();
  stands("after the back-off");
}

TEST_P(UserStopsStand, OfAComponentThatHasFaulted) {
  apply({ramp::to_core<ramp::ThrowingInJob>("throwing", "left")}, {});
  deployer->run_for(100ms);
  ASSERT_EQ(deployer->status("left").state, ComponentState::faulted);
  stop();
  EXPECT_EQ(deployer->status("left").state, ComponentState::stopped);
  Change change{{ramp::to_core<ramp::Up>("up", "left")}};
  change.edits[0].mode = Mode::run;
  ASSERT_TRUE(deployer->apply(change));
  stands("after another core");
}

TEST_P(UserStopsStand, AgainstTheSecondHalfOfASwapInPlace) {
  auto swap = deployer->prepare_in_place(ramp::to_core<ramp::Down>("ramp/down", "left"));
  ASSERT_TRUE(swap);
  ASSERT_TRUE(deployer->wait(*deployer->begin_in_place_park(*swap)));
  stop();
  const Status exchanged = deployer->in_place_exchange(*swap);
  const auto resumed = deployer->begin_in_place_resume(*swap, exchanged);
  ASSERT_TRUE(resumed);
  ASSERT_TRUE(deployer->wait(**resumed));
  EXPECT_EQ(deployer->status("left").core, "ramp/down");
  stands("after the swap");
  starts_by_hand();
}

TEST_P(UserStopsStand, AgainstTheReturnOfASwapInPlace) {
  const auto before = architecture.left.bundle();
  ASSERT_TRUE(deployer->swap_core_in_place(ramp::to_core<ramp::ThrowingInJob>("throwing", "left")));
  deployer->run_for(200ms);
  ASSERT_EQ(deployer->status("left").state, ComponentState::faulted);
  stop();
  auto back = deployer->prepare_back_in_place("left", before);
  ASSERT_TRUE(back);
  ASSERT_TRUE(deployer->wait(*deployer->begin_in_place_park(*back)));
  const Status exchanged = deployer->in_place_exchange(*back);
  const auto resumed = deployer->begin_in_place_resume(*back, exchanged);
  ASSERT_TRUE(resumed);
  ASSERT_TRUE(deployer->wait(**resumed));
  stands("after the return");
}

TEST_P(UserStopsStand, InADeploymentThatKnowsThem) {
  UserStops kept;
  GetParam() ? kept.stop_all({1000, "before", 0}) : kept.stop("left", {1000, "before", 0});
  begin(&kept);
  stands("after the deployment");
  starts_by_hand();
  EXPECT_EQ(kept.of("left"), nullptr) << "the start has ended it";
  EXPECT_EQ(kept.of("right") != nullptr, GetParam());
  deployer.reset();  // it looks at the list to its end
}

/// A component that the stop did not meet.
class StopOfAll : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(50ms);
  }
  [[nodiscard]] std::uint64_t jobs_of(const char* name) {
    const auto before = deployer.status(name).releases;
    deployer.run_for(50ms);
    return deployer.status(name).releases - before;
  }

  ramp::Two<Up> architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(StopOfAll, StandsAgainstTheReturnOfAComponentThatAChangeRemoved) {
  Change change;
  change.remove = {"left"};
  change.probation = Probation{};
  ASSERT_TRUE(deployer.apply(change));
  deployer.run_for(20ms);

  ASSERT_TRUE(deployer.stop_all());
  ASSERT_TRUE(deployer.undo());
  deployer.run_for(20ms);
  static_cast<void>(test::tend(deployer));

  EXPECT_EQ(deployer.status("left").state, ComponentState::stopped);
  EXPECT_EQ(jobs_of("left"), 0u);
  ASSERT_TRUE(deployer.start({"left"}));
  EXPECT_GT(jobs_of("left"), 0u);
}

class StopOfOne : public StopOfAll {
 protected:
  /// A user stops `left` by a step of this change.
  static Change stops_left(double step) {
    Edit edit;
    edit.member = "right";
    edit.properties.emplace_back("core.step", Value(step));
    Edit park;
    park.member = "left";
    park.mode = Mode::park;
    Change change{{std::move(edit), std::move(park)}};
    change.probation = Probation{};
    change.stops = {"left"};
    return change;
  }
};

TEST_F(StopOfOne, StandsAgainstTheReturnOfAComponentThatAChangeRemoved) {
  Change change;
  change.remove = {"left"};
  change.probation = Probation{};
  ASSERT_TRUE(deployer.apply(change));
  deployer.run_for(20ms);
  EXPECT_EQ(deployer.probations().front().removed, std::vector<std::string>{"left"});
  EXPECT_FALSE(deployer.stop({"nobody"}));

  ASSERT_TRUE(deployer.stop({"left"}));
  ASSERT_TRUE(deployer.undo());
  deployer.run_for(20ms);
  static_cast<void>(test::tend(deployer));

  EXPECT_EQ(deployer.status("left").state, ComponentState::stopped);
  EXPECT_EQ(jobs_of("left"), 0u);
  ASSERT_TRUE(deployer.start({"left"}));
  EXPECT_GT(jobs_of("left"), 0u);
}

TEST_F(StopOfOne, InAChangeStandsAgainstItsUndo) {
  ASSERT_TRUE(deployer.apply(stops_left(2.0)));
  deployer.run_for(20ms);
  ASSERT_TRUE(deployer.undo());
  deployer.run_for(20ms);
  static_cast<void>(test::tend(deployer));
  EXPECT_FALSE(deployer.on_probation());
  EXPECT_EQ(jobs_of("left"), 0u);
  ASSERT_TRUE(deployer.start({"left"}));
  EXPECT_GT(jobs_of("left"), 0u);
}

/// It was prepared from the system before a rollback, and the other component has left since.
TEST_F(StopOfOne, InAChangeThatIsRefusedEndsWithIt) {
  const auto change = stops_left(2.0);
  auto prepared = deployer.prepare(change);
  ASSERT_TRUE(prepared);
  Change removal;
  removal.remove = {"right"};
  ASSERT_TRUE(deployer.apply(removal));
  const auto refused = deployer.wait(*deployer.begin(*prepared));
  EXPECT_FALSE(refused);
  EXPECT_GT(jobs_of("left"), 0u);
  ASSERT_TRUE(deployer.stop({"left"}));
  ASSERT_TRUE(deployer.start({"left"}));
  EXPECT_GT(jobs_of("left"), 0u);
}

TEST_F(StopOfAll, StandsAgainstAComponentThatJoinsLater) {
  ASSERT_TRUE(deployer.stop_all());
  ASSERT_TRUE(deployer.start({"left", "right"}));
  Change change;
  change.new_components.push_back(
      {std::make_shared<ComponentBase>("guest", architecture.left.type(),
                                       architecture.left.bundle()->core_type),
       {}});
  const auto joined = deployer.apply(change);
  ASSERT_TRUE(joined) << to_string(joined.error());

  EXPECT_EQ(deployer.status("guest").state, ComponentState::stopped);
  EXPECT_EQ(joined->notes.size(), 1u);
  EXPECT_EQ(jobs_of("guest"), 0u);
  EXPECT_GT(jobs_of("left"), 0u) << "a user started it since";
  ASSERT_TRUE(deployer.start({"guest"}));
  EXPECT_GT(jobs_of("guest"), 0u);
}

}  // namespace
}  // namespace mauve
