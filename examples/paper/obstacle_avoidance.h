// SPDX-License-Identifier: LGPL-3.0-or-later
/// Listings 1 to 3 of the paper: the shell ObstacleAvoidance, the core PotentialField, and its
/// state machine. The laws are as short as they can be; plugin guidance has the real ones.
#pragma once

#include <algorithm>
#include <cmath>

#include <mauve-plugins/types/pose.h>
#include <mauve-plugins/types/scan.h>
#include <mauve-plugins/types/velocity.h>
#include <mauve/element.h>

namespace paper {

using rover::LaserScan;
using rover::Point2D;
using rover::Pose2D;
using rover::Velocity;

/// Listing 1. A port is a member that knows its shell and its name.
struct ObstacleAvoidanceShell : mauve::Shell {
  mauve::ReadPort<Pose2D> pose{*this, "pose"};
  mauve::ReadPort<Point2D> goal{*this, "goal"};
  mauve::WritePort<Velocity> command{*this, "command", mauve::Safe{Velocity{}}};
  mauve::WritePort<double> distance_to_goal{*this, "distance_to_goal"};
  mauve::ReadPort<LaserScan> scan{*this, "scan"};
};

/// The functions that the state machine calls. The paper names no such class: there, a state
/// machine is bound to one core. Cores that are to replace one another share a contract here.
class AvoidanceCore : public mauve::Core<ObstacleAvoidanceShell> {
 public:
  using Contract = AvoidanceCore;
  static constexpr const char* contract = "paper/avoidance/1";

  // [rt] The execution states.
  void read_input_goal() {
    goal_ = shell().goal.read();
    known_ = has_value(shell().goal.status());
  }
  void reach() {
    const Pose2D pose = shell().pose.read();
    remaining_ = distance(pose, goal_);
    shell().distance_to_goal.write(remaining_);
    shell().command.write(law(pose, goal_));
  }
  void stand() { shell().command.write(Velocity{}); }

  // [rt] The guards.
  bool new_goal() { return known_ && distance(shell().pose.read(), goal_) > kTolerance; }
  bool is_arrived() const { return remaining_ <= kTolerance; }

 protected:
  virtual Velocity law(const Pose2D& pose, const Point2D& goal) = 0;

 private:
  static constexpr double kTolerance = 0.1;  // m

  mauve::Stateless stateless_{*this};
  Point2D goal_;
  bool known_ = false;
  double remaining_ = 0.0;
};

/// Listing 2. A property is a member with a name, a default and, if wanted, a unit and limits.
class PotentialFieldCore final : public AvoidanceCore {
  mauve::Property<double> obstacle_distance{*this, "obstacle_distance", 0.8};
  mauve::Property<double> safety_distance{*this, "safety_distance", 0.8};
  mauve::Property<double> nu{*this, "nu", 0.2};
  mauve::Property<double> psi{*this, "psi", 0.2};

  Velocity law(const Pose2D& pose, const Point2D& goal) override {
    const double pull = std::min(1.0, distance(pose, goal) / (nu + psi));
    return {pull, rover::wrap(bearing(pose, goal) - pose.heading)};
  }
};

/// Another law for the same contract, for Listing 6.
class FiniteTimeAvoidanceCore final : public AvoidanceCore {
  Velocity law(const Pose2D& pose, const Point2D& goal) override {
    return {0.5, 2.0 * rover::wrap(bearing(pose, goal) - pose.heading)};
  }
};

/// Listing 3 and Fig. 2: the clock-based state machine.
struct PotentialFieldFsm : mauve::Fsm<AvoidanceCore> {
  Exec wait_goal{*this, "wait_goal", &AvoidanceCore::read_input_goal};
  Exec reach_goal{*this, "reach_goal", &AvoidanceCore::reach};
  Exec at_goal{*this, "at_goal", &AvoidanceCore::stand};
  Sync sync_wait{*this, "sync_wait", 100ms};
  Sync sync_reach{*this, "sync_reach", 10ms};
  Sync sync_at{*this, "sync_at", 50ms};

  mauve::Status on_configure() override {
    start_at(wait_goal);
    wait_goal.when("new_goal", &AvoidanceCore::new_goal, reach_goal).then(sync_wait);
    sync_wait.then(wait_goal);
    reach_goal.when("is_arrived", &AvoidanceCore::is_arrived, at_goal).then(sync_reach);
    sync_reach.then(reach_goal);
    at_goal.then(sync_at);
    sync_at.then(wait_goal);
    return mauve::ok();
  }
};

}  // namespace paper
