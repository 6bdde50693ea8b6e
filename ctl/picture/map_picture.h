// SPDX-License-Identifier: LGPL-3.0-or-later
/// The way that a robot drove as a picture, north up, with its known surroundings.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "picture/svg.h"
#include "protocol/message.h"

namespace mauve::ctl {

using protocol::Json;

struct MapPicture {
  struct Step {
    Place at;
    double heading = 0.0;
    std::string mode;  ///< colours this piece of the way
    /// Of its place, m^2; no ellipse when both are zero.
    double variance_x = 0.0;
    double variance_y = 0.0;
    double covariance = 0.0;
  };
  struct Disc {
    Place at;
    double radius = 0.0;
  };

  std::vector<Step> way;
  std::vector<Place> returns;  ///< of the laser, where they were seen
  std::vector<Place> path;
  std::optional<Place> goal;
  std::vector<Disc> discs;
  Json grid;  ///< an occupancy grid, or null
};

/// The whole file.
[[nodiscard]] std::string draw_map(const MapPicture& picture);

}  // namespace mauve::ctl
