// SPDX-License-Identifier: LGPL-3.0-or-later
/// Where the cells of a map lie in the world, and the lines between them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "../types/grid.h"
#include "../types/pose.h"

namespace navigation {

using rover::OccupancyGrid;
using rover::Point2D;
using rover::Pose2D;

/// Places in cells: cell (i, j) covers i <= x < i + 1, j <= y < j + 1.
class Frame {
 public:
  static constexpr int kLongestSide = 8192;

  Frame() = default;
  /// Nothing when the map is none: no resolution, a side too long, or cells that do not fit its
  /// size. [rt]
  [[nodiscard]] static std::optional<Frame> of(const OccupancyGrid& grid) {
    const bool finite = std::isfinite(grid.origin.x) && std::isfinite(grid.origin.y) &&
                        std::isfinite(grid.origin.heading) && std::isfinite(grid.resolution);
    if (!finite || grid.resolution <= 0.0 || grid.width <= 0 || grid.height <= 0) return {};
    if (grid.width > kLongestSide || grid.height > kLongestSide) return {};
    const auto cells =
        static_cast<std::uint64_t>(grid.width) * static_cast<std::uint64_t>(grid.height);
    if (cells != grid.cells.size()) return {};
    Frame frame;
    frame.resolution_ = grid.resolution;
    frame.origin_ = grid.origin;
    frame.cosine_ = std::cos(grid.origin.heading);
    frame.sine_ = std::sin(grid.origin.heading);
    frame.width_ = grid.width;
    frame.height_ = grid.height;
    return frame;
  }

  [[nodiscard]] double resolution() const { return resolution_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  [[nodiscard]] double heading() const { return origin_.heading; }

  /// World to cells. [rt]
  [[nodiscard]] Point2D cells(const Point2D& at) const {
    const double dx = (at.x - origin_.x) / resolution_;
    const double dy = (at.y - origin_.y) / resolution_;
    return {cosine_ * dx + sine_ * dy, cosine_ * dy - sine_ * dx};
  }
  /// Cells to world. [rt]
  [[nodiscard]] Point2D world(const Point2D& at) const {
    return {origin_.x + resolution_ * (cosine_ * at.x - sine_ * at.y),
            origin_.y + resolution_ * (sine_ * at.x + cosine_ * at.y)};
  }
  /// False also for a cell that is not a number. [rt]
  [[nodiscard]] bool inside(const Point2D& cell) const {
    return cell.x >= 0.0 && cell.y >= 0.0 && cell.x < width_ && cell.y < height_;
  }
  [[nodiscard]] bool inside(int x, int y) const {
    return x >= 0 && y >= 0 && x < width_ && y < height_;
  }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  /// Of a place inside.
  [[nodiscard]] std::size_t index(const Point2D& cell) const {
    return index(static_cast<int>(cell.x), static_cast<int>(cell.y));
  }

 private:
  Pose2D origin_;
  double resolution_ = 1.0;
  double cosine_ = 1.0;
  double sine_ = 0.0;
  int width_ = 0;
  int height_ = 0;
};

/// Does f(x, y) hold in every cell that the line touches? Both neighbours of a corner that it
/// passes are touched. Ends at the first that does not; at most some thousand steps. [rt]
template <typename F>
[[nodiscard]] bool all_along(const Point2D& from, const Point2D& to, F&& f) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  constexpr double kCorner = 1e-9;
  int x = static_cast<int>(std::floor(from.x));
  int y = static_cast<int>(std::floor(from.y));
  const int last_x = static_cast<int>(std::floor(to.x));
  const int last_y = static_cast<int>(std::floor(to.y));
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const int step_x = dx > 0.0 ? 1 : -1;
  const int step_y = dy > 0.0 ? 1 : -1;
  const double per_x = dx == 0.0 ? kNever : 1.0 / std::abs(dx);
  const double per_y = dy == 0.0 ? kNever : 1.0 / std::abs(dy);
  double next_x = dx == 0.0 ? kNever : (dx > 0.0 ? x + 1 - from.x : from.x - x) * per_x;
  double next_y = dy == 0.0 ? kNever : (dy > 0.0 ? y + 1 - from.y : from.y - y) * per_y;
  int left = std::abs(last_x - x) + std::abs(last_y - y);
  if (!f(x, y)) return false;
  while (left > 0) {
    const bool corner = std::abs(next_x - next_y) < kCorner && x != last_x && y != last_y;
    if (corner && !(f(x + step_x, y) && f(x, y + step_y))) return false;
    const bool along_x = corner || y == last_y || (x != last_x && next_x < next_y);
    const bool along_y = corner || !along_x;
    if (along_x) x += step_x, next_x += per_x, --left;
    if (along_y) y += step_y, next_y += per_y, --left;
    if (!f(x, y)) return false;
  }
  return true;
}

}  // namespace navigation
