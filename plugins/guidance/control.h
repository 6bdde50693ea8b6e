// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "guidance/control": drives the robot to a goal. Shell, contract and state machine
/// of the paper's Listings 1 and 3; a core of this contract decides how.
#pragma once

#include <algorithm>

#include <mauve/plugin.h>

#include "../types/pose.h"
#include "../types/scan.h"
#include "../types/velocity.h"
#include "guidance.h"
#include "obstacles.h"

namespace guidance {

using namespace std::chrono_literals;  // NOLINT: durations of states
using rover::LaserScan;

struct ControlShell : mauve::Shell {
  mauve::ReadPort<Pose2D> pose{*this, "pose", mauve::Need::required};
  mauve::ReadPort<Point2D> goal{*this, "goal", mauve::Need::required};
  mauve::ReadPort<LaserScan> scan{*this, "scan", mauve::Need::required};
  mauve::WritePort<Velocity> command{*this, "command", mauve::Safe{Velocity{}}};
};

/// The contract: the functions that the state machine calls. A core overrides steer().
class GuidanceCore : public mauve::Core<ControlShell> {
 public:
  using Contract = GuidanceCore;
  static constexpr const char* contract = "guidance/core/1";

  mauve::State<Guidance> state{*this};  // survives a change: shared by all guidance cores
  mauve::Property<double> tolerance{
      *this, "tolerance", 0.15, "arrived when this near", {.unit = "m", .min = 0.01, .max = 10.0}};
  mauve::Observable<double> distance_to_goal{*this, "distance_to_goal", 0.0,
                                             "along the straight line", "m"};
  mauve::Observable<int> goals_reached{*this, "goals_reached", 0, "since the start"};

  /// [rt] state wait_goal, every 100 ms: is there a goal, and are we away from it?
  void poll_goal() {
    const Pose2D pose = shell().pose.read();
    const Point2D goal = shell().goal.read();
    const bool known = has_value(shell().pose.status()) && has_value(shell().goal.status());
    // Beyond the tolerance by half: standing at the border must not start the drive again.
    state->has_goal = known && distance(pose, goal) > 1.5 * tolerance ? 1 : 0;
    if (state->has_goal == 0) return;
    state->goal = goal;
    state->side = 0;
    state->avoiding = 0;
    state->dwell = kLongAgo;
  }

  /// [rt] state reach_goal, every 10 ms: one step of the law.
  void advance() {
    const Pose2D pose = shell().pose.read();
    aim_at(shell().goal.read(), *state);
    distance_to_goal = distance(pose, state->goal);
    const mauve::DataStatus seen = shell().scan.look(
        [&](const LaserScan& scan) { nearest_points(scan, pose, kHorizon, obstacles_); });
    // Blind, or lost: stand still. The safety pilot would stop us too.
    const bool sure = usable(seen) && usable(shell().pose.status());
    const double dt = step();
    give(sure ? steer(pose, obstacles_, dt) : Velocity{}, dt);
  }

  /// [rt] state at_goal, then 50 ms: stand, and count.
  void hold() {
    state->has_goal = 0;
    state->command = Velocity{};
    shell().command.write(state->command);
    goals_reached = ++state->goals_reached;
  }

  bool has_goal() const { return state->has_goal == 1; }
  bool arrived() const { return distance_to_goal < tolerance; }

 protected:
  /// The velocity wanted at this pose; `dt` is the time since the last step in seconds. [rt]
  virtual Velocity steer(const Pose2D& pose, const Obstacles& obstacles, double dt) = 0;

  /// The scan as it is, for laws that want more than the nearest points. [rt]
  template <typename F>
  void look_at_scan(F&& f) {
    static_cast<void>(shell().scan.look(f));
  }

 private:
  static constexpr double kHorizon = 3.0;  // m, nothing beyond it changes a decision
  static constexpr double kLongAgo = 1e3;  // s
  static constexpr double kPace = 0.01;    // s, when the last step is long ago

  static bool usable(mauve::DataStatus status) {
    return has_value(status) && status != mauve::DataStatus::stale;
  }

  /// Seconds since the job before, whichever core ran it. A robot that waits for its
  /// goal stands still.
  static double step() {
    const double dt = mauve::to_seconds(mauve::time_step());
    return dt < 0.1 ? dt : kPace;
  }

  void give(const Velocity& wanted, double dt) {
    state->command = slewed(state->command, wanted, SlewLimits{}, dt);
    shell().command.write(state->command);
  }

  Obstacles obstacles_;
};

/// Fig. 2: wait for a goal, reach it, stand there.
struct ControlFsm : mauve::Fsm<GuidanceCore> {
  Exec wait_goal{*this, "wait_goal", &GuidanceCore::poll_goal};
  Exec reach_goal{*this, "reach_goal", &GuidanceCore::advance};
  Exec at_goal{*this, "at_goal", &GuidanceCore::hold};
  Sync idle{*this, "idle", 100ms, "between two looks for a goal"};
  Sync pace{*this, "pace", 10ms, "between two steps of the law"};
  Sync settle{*this, "settle", 50ms, "standing at the goal"};

  mauve::Status on_configure() override {
    start_at(wait_goal);
    wait_goal.when("has_goal", &GuidanceCore::has_goal, reach_goal).then(idle);
    reach_goal.when("arrived", &GuidanceCore::arrived, at_goal).then(pace);
    at_goal.then(settle);
    idle.then(wait_goal);
    pace.then(reach_goal);
    settle.then(wait_goal);
    return mauve::ok();
  }
};

}  // namespace guidance
