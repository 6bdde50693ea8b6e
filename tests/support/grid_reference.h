// SPDX-License-Identifier: LGPL-3.0-or-later
/// The ways that the planner's are compared with.
#pragma once

#include <cmath>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "../../plugins/navigation/grid_frame.h"
#include "../../plugins/types/grid.h"
#include "../../plugins/world/random.h"

namespace support {

constexpr double kFarAway = std::numeric_limits<double>::infinity();

inline double length(const rover::Point2D& start, const rover::Path& path) {
  double sum = 0.0;
  rover::Point2D at = start;
  for (const rover::Point2D& point : path.points) {
    sum += std::hypot(point.x - at.x, point.y - at.y);
    at = point;
  }
  return sum;
}

/// The same grid by the simplest means: discs round every cell that is not free, and Dijkstra.
class GridReference {
 public:
  GridReference(const rover::OccupancyGrid& grid, double keep_away)
      : frame_(*navigation::Frame::of(grid)), blocked_(grid.cells.size(), false) {
    const double radius = keep_away / grid.resolution;
    for (int y = -1; y <= grid.height; ++y) {
      for (int x = -1; x <= grid.width; ++x) {
        if (!frame_.inside(x, y) || grid.cells[frame_.index(x, y)] != 0) block(x, y, radius);
      }
    }
  }

  [[nodiscard]] const navigation::Frame& frame() const { return frame_; }
  [[nodiscard]] bool blocked(const rover::Point2D& world) const {
    const rover::Point2D cell = frame_.cells(world);
    return !frame_.inside(cell) || blocked_[frame_.index(cell)];
  }
  [[nodiscard]] std::vector<double> distances_from(const rover::Point2D& world) const {
    std::vector<double> distances(blocked_.size(), kFarAway);
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    const auto reach = [&](std::size_t cell, double distance) {
      if (blocked_[cell] || distance >= distances[cell]) return;
      distances[cell] = distance;
      open.emplace(distance, cell);
    };
    reach(frame_.index(frame_.cells(world)), 0.0);
    while (!open.empty()) {
      const auto [distance, cell] = open.top();
      open.pop();
      if (distance > distances[cell]) continue;
      const int x = static_cast<int>(cell % static_cast<std::size_t>(frame_.width()));
      const int y = static_cast<int>(cell / static_cast<std::size_t>(frame_.width()));
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          if (!frame_.inside(x + dx, y + dy) || blocked_[frame_.index(x + dx, y)] ||
              blocked_[frame_.index(x, y + dy)]) {
            continue;
          }
          reach(frame_.index(x + dx, y + dy), distance + frame_.resolution() * std::hypot(dx, dy));
        }
      }
    }
    return distances;
  }
  [[nodiscard]] rover::Point2D random_free(world::Random& random) const {
    while (true) {
      const rover::Point2D cell{std::floor(random.uniform(0.0, frame_.width())) + 0.5,
                                std::floor(random.uniform(0.0, frame_.height())) + 0.5};
      if (!blocked_[frame_.index(cell)]) return frame_.world(cell);
    }
  }

 private:
  void block(int x, int y, double radius) {
    const int reach = static_cast<int>(radius);
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const bool near = dx * dx + dy * dy < radius * radius || (dx == 0 && dy == 0);
        if (near && frame_.inside(x + dx, y + dy)) blocked_[frame_.index(x + dx, y + dy)] = true;
      }
    }
  }

  navigation::Frame frame_;
  std::vector<bool> blocked_;
};

}  // namespace support
