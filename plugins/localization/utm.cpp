// SPDX-License-Identifier: LGPL-3.0-or-later
#include "utm.h"

#include <cmath>

namespace localization {
namespace {

constexpr double kRadius = 6'378'137.0;  // WGS 84
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kCentralScale = 0.9996;
constexpr double kFalseEasting = 500'000.0;
constexpr double kFalseNorthing = 10'000'000.0;
constexpr double kFarthestMeridian = 15.0;  // deg

double middle_of(Zone zone) { return 6.0 * zone.number - 183.0; }
double north_of(Zone zone) { return zone.south ? kFalseNorthing : 0.0; }

/// False for a value that is not a number, too.
bool covered(const Geographic& position) {
  return position.latitude >= -80.0 && position.latitude <= 84.0 &&
         std::abs(position.longitude) <= 360.0;
}

}  // namespace

Utm::Utm() : projection_(kRadius, kFlattening, kCentralScale) {}

std::optional<Zone> Utm::zone_of(const Geographic& position) {
  if (!covered(position)) return {};
  const double latitude = position.latitude;
  double longitude = std::remainder(position.longitude, 360.0);
  if (longitude >= 180.0) longitude -= 360.0;
  int number = static_cast<int>(std::floor((longitude + 180.0) / 6.0)) + 1;
  if (latitude >= 56.0 && latitude < 64.0 && number == 31 && longitude >= 3.0) number = 32;
  if (latitude >= 72.0 && longitude >= 0.0 && longitude < 42.0) {
    number = longitude < 9.0 ? 31 : longitude < 21.0 ? 33 : longitude < 33.0 ? 35 : 37;
  }
  return Zone{number, latitude < 0.0};
}

std::optional<rover::Point2D> Utm::forward(const Geographic& position, Zone zone) const {
  if (!covered(position)) return {};
  if (std::abs(std::remainder(position.longitude - middle_of(zone), 360.0)) > kFarthestMeridian)
    return {};
  rover::Point2D point;
  projection_.Forward(middle_of(zone), position.latitude, position.longitude, point.x, point.y);
  return rover::Point2D{point.x + kFalseEasting, point.y + north_of(zone)};
}

Geographic Utm::reverse(const rover::Point2D& point, Zone zone) const {
  Geographic position;
  projection_.Reverse(middle_of(zone), point.x - kFalseEasting, point.y - north_of(zone),
                      position.latitude, position.longitude);
  return position;
}

}  // namespace localization
