// SPDX-License-Identifier: LGPL-3.0-or-later
/// The walls of the simulated world: the occupied cells of a map.
#pragma once

#include "../navigation/distance.h"
#include "../navigation/grid_frame.h"
#include "../types/pose.h"
#include "../types/scan.h"

namespace world {

/// A beam goes from cell to cell (Amanatides and Woo 1987), and leaps where the next wall is far
/// (sphere tracing, Hart 1996): 541 beams cost some 0.1 ms.
class Walls {
 public:
  /// False when the grid is no map. Unknown cells are no walls. [factory]
  [[nodiscard]] bool set(const rover::OccupancyGrid& grid);

  /// Shortens the beams that meet a wall. [rt]
  void cast(const rover::Pose2D& pose, rover::LaserScan& scan) const;
  /// Distance from the point to the nearest wall, m, true to half a cell; large off the map. [rt]
  [[nodiscard]] double clearance(const rover::Point2D& from) const;

 private:
  struct Ray {
    rover::Point2D from;  // cells
    double dx;
    double dy;
  };
  [[nodiscard]] double hit(const Ray& ray, double most) const;
  [[nodiscard]] double distance(int x, int y) const;

  navigation::Frame frame_;
  navigation::Distances distances_;
};

}  // namespace world
