// SPDX-License-Identifier: LGPL-3.0-or-later
/// A map of what is occupied, and a way through it: occupancy_grid/1, path/1.
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
  static constexpr std::size_t kCapacity = 1024UL * 1024UL;

  double time = 0.0;        ///< s, monotonic clock; another one means another map
  double resolution = 0.0;  ///< m, edge of a cell; 0: there is no map
  Pose2D origin;            ///< of the corner of cell 0
  std::int32_t width = 0;   ///< cells
  std::int32_t height = 0;  ///< cells
  mauve::Bounded<std::int8_t, kCapacity> cells;
};

/// Places to pass, the goal last. Empty: there is no way, or nothing to do.
struct Path {
  static constexpr std::size_t kCapacity = 256;

  mauve::Bounded<Point2D, kCapacity> points;
};

}  // namespace rover

template <>
struct mauve::Described<rover::OccupancyGrid> {
  static constexpr std::string_view name = "occupancy_grid/1";
  static constexpr auto fields() {
    using rover::OccupancyGrid;
    return std::tuple{
        field("time", &OccupancyGrid::time, "s", "monotonic clock; another one means another map"),
        field("resolution", &OccupancyGrid::resolution, "m"),
        field("origin", &OccupancyGrid::origin, "m", "corner of the first cell"),
        field("width", &OccupancyGrid::width, "", "cells"),
        field("height", &OccupancyGrid::height, "", "cells"),
        field("cells", &OccupancyGrid::cells, "", "0 free to 100 occupied, -1 unknown")};
  }
};

template <>
struct mauve::Described<rover::Path> {
  static constexpr std::string_view name = "path/1";
  static constexpr auto fields() {
    using rover::Path;
    return std::tuple{field("points", &Path::points, "m", "to pass, the goal last")};
  }
};
