// SPDX-License-Identifier: LGPL-3.0-or-later
#include "navigation.h"

#include <mauve/job.h>

#include <algorithm>

namespace navigation {
namespace {

constexpr int kSteady = 3;             // jobs without a turn or a pause before it looks
constexpr double kFresh = 0.15;        // s, the oldest scan that is looked at
constexpr double kTurning = 0.05;      // rad from job to job: at the horizon half of scan_margin
constexpr double kPause = 0.5;         // s between two jobs, else 0.2: the machine stood still
constexpr double kHorizon = 3.0;       // m, how far the scan is looked at, and the path
constexpr double kMoved = 0.05;        // m, from which on a goal is another one
constexpr double kNearer = 0.1;        // m, that count as getting on
constexpr double kBetweenPlans = 1.0;  // s, at least, for the same goal and map
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool usable(mauve::DataStatus status) {
  return has_value(status) && status != mauve::DataStatus::stale;
}

double seconds(mauve::Duration duration) { return std::chrono::duration<double>(duration).count(); }

double apart(const Point2D& a, const Point2D& b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace

mauve::Status Navigation::on_configure() {
  if (reach < tolerance) return mauve::invalid(reach, "must not be below tolerance");
  planner_ = std::make_unique<Planner>(static_cast<std::size_t>(map_cells));
  map_seen_ = false;
  return mauve::ok();
}

void Navigation::poll_goal() {
  state->has_goal = 0;
  look_at_map();
  if (!planner_->has_map()) answer = static_cast<int>(planner_->why_no_map());
  const Point2D goal = shell().goal.read();
  const bool known = has_value(shell().goal.status()) && read_pose() && planner_->has_map();
  if (!known) return;
  distance_to_goal = distance(pose_, goal);
  // Beyond the tolerance by half: standing at the border must not start the drive again.
  if (distance_to_goal < 1.5 * tolerance) return;
  state->goal = goal;
  state->has_goal = 1;
}

void Navigation::make_plan() {
  static_cast<void>(read_pose());  // was known a moment ago
  planner_->forget(now_);
  const int before = answer;
  answer = static_cast<int>(planner_->plan({pose_.x, pose_.y}, state->goal, state->path));
  if (no_way() && before != answer) {
    mauve::log(mauve::LogLevel::warning, "no way to ({}, {}); core.answer says why", state->goal.x,
               state->goal.y);
  }
  ++plans;
  planned_at_ = now_;
  must_plan_ = false;
  arrived_ = false;
  nearest_ = kInfinity;
  state->next = 0;
  state->from = {pose_.x, pose_.y};
  shell().path.write(state->path);
  if (!no_way()) aim();
}

void Navigation::follow() {
  arrived_ = false;
  must_plan_ = state->path.points.empty();
  if (must_plan_ || !read_pose()) return;
  const Point2D goal = shell().goal.read();
  const bool moved = has_value(shell().goal.status()) && !(apart(goal, state->goal) < kMoved);
  if (moved) state->goal = goal;
  const bool another_map = look_at_map();
  look_at_scan();
  distance_to_goal = distance(pose_, state->goal);
  must_plan_ = moved || another_map;
  if (must_plan_) return;
  const std::int32_t before = state->next;
  advance(*state, pose_, reach, [this](const Point2D& at) {
    return planner_->free({pose_.x, pose_.y}, at);
  });
  if (state->next != before) nearest_ = kInfinity;
  arrived_ = distance_to_goal < tolerance;
  must_plan_ = !arrived_ && now_ - planned_at_ >= kBetweenPlans && way_is_bad();
  aim();
}

void Navigation::stand() {
  state->has_goal = 0;
  way_points = 0;
  shell().target.write({pose_.x, pose_.y});
}

void Navigation::finish() {
  state->has_goal = 0;
  way_points = 0;
  goals_reached = ++state->goals_reached;
}

bool Navigation::read_pose() {
  now_ = mauve::to_seconds(mauve::job_time());
  const Pose2D pose = shell().pose.read();
  if (!usable(shell().pose.status()) || !std::isfinite(pose.x + pose.y + pose.heading))
    return false;
  pose_ = pose;
  return true;
}

/// True when there is another map. One look costs nothing while there is none: the map is not
/// copied.
bool Navigation::look_at_map() {
  bool adopted = false;
  static_cast<void>(shell().map.look([&](const OccupancyGrid& grid) {
    const auto time = std::bit_cast<std::uint64_t>(grid.time);
    if (map_seen_ && time == map_time_) return;
    map_seen_ = adopted = true;
    map_time_ = time;
    if (!planner_->set_map(grid, limits) && planner_->why_no_map() == Answer::too_large) {
      mauve::log(
          mauve::LogLevel::warning, "the map has {} cells, there is room for {}: set map_cells",
          static_cast<std::int64_t>(grid.cells.size()), static_cast<std::int64_t>(map_cells));
    }
  }));
  return adopted;
}

/// Remembers obstacles that are not on the map. A scan is older than the pose, by some jobs on a
/// machine that stands still now and then. So while the robot turns, and just after, the walls of
/// the map would be seen beside their place, and would close a door while they are remembered. The
/// same happens after a pause of the machine during which the robot drove on.
void Navigation::look_at_scan() {
  planner_->forget(now_);
  const double turned = std::abs(rover::wrap(pose_.heading - heading_before_));
  heading_before_ = pose_.heading;
  const bool paused = now_ - looked_at_ > kPause;
  looked_at_ = now_;
  steady_ = turned > kTurning || paused ? 0 : std::min(steady_ + 1, kSteady);
  if (!usable(shell().scan.read(scan_)) || seconds(shell().scan.age()) > kFresh) return;
  if (steady_ < kSteady) return;
  const double until = now_ + seconds(remember);
  for (std::size_t beam = 0; beam < scan_.ranges.size(); ++beam) {
    const double range = static_cast<double>(scan_.ranges[beam]);
    if (!scan_.valid(beam) || range > kHorizon) continue;
    const double angle = pose_.heading + scan_.angle(beam);
    const Point2D at{pose_.x + range * std::cos(angle), pose_.y + range * std::sin(angle)};
    if (planner_->clearance(at) > scan_margin) planner_->block(at, until);
  }
}

bool Navigation::something_on_the_way() const {
  Point2D at{pose_.x, pose_.y};
  double left = kHorizon;
  for (std::size_t i = state->at(); i < state->path.points.size() && left > 0.0; ++i) {
    const Point2D& next = state->path.points[i];
    if (planner_->obstructed(at, next)) return true;
    left -= apart(at, next);
    at = next;
  }
  return false;
}

bool Navigation::gets_on() {
  const double left = distance(pose_, state->path.points[state->at()]);
  if (left < nearest_ - kNearer || nearest_ == kInfinity) {
    nearest_ = left;
    got_on_at_ = now_;
  }
  return now_ - got_on_at_ < seconds(patience);
}

bool Navigation::way_is_bad() {
  if (something_on_the_way()) {
    ++blocked;
    return true;
  }
  if (distance_beside(state->from, state->path.points[state->at()], pose_) > astray) {
    ++strayed;
    return true;
  }
  if (gets_on()) return false;
  ++stuck;
  return true;
}

void Navigation::aim() {
  way_points = static_cast<int>(state->path.points.size() - state->at());
  shell().target.write(state->path.points[state->at()]);
}

}  // namespace navigation
