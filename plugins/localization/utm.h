// SPDX-License-Identifier: LGPL-3.0-or-later
/// The Universal Transverse Mercator projection with zone and hemisphere fixed, so that nothing
/// jumps at a border. GeographicLib's series, exact to nanometres; no heap, no exception.
#pragma once

#include <GeographicLib/TransverseMercator.hpp>

#include <optional>

#include "../types/pose.h"

namespace localization {

/// Degrees, north and east positive.
struct Geographic {
  double latitude = 0.0;
  double longitude = 0.0;
};

/// Which sheet of the projection.
struct Zone {
  int number = 31;     ///< 1 to 60
  bool south = false;  ///< northings count from 10,000 km south of the equator
};

class Utm {
 public:
  Utm();

  /// The zone that maps use there, with the exceptions of Norway and Spitsbergen; nothing where
  /// UTM ends (84 degrees north, 80 south) or without a position. [rt]
  [[nodiscard]] static std::optional<Zone> zone_of(const Geographic& position);

  /// Easting and northing in the zone, m; nothing over 15 degrees of longitude from its middle, or
  /// outside UTM. [rt]
  [[nodiscard]] std::optional<rover::Point2D> forward(const Geographic& position, Zone zone) const;
  /// The position of such a point. [rt]
  [[nodiscard]] Geographic reverse(const rover::Point2D& point, Zone zone) const;

 private:
  GeographicLib::TransverseMercator projection_;
};

}  // namespace localization
