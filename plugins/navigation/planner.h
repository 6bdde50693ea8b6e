// SPDX-License-Identifier: LGPL-3.0-or-later
/// Planner: the shortest way through a map that keeps away from occupied cells.
///
/// A* (Hart, Nilsson and Raphael 1968) on the 8-connected grid. The costs are whole numbers, 12 and
/// 17 (17 / 12 is the root of two but for 0.2 %). So the open cells lie in 64 buckets, and no step
/// costs more than a few stores. A diagonal step needs both cells beside it. The path keeps only
/// the farthest places that see each other. No heap and no clock; the same question has the same
/// answer. Each cell is closed once, so a plan costs at most the number of cells of the map: the
/// figures stand in README.md.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <tuple>
#include <vector>

#include <mauve/property.h>

#include "distance.h"
#include "grid_frame.h"

namespace navigation {

using rover::Path;

struct PlannerLimits {
  double keep_away = 0.45;       ///< m from occupied cells: the robot's radius and a margin
  bool through_unknown = false;  ///< unknown cells are driven through; else they are as occupied

  static auto parameters() {
    using mauve::parameter;
    return std::tuple{parameter("keep_away", &PlannerLimits::keep_away,
                                "from what is occupied: the robot's radius and a margin",
                                {.unit = "m", .min = 0.0, .max = 5.0}),
                      parameter("through_unknown", &PlannerLimits::through_unknown,
                                "drive where the map knows nothing")};
  }
};

enum class Answer : std::uint8_t {
  found,
  no_map,        ///< none, or cells smaller than 1/64 of keep_away
  outside,       ///< the start or the goal is not on the map, or not a number
  goal_blocked,  ///< nearer than keep_away to an occupied cell
  enclosed,      ///< the start is occupied, or nothing free is near it
  no_way,
  too_winding,  ///< more way points than a path has room for
  too_large,    ///< more cells than the planner has room for
};

[[nodiscard]] std::string_view to_string(Answer answer);

/// Takes 23 bytes for each cell; make it where memory may be asked for. Everything else is [rt].
class Planner {
 public:
  static constexpr std::size_t kObstacles = 512;

  /// For maps of at most so many cells.
  explicit Planner(std::size_t cells);

  /// False, and there is no map: see Answer::no_map and Answer::too_large. Forgets all obstacles.
  /// Some 15 ms for a million cells.
  bool set_map(const OccupancyGrid& grid, const PlannerLimits& limits);
  [[nodiscard]] bool has_map() const { return has_map_; }
  /// The answer of each plan while there is no map.
  [[nodiscard]] Answer why_no_map() const { return why_no_map_; }

  /// From `start`, which may be nearer to something than keep_away: then it leaves there first.
  Answer plan(const Point2D& start, const Point2D& goal, Path& path);
  /// Is the straight line on the map, and away from everything?
  [[nodiscard]] bool free(const Point2D& from, const Point2D& to) const;
  /// Is an obstacle too near to the straight line? Not off the map.
  [[nodiscard]] bool obstructed(const Point2D& from, const Point2D& to) const;
  /// To the centre of the next occupied cell of the map, m; obstacles do not count. 0 outside.
  [[nodiscard]] double clearance(const Point2D& at) const;

  /// Something that is not on the map, until this time; the path keeps away from it as from
  /// occupied cells. Nothing happens when it is known, outside, or there are kObstacles.
  void block(const Point2D& at, double until);
  /// Forgets the obstacles whose time is over.
  void forget(double now);

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr std::size_t kBuckets = 64;  // more than an estimate grows in a step
  static constexpr int kWidestRadius = 64;     // cells

  /// The search state of a cell; 16 bytes.
  struct Node {
    std::uint32_t cost;
    std::uint32_t next;  // in its bucket
    std::uint32_t previous;
    std::uint16_t search;  // the one that all this is of
    std::uint8_t from;     // direction of the step that led here
    std::uint8_t closed;
  };
  struct Obstacle {
    std::uint32_t cell;
    double until;
  };

  [[nodiscard]] bool solid(std::size_t cell) const { return distances_.squared(cell) == 0; }
  [[nodiscard]] bool is_free(std::size_t cell) const { return blocked_[cell] == 0; }

  template <typename Passable, typename Done, typename Left>
  std::uint32_t search(std::uint32_t start, Passable passable, Done done, Left left);
  template <typename Passable, typename Left>
  void widen(std::uint32_t cell, Passable passable, Left left);
  [[nodiscard]] std::uint32_t lowest();
  void begin_search();
  void push(std::uint32_t cell, std::uint32_t estimate);
  void remove(std::uint32_t cell, std::uint32_t estimate);
  void trace_back(std::uint32_t from, std::uint32_t to);
  template <typename Passable>
  bool append(const Point2D& from, const Point2D& to, Passable passable, Path& path) const;
  Answer leave(Point2D& from, std::uint32_t& start, Path& path);
  void stamp(std::uint32_t cell, bool set);
  [[nodiscard]] Point2D centre(std::uint32_t cell) const;

  Frame frame_;
  PlannerLimits limits_;
  bool has_map_ = false;
  Answer why_no_map_ = Answer::no_map;
  int radius_ = 0;  // cells
  double radius_squared_ = 0.0;
  Distances distances_;
  std::vector<std::uint8_t> blocked_;  // 1 by the map, 2 by an obstacle
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> route_;  // cells of the way found, the last one first
  std::size_t length_ = 0;            // of it
  std::array<std::uint32_t, kBuckets> buckets_{};
  std::size_t open_ = 0;
  std::uint32_t estimate_ = 0;  // the least of the open cells
  std::uint16_t search_ = 0;
  std::array<std::int32_t, 8> offsets_{};
  std::array<Obstacle, kObstacles> obstacles_{};
  std::size_t obstacle_count_ = 0;
  double first_over_ = 0.0;
};

}  // namespace navigation
