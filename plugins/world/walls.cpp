// SPDX-License-Identifier: LGPL-3.0-or-later
#include "walls.h"

#include <algorithm>
#include <cmath>

namespace world {
namespace {

constexpr int kOccupied = 50;
constexpr double kNowhere = 1e9;
constexpr double kBeyond = 1e-4;    // cells, to be surely in the next one
constexpr double kDiagonal = 1.42;  // from the centres of two cells to any places in them, at most
constexpr int kWorthALeap = 7;      // square cells

/// Where a ray is between two lines; `in` and `out` are narrowed.
void clip(double from, double step, double high, double& in, double& out) {
  if (step == 0.0) {
    if (from < 0.0 || from >= high) out = -1.0;
    return;
  }
  const double a = -from / step;
  const double b = (high - from) / step;
  in = std::max(in, std::min(a, b));
  out = std::min(out, std::max(a, b));
}

/// How far along it the ray enters the next cell in one direction.
double border(double from, double step, int cell) {
  return step == 0.0 ? kNowhere : (cell + (step > 0.0 ? 1 : 0) - from) / step;
}

}  // namespace

bool Walls::set(const rover::OccupancyGrid& grid) {
  const auto frame = navigation::Frame::of(grid);
  if (!frame) return false;
  frame_ = *frame;
  distances_ = navigation::Distances(frame_.size());
  distances_.measure(frame_, false, [&](std::size_t i) { return grid.cells[i] >= kOccupied; });
  return true;
}

void Walls::cast(const rover::Pose2D& pose, rover::LaserScan& scan) const {
  const rover::Point2D from = frame_.cells({pose.x, pose.y});
  if (!std::isfinite(from.x + from.y + pose.heading)) return;
  for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
    const double angle = pose.heading - frame_.heading() + scan.angle(beam);
    const double most = static_cast<double>(scan.ranges[beam]) / frame_.resolution();
    const double range = hit({from, std::cos(angle), std::sin(angle)}, most);
    if (range < most) scan.ranges[beam] = static_cast<float>(range * frame_.resolution());
  }
}

/// In cells; `most` when there is no wall before.
double Walls::hit(const Ray& ray, double most) const {
  double at = 0.0;
  double end = most;
  clip(ray.from.x, ray.dx, frame_.width(), at, end);
  clip(ray.from.y, ray.dy, frame_.height(), at, end);
  while (at < end) {
    const int x = std::clamp(static_cast<int>(ray.from.x + at * ray.dx), 0, frame_.width() - 1);
    const int y = std::clamp(static_cast<int>(ray.from.y + at * ray.dy), 0, frame_.height() - 1);
    const int squared = distances_.squared(frame_.index(x, y));
    if (squared == 0) return at;
    if (squared >= kWorthALeap) {
      at += std::sqrt(static_cast<double>(squared)) - kDiagonal;
    } else {
      const double next = std::min(border(ray.from.x, ray.dx, x), border(ray.from.y, ray.dy, y));
      at = std::max(at, next) + kBeyond;
    }
  }
  return most;
}

double Walls::clearance(const rover::Point2D& from) const {
  const rover::Point2D at = frame_.cells(from);
  if (!frame_.inside(at)) return kNowhere;
  const double x = std::clamp(at.x - 0.5, 0.0, frame_.width() - 1.0);
  const double y = std::clamp(at.y - 0.5, 0.0, frame_.height() - 1.0);
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const double right = x - column;
  const double up = y - row;
  const double low = (1.0 - right) * distance(column, row) + right * distance(column + 1, row);
  const double high =
      (1.0 - right) * distance(column, row + 1) + right * distance(column + 1, row + 1);
  return frame_.resolution() * ((1.0 - up) * low + up * high - 0.5);
}

double Walls::distance(int x, int y) const {
  const std::size_t cell =
      frame_.index(std::min(x, frame_.width() - 1), std::min(y, frame_.height() - 1));
  return std::sqrt(static_cast<double>(distances_.squared(cell)));
}

}  // namespace world
