// SPDX-License-Identifier: LGPL-3.0-or-later
/// A map of occupied cells, and a way through it: occupancy_grid/1, path/1.
#pragma once

#include <cstddef>
#include <cstdint>

#include <mauve/bounded.h>
#include <mauve/type.h>

#include "pose.h"

namespace rover {

/// Cells row by row from the origin (its lower left corner), x first. The values are those that
/// robots use elsewhere: 0 free to 100 occupied, -1 unknown.
struct OccupancyGrid {
  static constexpr std::size_t kCapacity = 2048UL * 2048UL;

  double time = 0.0;        ///< s, monotonic clock; another one means another map
  double resolution = 0.0;  ///< m, edge of a cell; 0: there is no map
  Pose2D origin;            ///< of the corner of cell 0
  std::int32_t width = 0;   ///< cells
  std::int32_t height = 0;  ///< cells
  mauve::Bounded<std::int8_t, kCapacity> cells;

  static constexpr std::string_view type_name = "occupancy_grid/1";
  static constexpr auto fields() {
    return std::tuple{
        mauve::field("time", &OccupancyGrid::time, "s",
                     "monotonic clock; another one means another map"),
        mauve::field("resolution", &OccupancyGrid::resolution, "m"),
        mauve::field("origin", &OccupancyGrid::origin, "m", "corner of the first cell"),
        mauve::field("width", &OccupancyGrid::width, "", "cells"),
        mauve::field("height", &OccupancyGrid::height, "", "cells"),
        mauve::field("cells", &OccupancyGrid::cells, "", "0 free to 100 occupied, -1 unknown")};
  }
};

/// Places to pass, the goal last. Empty: there is no way, or nothing to do.
struct Path {
  static constexpr std::size_t kCapacity = 256;

  mauve::Bounded<Point2D, kCapacity> points;

  static constexpr std::string_view type_name = "path/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("points", &Path::points, "m", "to pass, the goal last")};
  }
};

}  // namespace rover
