// SPDX-License-Identifier: LGPL-3.0-or-later
/// The projection against published points, another series, and the library's own UTM.
#include <gtest/gtest.h>

#include <GeographicLib/UTMUPS.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "../../../plugins/localization/utm.h"
#include "../../../plugins/world/random.h"

namespace localization {
namespace {

using rover::Point2D;

void expect_at(const Geographic& position, int zone, double easting, double northing, double within,
               bool south = false) {
  const std::optional<Zone> there = Utm::zone_of(position);
  ASSERT_TRUE(there);
  EXPECT_EQ(there->number, zone);
  EXPECT_EQ(there->south, south);
  const std::optional<Point2D> point = Utm().forward(position, *there);
  ASSERT_TRUE(point);
  EXPECT_NEAR(point->x, easting, within);
  EXPECT_NEAR(point->y, northing, within);
}

TEST(Utm, PutsKnownPlacesWhereMapsDo) {
  expect_at({43.0 + 38.0 / 60 + 33.24 / 3600, -(79.0 + 23.0 / 60 + 13.7 / 3600)}, 17, 630084.3,
            4833438.5, 0.06);
  expect_at({43.5661, 1.4744}, 31, 376797.77, 4824812.93, 0.005);
  expect_at({-33.9, 18.4}, 34, 259583.22, 6245888.05, 0.005, true);
}

/// Krueger's series with three terms, which errs by less than a millimetre.
Point2D krueger(const Geographic& position, Zone zone) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  constexpr double f = 1.0 / 298.257223563;
  constexpr double n = f / (2.0 - f);
  const double radius = 6378137.0 / (1.0 + n) * (1.0 + n * n / 4.0 + n * n * n * n / 64.0);
  const std::array<double, 3> alpha{n / 2 - 2 * n * n / 3 + 5 * n * n * n / 16,
                                    13 * n * n / 48 - 3 * n * n * n / 5, 61 * n * n * n / 240};
  const double phi = position.latitude * kDegree;
  const double lambda = (position.longitude - (6.0 * zone.number - 183.0)) * kDegree;
  const double c = 2.0 * std::sqrt(n) / (1.0 + n);
  const double t = std::sinh(std::atanh(std::sin(phi)) - c * std::atanh(c * std::sin(phi)));
  const double xi = std::atan2(t, std::cos(lambda));
  const double eta = std::atanh(std::sin(lambda) / std::sqrt(1.0 + t * t));
  Point2D point{eta, xi};
  for (int j = 1; j <= 3; ++j) {
    const double a = alpha[static_cast<std::size_t>(j - 1)];
    point.x += a * std::cos(2 * j * xi) * std::sinh(2 * j * eta);
    point.y += a * std::sin(2 * j * xi) * std::cosh(2 * j * eta);
  }
  return {500000.0 + 0.9996 * radius * point.x,
          (zone.south ? 1e7 : 0.0) + 0.9996 * radius * point.y};
}

TEST(Utm, AgreesWithTwoOtherImplementationsAllOverTheGlobe) {
  const Utm utm;
  world::Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const Geographic position{random.uniform(-79.9, 83.9), random.uniform(-180.0, 180.0)};
    const std::optional<Zone> zone = Utm::zone_of(position);
    ASSERT_TRUE(zone);
    const std::optional<Point2D> point = utm.forward(position, *zone);
    ASSERT_TRUE(point);
    int library_zone = 0;
    bool north = false;
    Point2D library;
    GeographicLib::UTMUPS::Forward(position.latitude, position.longitude, library_zone, north,
                                   library.x, library.y);
    EXPECT_EQ(zone->number, library_zone) << position.latitude << " " << position.longitude;
    EXPECT_EQ(zone->south, !north);
    EXPECT_NEAR(point->x, library.x, 1e-6);
    EXPECT_NEAR(point->y, library.y, 1e-6);
    const Point2D series = krueger(position, *zone);
    EXPECT_NEAR(point->x, series.x, 1e-3);
    EXPECT_NEAR(point->y, series.y, 1e-3);
    const Geographic back = utm.reverse(*point, *zone);
    EXPECT_NEAR(back.latitude, position.latitude, 1e-9);
    EXPECT_NEAR(std::remainder(back.longitude - position.longitude, 360.0), 0.0, 1e-9);
  }
}

TEST(Utm, DoesNotJumpAtTheBorderOfAZoneOrAtTheEquator) {
  const Utm utm;
  const Zone zone{31, false};
  const auto step = [&](const Geographic& a, const Geographic& b) {
    const Point2D from = utm.forward(a, zone).value();
    const Point2D to = utm.forward(b, zone).value();
    return std::hypot(to.x - from.x, to.y - from.y);
  };
  EXPECT_NEAR(step({43.5, 5.99999}, {43.5, 6.00001}), 1.62, 0.02);
  EXPECT_NEAR(step({0.00001, 3.0}, {-0.00001, 3.0}), 2.21, 0.02);
  EXPECT_NEAR(utm.forward({-0.00001, 3.0}, zone)->y, -1.105, 0.01);
}

TEST(Utm, CrossesTheDateLine) {
  const Utm utm;
  const Zone zone{60, false};
  const Point2D west = utm.forward({10.0, 179.99999}, zone).value();
  const Point2D east = utm.forward({10.0, -179.99999}, zone).value();
  EXPECT_NEAR(east.x - west.x, 2.19, 0.02);
  EXPECT_EQ(Utm::zone_of({10.0, -180.0})->number, 1);
  EXPECT_EQ(Utm::zone_of({10.0, 180.0})->number, 1);
}

TEST(Utm, HasNoPointForWhatIsNoPosition) {
  const Utm utm;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Zone zone{31, false};
  for (const Geographic& position :
       {Geographic{kNaN, 0.0}, Geographic{0.0, kNaN}, Geographic{kInfinity, 0.0},
        Geographic{0.0, -kInfinity}, Geographic{91.0, 3.0}, Geographic{84.1, 3.0},
        Geographic{-80.1, 3.0}, Geographic{0.0, 1e9}}) {
    EXPECT_FALSE(Utm::zone_of(position));
    EXPECT_FALSE(utm.forward(position, zone));
  }
  EXPECT_FALSE(utm.forward({43.0, 18.1}, zone)) << "too far from the zone";
  EXPECT_TRUE(utm.forward({43.0, 17.9}, zone));
}

}  // namespace
}  // namespace localization
