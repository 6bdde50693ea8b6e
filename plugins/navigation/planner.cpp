// SPDX-License-Identifier: LGPL-3.0-or-later
#include "planner.h"

#include <algorithm>
#include <cmath>

namespace navigation {
namespace {

constexpr int kOccupied = 50;  // a cell from this value on
constexpr std::uint8_t kByMap = 1;
constexpr std::uint8_t kByObstacle = 2;
constexpr std::uint8_t kObstacleHere = 4;

constexpr std::uint32_t kStraight = 12;
constexpr std::uint32_t kDiagonal = 17;

struct Step {
  int dx;
  int dy;
};
/// Straight ones first: a diagonal one asks which of them are open.
constexpr std::array<Step, 8> kSteps{
    {{1, 0}, {0, 1}, {0, -1}, {-1, 0}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

}  // namespace

std::string_view to_string(Answer answer) {
  switch (answer) {
    case Answer::found:
      return "found";
    case Answer::no_map:
      return "no map";
    case Answer::outside:
      return "outside of the map";
    case Answer::goal_blocked:
      return "goal too near to something";
    case Answer::enclosed:
      return "start too near to something";
    case Answer::no_way:
      return "no way";
    case Answer::too_winding:
      return "too many way points";
    case Answer::too_large:
      return "the map has more cells than map_cells";
  }
  return "unknown";
}

Planner::Planner(std::size_t cells)
    : distances_(cells), blocked_(cells), nodes_(cells), route_(cells) {}

bool Planner::set_map(const OccupancyGrid& grid, const PlannerLimits& limits) {
  has_map_ = false;
  why_no_map_ = Answer::no_map;
  obstacle_count_ = 0;
  const auto frame = Frame::of(grid);
  if (frame && frame->size() > distances_.room()) {
    why_no_map_ = Answer::too_large;
    return false;
  }
  if (!frame || !(limits.keep_away >= 0.0)) return false;
  const double radius = limits.keep_away / frame->resolution();
  if (radius > kWidestRadius) return false;
  frame_ = *frame;
  limits_ = limits;
  radius_ = static_cast<int>(radius);
  radius_squared_ = radius * radius;
  const bool through = limits.through_unknown;
  distances_.measure(frame_, !through, [&](std::size_t i) {
    return grid.cells[i] >= kOccupied || (grid.cells[i] < 0 && !through);
  });
  for (std::size_t i = 0; i < frame_.size(); ++i) {
    const std::uint16_t squared = distances_.squared(i);
    blocked_[i] = squared == 0 || squared < radius_squared_ ? kByMap : std::uint8_t{0};
  }
  for (std::size_t i = 0; i < kSteps.size(); ++i) {
    offsets_[i] = kSteps[i].dy * frame_.width() + kSteps[i].dx;
  }
  return has_map_ = true;
}

Answer Planner::plan(const Point2D& start, const Point2D& goal, Path& path) {
  path.points.clear();
  if (!has_map_) return why_no_map_;
  Point2D from = frame_.cells(start);
  const Point2D to = frame_.cells(goal);
  if (!frame_.inside(from) || !frame_.inside(to)) return Answer::outside;
  auto begin = static_cast<std::uint32_t>(frame_.index(from));
  const auto end = static_cast<std::uint32_t>(frame_.index(to));
  if (!is_free(end)) return Answer::goal_blocked;
  const Answer left = leave(from, begin, path);
  if (left != Answer::found) return left;
  const auto passable = [this](std::size_t cell) { return is_free(cell); };
  const int goal_x = static_cast<int>(to.x);
  const int goal_y = static_cast<int>(to.y);
  const auto estimate = [goal_x, goal_y](int x, int y) {
    const auto dx = static_cast<std::uint32_t>(std::abs(goal_x - x));
    const auto dy = static_cast<std::uint32_t>(std::abs(goal_y - y));
    return kStraight * (std::max(dx, dy) - std::min(dx, dy)) + kDiagonal * std::min(dx, dy);
  };
  const auto done = [end](std::uint32_t cell) { return cell == end; };
  if (search(begin, passable, done, estimate) == kNone) {
    path.points.clear();
    return Answer::no_way;
  }
  trace_back(begin, end);
  if (append(from, to, passable, path)) return Answer::found;
  path.points.clear();
  return Answer::too_winding;
}

/// Leads away from obstacles that are too near, by the shortest way that touches nothing; `from`
/// and `start` are its end.
Answer Planner::leave(Point2D& from, std::uint32_t& start, Path& path) {
  if (is_free(start)) return Answer::found;
  const auto passable = [this](std::size_t cell) { return !solid(cell); };
  const auto done = [this](std::uint32_t cell) { return is_free(cell); };
  const std::uint32_t out =
      solid(start) ? kNone : search(start, passable, done, [](int, int) { return 0U; });
  if (out == kNone) return Answer::enclosed;
  trace_back(start, out);
  if (!append(from, centre(out), passable, path)) return Answer::too_winding;
  from = centre(out);
  start = out;
  return Answer::found;
}

/// The first cell reached of which done() holds, or none. `left` must never be more than the way
/// that is left, nor shrink by more than a step costs.
template <typename Passable, typename Done, typename Left>
std::uint32_t Planner::search(std::uint32_t start, Passable passable, Done done, Left left) {
  begin_search();
  const auto width = static_cast<std::uint32_t>(frame_.width());
  nodes_[start] = {0, kNone, kNone, search_, 0, 0};
  estimate_ = left(static_cast<int>(start % width), static_cast<int>(start / width));
  push(start, estimate_);
  while (open_ > 0) {
    const std::uint32_t cell = lowest();
    remove(cell, estimate_);
    nodes_[cell].closed = 1;
    if (done(cell)) return cell;
    widen(cell, passable, left);
  }
  return kNone;
}

template <typename Passable, typename Left>
void Planner::widen(std::uint32_t cell, Passable passable, Left left) {
  const auto width = static_cast<std::uint32_t>(frame_.width());
  const int x = static_cast<int>(cell % width);
  const int y = static_cast<int>(cell / width);
  std::array<bool, 4> open{};
  for (std::size_t i = 0; i < kSteps.size(); ++i) {
    const Step step = kSteps[i];
    if (!frame_.inside(x + step.dx, y + step.dy)) continue;
    const auto to = static_cast<std::uint32_t>(static_cast<std::int64_t>(cell) + offsets_[i]);
    if (!passable(to)) continue;
    if (i < 4) {
      open[i] = true;
    } else if (!open[step.dx > 0 ? 0 : 3] || !open[step.dy > 0 ? 1 : 2]) {
      continue;
    }
    Node& node = nodes_[to];
    const bool known = node.search == search_;
    const std::uint32_t cost = nodes_[cell].cost + (i < 4 ? kStraight : kDiagonal);
    if (known && (node.closed != 0 || node.cost <= cost)) continue;
    const std::uint32_t rest = left(x + step.dx, y + step.dy);
    if (known) remove(to, node.cost + rest);
    node.cost = cost;
    node.search = search_;
    node.from = static_cast<std::uint8_t>(i);
    node.closed = 0;
    push(to, cost + rest);
  }
}

void Planner::begin_search() {
  buckets_.fill(kNone);
  open_ = 0;
  if (++search_ == 0) {  // once in 65536: the numbers begin anew
    for (Node& node : nodes_) node.search = 0;
    search_ = 1;
  }
}

/// One of the open cells with the least estimate, the latest first: that one is the nearest to the
/// goal.
std::uint32_t Planner::lowest() {
  while (buckets_[estimate_ % kBuckets] == kNone) ++estimate_;
  return buckets_[estimate_ % kBuckets];
}

void Planner::push(std::uint32_t cell, std::uint32_t estimate) {
  std::uint32_t& first = buckets_[estimate % kBuckets];
  nodes_[cell].next = first;
  nodes_[cell].previous = kNone;
  if (first != kNone) nodes_[first].previous = cell;
  first = cell;
  ++open_;
}

void Planner::remove(std::uint32_t cell, std::uint32_t estimate) {
  const Node& node = nodes_[cell];
  if (node.previous == kNone) {
    buckets_[estimate % kBuckets] = node.next;
  } else {
    nodes_[node.previous].next = node.next;
  }
  if (node.next != kNone) nodes_[node.next].previous = node.previous;
  --open_;
}

void Planner::trace_back(std::uint32_t from, std::uint32_t to) {
  length_ = 0;
  for (std::uint32_t cell = to;;) {
    route_[length_++] = cell;
    if (cell == from) return;
    const std::int64_t offset = offsets_[nodes_[cell].from];
    cell = static_cast<std::uint32_t>(static_cast<std::int64_t>(cell) - offset);
  }
}

/// Of the places `from`, the cells of the route, and `to`: those that are needed so that each sees
/// the next. False when the path is full.
template <typename Passable>
bool Planner::append(const Point2D& from, const Point2D& to, Passable passable, Path& path) const {
  const std::size_t last = length_ + 1;
  const auto place = [&](std::size_t i) {
    return i == 0 ? from : i == last ? to : centre(route_[length_ - i]);
  };
  const auto sees = [&](std::size_t i, std::size_t j) {
    return all_along(place(i), place(j),
                     [&](int x, int y) { return passable(frame_.index(x, y)); });
  };
  for (std::size_t at = 0; at < last;) {
    std::size_t farthest = at + 1;
    std::size_t leap = 1;
    while (farthest < last && sees(at, std::min(farthest + leap, last))) {
      farthest = std::min(farthest + leap, last);
      leap *= 2;
    }
    for (; leap > 0; leap /= 2) {
      if (farthest + leap <= last && sees(at, farthest + leap)) farthest += leap;
    }
    if (!path.points.push_back(frame_.world(place(farthest)))) return false;
    at = farthest;
  }
  return true;
}

bool Planner::free(const Point2D& from, const Point2D& to) const {
  if (!has_map_) return false;
  const Point2D a = frame_.cells(from);
  const Point2D b = frame_.cells(to);
  return frame_.inside(a) && frame_.inside(b) &&
         all_along(a, b, [&](int x, int y) { return is_free(frame_.index(x, y)); });
}

bool Planner::obstructed(const Point2D& from, const Point2D& to) const {
  if (!has_map_ || obstacle_count_ == 0) return false;
  const Point2D a = frame_.cells(from);
  const Point2D b = frame_.cells(to);
  return frame_.inside(a) && frame_.inside(b) && !all_along(a, b, [&](int x, int y) {
           return (blocked_[frame_.index(x, y)] & kByObstacle) == 0;
         });
}

double Planner::clearance(const Point2D& at) const {
  const Point2D cell = frame_.cells(at);
  if (!has_map_ || !frame_.inside(cell)) return 0.0;
  return frame_.resolution() *
         std::sqrt(static_cast<double>(distances_.squared(frame_.index(cell))));
}

void Planner::block(const Point2D& at, double until) {
  const Point2D place = frame_.cells(at);
  if (!has_map_ || !frame_.inside(place) || obstacle_count_ == kObstacles) return;
  const auto cell = static_cast<std::uint32_t>(frame_.index(place));
  if ((blocked_[cell] & kObstacleHere) != 0) return;
  first_over_ = obstacle_count_ == 0 ? until : std::min(first_over_, until);
  obstacles_[obstacle_count_++] = {cell, until};
  stamp(cell, true);
}

void Planner::forget(double now) {
  if (obstacle_count_ == 0 || now < first_over_) return;
  const std::size_t count = obstacle_count_;
  for (std::size_t i = 0; i < count; ++i) stamp(obstacles_[i].cell, false);
  obstacle_count_ = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Obstacle obstacle = obstacles_[i];
    if (obstacle.until > now) block(frame_.world(centre(obstacle.cell)), obstacle.until);
  }
}

void Planner::stamp(std::uint32_t cell, bool set) {
  const int middle_x = static_cast<int>(cell % static_cast<std::uint32_t>(frame_.width()));
  const int middle_y = static_cast<int>(cell / static_cast<std::uint32_t>(frame_.width()));
  for (int dy = -radius_; dy <= radius_; ++dy) {
    for (int dx = -radius_; dx <= radius_; ++dx) {
      if (dx * dx + dy * dy > radius_squared_ || !frame_.inside(middle_x + dx, middle_y + dy)) {
        continue;
      }
      std::uint8_t& here = blocked_[frame_.index(middle_x + dx, middle_y + dy)];
      here = static_cast<std::uint8_t>(set ? here | kByObstacle : here & kByMap);
    }
  }
  if (set) blocked_[cell] |= kObstacleHere;
}

Point2D Planner::centre(std::uint32_t cell) const {
  const auto width = static_cast<std::uint32_t>(frame_.width());
  return {cell % width + 0.5, cell / width + 0.5};
}

}  // namespace navigation
