// SPDX-License-Identifier: LGPL-3.0-or-later
/// Boxes in columns by the direction of the arrows between them, arrows as lines with right angles.
/// The same input gives the same picture.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "picture/svg.h"

namespace mauve::ctl {

struct Box {
  double width = 0.0;
  double height = 0.0;
};

/// Leaves the right side of a box so far below its top, enters the left side of another one. Wires
/// that leave at the same place share their way.
struct Wire {
  std::size_t from = 0;
  double from_y = 0.0;
  std::size_t to = 0;
  double to_y = 0.0;
};

struct Arrangement {
  std::vector<Place> corners;              ///< upper left, of each box
  std::vector<double> widths;              ///< boxes of a column are equally wide
  std::vector<std::vector<Place>> routes;  ///< of each wire
  std::vector<Place> joints;               ///< where wires that share their way part
  double width = 0.0;
  double height = 0.0;
};

/// Boxes that nothing connects stand below those that are connected. `first`: nothing shall stand
/// before this one.
[[nodiscard]] Arrangement arrange(const std::vector<Box>& boxes, const std::vector<Wire>& wires,
                                  std::optional<std::size_t> first = std::nullopt);

/// In which column each box stands: before as many as possible of those that its wires lead to.
[[nodiscard]] std::vector<std::size_t> columns_of(std::size_t boxes, const std::vector<Wire>& wires,
                                                  std::optional<std::size_t> first = std::nullopt);

}  // namespace mauve::ctl
