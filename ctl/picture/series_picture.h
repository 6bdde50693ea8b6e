// SPDX-License-Identifier: LGPL-3.0-or-later
/// Values over time as a picture: one panel for each unit.
#pragma once

#include <string>
#include <vector>

#include "picture/svg.h"

namespace mauve::ctl {

struct Series {
  std::string name;
  std::string unit;
  std::vector<Place> points;  ///< x: s, y: the value; a value that is no number makes a gap
};

/// A whole SVG file.
[[nodiscard]] std::string draw_series(const std::vector<Series>& all);

}  // namespace mauve::ctl
