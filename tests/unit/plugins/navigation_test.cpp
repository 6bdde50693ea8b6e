// SPDX-License-Identifier: LGPL-3.0-or-later
/// The core of navigation/navigation, job by job.
#include "../../../plugins/navigation/navigation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include <mauve/test_kit.h>

#include "../../../plugins/navigation/route.h"

namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using navigation::Answer;
using navigation::Navigation;
using navigation::NavigationShell;
using navigation::OccupancyGrid;
using navigation::Point2D;
using navigation::Pose2D;
using navigation::Route;

/// 20 x 10 m, a wall at x = 10 with a door from y = 7 to 9.
std::unique_ptr<OccupancyGrid> two_rooms() {
  auto grid = std::make_unique<OccupancyGrid>();
  grid->time = 1.0;
  grid->resolution = 0.1;
  grid->width = 200;
  grid->height = 100;
  grid->cells.resize(20'000);
  for (std::size_t y = 0; y < 100; ++y) {
    if (y < 70 || y >= 90) grid->cells[y * 200 + 100] = 100;
  }
  return grid;
}

class NavigationCore : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bench_->configure()); }

  Navigation& core() { return bench_->core(); }
  NavigationShell& shell() { return bench_->shell(); }
  [[nodiscard]] double observe(const char* name) {
    const mauve::Value value = core().find_observable(name)->value();
    if (const auto* integer = value.get_if<std::int64_t>()) return static_cast<double>(*integer);
    return *value.get_if<double>();
  }
  [[nodiscard]] Point2D target() {
    return bench_->written(shell().target).value_or(Point2D{-1.0, -1.0});
  }
  void stand_at(double x, double y, double heading = 0.0) {
    bench_->give(shell().pose, Pose2D{x, y, heading});
  }
  void aim_for(double x, double y) { bench_->give(shell().goal, Point2D{x, y}); }
  /// A plan from (5, 2) to (15, 2), round by the door.
  void set_out() {
    bench_->give(shell().map, *map_);
    stand_at(5.0, 2.0);
    aim_for(15.0, 2.0);
    core().poll_goal();
    ASSERT_TRUE(core().has_goal());
    core().make_plan();
    ASSERT_FALSE(core().no_way());
  }
  /// Until it looks at scans again.
  void stand_still() {
    for (int i = 0; i < 3; ++i) follow_after(100ms);
  }
  void follow_after(mauve::Duration time) {
    bench_->advance(time);
    if (sees_) bench_->give(shell().scan, scan_);
    core().follow();
  }
  /// One beam to the front, from now on.
  void see(double range) {
    scan_.range_max = 8.0F;
    scan_.ranges.clear();
    scan_.ranges.push_back(static_cast<float>(range));
    bench_->give(shell().scan, scan_);
    sees_ = true;
  }
  /// The laser gives no newer scan.
  void see_no_more() { sees_ = false; }

  rover::LaserScan scan_;
  bool sees_ = false;

  std::unique_ptr<OccupancyGrid> map_ = two_rooms();
  std::unique_ptr<mauve::CoreBench<NavigationShell, Navigation>> bench_ =
      std::make_unique<mauve::CoreBench<NavigationShell, Navigation>>();
};

TEST_F(NavigationCore, WaitsForGoalMapAndPose) {
  core().poll_goal();
  EXPECT_FALSE(core().has_goal());
  aim_for(15.0, 2.0);
  stand_at(5.0, 2.0);
  core().poll_goal();
  EXPECT_FALSE(core().has_goal());
  EXPECT_EQ(observe("answer"), static_cast<int>(Answer::no_map));
  bench_->give(shell().map, *map_);
  core().poll_goal();
  EXPECT_TRUE(core().has_goal());
  stand_at(15.2, 2.1);
  core().poll_goal();
  EXPECT_FALSE(core().has_goal()) << "already there";
}

TEST_F(NavigationCore, GivesOneTargetAfterTheOther) {
  set_out();
  const auto path = bench_->written(shell().path);
  ASSERT_TRUE(path.has_value());
  ASSERT_GT(path->points.size(), 2U);

  for (const Point2D& point : path->points) {
    EXPECT_EQ(target().x, point.x);
    EXPECT_EQ(target().y, point.y);
    stand_at(point.x, point.y);
    follow_after(100ms);
  }

  EXPECT_TRUE(core().arrived());
  core().finish();
  EXPECT_EQ(observe("goals_reached"), 1);
  EXPECT_EQ(observe("plans"), 1);
}

TEST_F(NavigationCore, PlansAnewWhenSomethingStandsOnThePath) {
  set_out();
  const Point2D first = target();
  stand_at(5.0, 2.0, std::atan2(first.y - 2.0, first.x - 5.0));
  stand_still();
  see(2.0);

  follow_after(100ms);
  EXPECT_FALSE(core().must_plan()) << "not at once after a plan";
  follow_after(1s);
  ASSERT_TRUE(core().must_plan());
  EXPECT_EQ(observe("blocked"), 1);

  core().make_plan();
  EXPECT_FALSE(core().no_way());
  EXPECT_GT(std::hypot(target().x - first.x, target().y - first.y), 0.1) << "another way";
}

TEST_F(NavigationCore, MarksNothingWhileItTurns) {
  set_out();
  const Point2D first = target();
  const double ahead = std::atan2(first.y - 2.0, first.x - 5.0);
  for (int i = 1; i <= 20; ++i) {
    stand_at(5.0, 2.0, ahead + 0.1 * (i % 2));  // to and fro, the obstacle would be on the path
    see(2.0);
    follow_after(100ms);
    ASSERT_FALSE(core().must_plan()) << "job " << i;
  }

  stand_still();

  EXPECT_TRUE(core().must_plan()) << "it looks again when it stands";
}

TEST_F(NavigationCore, MarksNothingAfterThePauseOfTheMachineUntilItIsSteady) {
  set_out();
  const Point2D first = target();
  stand_at(5.0, 2.0, std::atan2(first.y - 2.0, first.x - 5.0));
  stand_still();
  follow_after(1s);
  see(2.0);  // the robot drove on: the scan shows the place before

  for (int i = 1; i < 3; ++i) {
    follow_after(200ms);
    follow_after(0ms);
    EXPECT_EQ(observe("blocked"), 0) << "job " << i;
    see(8.0);
  }
}

TEST_F(NavigationCore, MarksNothingThatAnOldScanShows) {
  set_out();
  const Point2D first = target();
  stand_at(5.0, 2.0, std::atan2(first.y - 2.0, first.x - 5.0));
  stand_still();
  see(2.0);
  see_no_more();

  follow_after(400ms);
  follow_after(400ms);
  follow_after(400ms);

  EXPECT_FALSE(core().must_plan());
  EXPECT_EQ(observe("blocked"), 0);
}

TEST_F(NavigationCore, IsNotTroubledByWhatIsOnTheMapOrFarAway) {
  set_out();
  see(4.9);
  follow_after(2s);
  EXPECT_FALSE(core().must_plan()) << "the wall";
  see(3.5);
  follow_after(2s);
  EXPECT_FALSE(core().must_plan()) << "too far to decide";
  EXPECT_EQ(observe("blocked"), 0);
}

TEST_F(NavigationCore, ForgetsWhatItHasNotSeenForAWhile) {
  set_out();
  const Point2D first = target();
  stand_at(5.0, 2.0, std::atan2(first.y - 2.0, first.x - 5.0));
  stand_still();
  see(2.0);
  follow_after(100ms);
  follow_after(2s);
  ASSERT_TRUE(core().must_plan());
  see(8.0);

  bench_->advance(20s);
  core().make_plan();

  EXPECT_EQ(target().x, first.x) << "the same way as in the beginning";
  EXPECT_EQ(target().y, first.y);
}

TEST_F(NavigationCore, PlansAnewWhenItHasStrayed) {
  set_out();
  stand_at(5.0, 6.0);

  follow_after(2s);

  EXPECT_TRUE(core().must_plan());
  EXPECT_EQ(observe("strayed"), 1);
}

TEST_F(NavigationCore, PlansAnewWhenItDoesNotGetOn) {
  set_out();
  follow_after(2s);
  follow_after(9s);
  EXPECT_FALSE(core().must_plan());

  follow_after(1s);

  EXPECT_TRUE(core().must_plan());
  EXPECT_EQ(observe("stuck"), 1);
}

TEST_F(NavigationCore, PlansAnewForAnotherGoalOrMap) {
  set_out();
  aim_for(std::nan(""), 8.0);
  follow_after(100ms);
  ASSERT_TRUE(core().must_plan());
  aim_for(3.0, 8.0);
  follow_after(100ms);
  ASSERT_TRUE(core().must_plan());
  core().make_plan();
  EXPECT_EQ(target().x, 3.0);
  EXPECT_EQ(target().y, 8.0);

  bench_->give(shell().map, *map_);
  follow_after(100ms);
  EXPECT_FALSE(core().must_plan()) << "the same map again";
  map_->time = 2.0;
  bench_->give(shell().map, *map_);
  follow_after(100ms);
  EXPECT_TRUE(core().must_plan());
}

TEST_F(NavigationCore, LetsTheRobotStandWhenThereIsNoWay) {
  set_out();
  for (const auto& [goal, answer] :
       {std::pair{Point2D{10.05, 2.0}, Answer::goal_blocked},
        std::pair{Point2D{1e9, 2.0}, Answer::outside},
        std::pair{Point2D{std::nan(""), 2.0}, Answer::outside},
        std::pair{Point2D{2.0, std::numeric_limits<double>::infinity()}, Answer::outside}}) {
    aim_for(goal.x, goal.y);
    core().poll_goal();
    ASSERT_TRUE(core().has_goal());
    core().make_plan();
    ASSERT_TRUE(core().no_way());
    EXPECT_EQ(observe("answer"), static_cast<int>(answer));

    stand_at(5.5, 2.5);
    core().poll_goal();
    core().stand();

    EXPECT_EQ(target().x, 5.5);
    EXPECT_EQ(target().y, 2.5);
    EXPECT_EQ(bench_->written(shell().path)->points.size(), 0U);
  }
  map_->cells.resize(7);
  map_->time = 3.0;
  bench_->give(shell().map, *map_);
  core().poll_goal();
  EXPECT_FALSE(core().has_goal());
  EXPECT_EQ(observe("answer"), static_cast<int>(Answer::no_map));
}

TEST_F(NavigationCore, KeepsItsTargetWhileThePoseIsNone) {
  set_out();
  const Point2D first = target();
  stand_at(std::nan(""), 0.0);

  follow_after(100ms);

  EXPECT_FALSE(core().must_plan());
  EXPECT_EQ(target().x, first.x);
}

TEST(NavigationProperties, AreRefusedWhenItWouldStopBeforeItGoesOn) {
  mauve::CoreBench<NavigationShell, Navigation> bench;
  ASSERT_TRUE(bench.core().find_property("reach")->set(mauve::Value(0.1)));

  EXPECT_FALSE(bench.configure());
}

TEST(Route, DoesNotCutACornerItCannotSeePast) {
  Route route;
  for (const Point2D& point : {Point2D{1, 0}, Point2D{1, 1}, Point2D{2, 1}}) {
    route.path.points.push_back(point);
  }
  const auto blind = [](const Point2D&) { return false; };
  const auto sees = [](const Point2D&) { return true; };

  navigation::advance(route, {0.6, 0.0, 0.0}, 0.5, blind);
  EXPECT_EQ(route.next, 0);
  navigation::advance(route, {0.6, 0.0, 0.0}, 0.5, sees);
  EXPECT_EQ(route.next, 1);
  navigation::advance(route, {1.05, 0.95, 0.0}, 0.5, blind);
  EXPECT_EQ(route.next, 2) << "it stands right before it";
  navigation::advance(route, {2.0, 1.0, 0.0}, 0.5, sees);
  EXPECT_EQ(route.next, 2) << "the last one stays";
}

TEST(Route, KnowsItsWayBesideALineAndPastItsEnd) {
  EXPECT_DOUBLE_EQ(navigation::distance_beside({0, 0}, {4, 0}, {2, 3, 0}), 3.0);
  EXPECT_DOUBLE_EQ(navigation::distance_beside({0, 0}, {4, 0}, {7, 4, 0}), 5.0);
  EXPECT_DOUBLE_EQ(navigation::distance_beside({1, 1}, {1, 1}, {4, 5, 0}), 5.0);
  EXPECT_TRUE(navigation::is_past({0, 0}, {4, 0}, {4.1, 9, 0}));
  EXPECT_FALSE(navigation::is_past({0, 0}, {4, 0}, {3.9, 0, 0}));
}

}  // namespace
