// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "navigation/navigation": from a map and a goal to a path, and along it one target
/// after the other (paper 5.1.1). Its state machine is like that of the guidance: wait for a goal,
/// follow the way, stand at the goal.
///
/// It plans anew when the robot has strayed from the path or does not get on, and for another goal
/// or map. It also does when the scan shows an obstacle on the path that is not on the map. When
/// there is no way the target is where the robot is, so it stands; `answer` has the reason, and it
/// tries again every `fsm.retry`. A plan takes as long as the map is large (README.md): give the
/// component a priority below all components with a short deadline.
#pragma once

#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>

#include <mauve/plugin.h>

#include "../types/grid.h"
#include "../types/pose.h"
#include "../types/scan.h"
#include "planner.h"
#include "route.h"

namespace navigation {

using namespace std::chrono_literals;  // NOLINT: durations of states
using rover::LaserScan;

struct NavigationShell : mauve::Shell {
  mauve::ReadPort<Point2D> goal{*this, "goal", mauve::Need::required};
  mauve::ReadPort<OccupancyGrid> map{*this, "map", mauve::Need::required};
  mauve::ReadPort<Pose2D> pose{*this, "pose", mauve::Need::required};
  mauve::ReadPort<LaserScan> scan{*this, "scan", mauve::Need::required};
  mauve::WritePort<Point2D> target{*this, "target"};
  mauve::WritePort<Path> path{*this, "path"};
};

class Navigation final : public mauve::Core<NavigationShell> {
 public:
  /// [rt] state wait_goal: is there a goal, and are we away from it?
  void poll_goal();
  /// [rt] state plan: a way from here, and its first target.
  void make_plan();
  /// [rt] state follow: how far are we, and is the way still good?
  void follow();
  /// [rt] state stand: no way.
  void stand();
  /// [rt] state at_goal: count.
  void finish();

  bool has_goal() const { return state->has_goal == 1; }
  bool arrived() const { return arrived_; }
  bool must_plan() const { return must_plan_; }
  bool no_way() const { return answer != 0; }

 private:
  mauve::State<Route> state{*this};
  mauve::Parameters<PlannerLimits> limits{*this};
  mauve::Property<double> tolerance{
      *this, "tolerance", 0.25, "arrived when this near", {.unit = "m", .min = 0.01, .max = 10.0}};
  mauve::Property<double> reach{*this,
                                "reach",
                                0.6,
                                "on to the next way point when this near",
                                {.unit = "m", .min = 0.01, .max = 10.0}};
  mauve::Property<double> astray{*this,
                                 "astray",
                                 1.2,
                                 "plans anew when this far from the path",
                                 {.unit = "m", .min = 0.1, .max = 100.0}};
  mauve::Property<double> scan_margin{*this,
                                      "scan_margin",
                                      0.3,
                                      "what is seen this near to what is on the map is just that",
                                      {.unit = "m", .min = 0.0, .max = 10.0}};
  mauve::Property<mauve::Duration> remember{
      *this, "remember", 20s, "what is not on the map", {.min = 0s, .max = 1h}};
  mauve::Property<mauve::Duration> patience{
      *this, "patience", 10s, "plans anew when it does not get on for", {.min = 1s, .max = 1h}};
  mauve::Property<std::int64_t> map_cells{
      *this,
      "map_cells",
      1024 * 1024,
      "room for a map, 23 bytes each",
      {.min = 1, .max = static_cast<std::int64_t>(OccupancyGrid::kCapacity)}};
  mauve::Observable<int> answer{*this, "answer", 0,
                                "of the last plan: 0 a way, 1 no map, 2 outside of it, 3 goal "
                                "blocked, 4 start enclosed, 5 no way, 6 too winding, 7 map larger "
                                "than map_cells"};
  mauve::Observable<int> plans{*this, "plans", 0, "made"};
  mauve::Observable<int> blocked{*this, "blocked", 0, "plans because something was on the path"};
  mauve::Observable<int> strayed{*this, "strayed", 0, "plans because the path was left"};
  mauve::Observable<int> stuck{*this, "stuck", 0, "plans because it did not get on"};
  mauve::Observable<int> way_points{*this, "way_points", 0, "still to come"};
  mauve::Observable<double> distance_to_goal{*this, "distance_to_goal", 0.0,
                                             "along the straight line", "m"};
  mauve::Observable<int> goals_reached{*this, "goals_reached", 0, "since the start"};

  mauve::Status on_configure() override;
  void on_cleanup() override { planner_.reset(); }

  [[nodiscard]] bool read_pose();
  bool look_at_map();
  void look_at_scan();
  [[nodiscard]] bool something_on_the_way() const;
  [[nodiscard]] bool gets_on();
  [[nodiscard]] bool way_is_bad();
  void aim();

  std::unique_ptr<Planner> planner_;
  Pose2D pose_;
  LaserScan scan_;
  int steady_ = 0;               // jobs since it turned, or since the machine stood still
  double looked_at_ = 0.0;       // s, time of the last job that looked at the scan
  double heading_before_ = 0.0;  // rad, of the pose in the job before
  double now_ = 0.0;             // s, start of this job
  std::uint64_t map_time_ = 0;
  bool map_seen_ = false;
  bool must_plan_ = false;
  bool arrived_ = false;
  double planned_at_ = 0.0;
  double got_on_at_ = 0.0;  // s, when the robot last came nearer to its target
  double nearest_ = std::numeric_limits<double>::infinity();
};

struct NavigationFsm : mauve::Fsm<Navigation> {
  Exec wait_goal{*this, "wait_goal", &Navigation::poll_goal};
  Exec plan{*this, "plan", &Navigation::make_plan};
  Exec follow{*this, "follow", &Navigation::follow};
  Exec stand{*this, "stand", &Navigation::stand};
  Exec at_goal{*this, "at_goal", &Navigation::finish};
  Sync idle{*this, "idle", 200ms, "between two looks for a goal"};
  Sync pace{*this, "pace", 200ms, "between two looks at the way"};
  Sync retry{*this, "retry", 1s, "standing, when there is no way"};
  Sync settle{*this, "settle", 200ms, "standing at the goal"};

  mauve::Status on_configure() override {
    start_at(wait_goal);
    wait_goal.when("has_goal", &Navigation::has_goal, plan).then(idle);
    plan.when("no_way", &Navigation::no_way, stand).then(pace);
    follow.when("arrived", &Navigation::arrived, at_goal)
        .when("must_plan", &Navigation::must_plan, plan)
        .then(pace);
    stand.then(retry);
    at_goal.then(settle);
    idle.then(wait_goal);
    pace.then(follow);
    retry.then(wait_goal);
    settle.then(wait_goal);
    return mauve::ok();
  }
};

}  // namespace navigation
