// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource kind "localization/gnss_to_utm": turns the fix of a receiver into metres in the local
/// frame. It writes the result, under its lock, to the resource that its port is connected to.
/// Example: connect gnss.ports.fix gnss_to_utm.fix; connect gnss_to_utm.ports.pose
/// localization.update_pose
///
/// The local frame is UTM, moved to an origin: x is grid east, y grid north, which is not true
/// north (0.9 degrees off at Toulouse). Zone and hemisphere are those of the origin for good. One
/// fix makes no origin, since it may be wrong: the first of three in a row that agree does, and
/// nothing is written before.
#pragma once

#include <mauve/plugin.h>

#include <cmath>
#include <cstdint>
#include <optional>

#include "../types/gnss.h"
#include "../types/motion.h"
#include "../types/silence.h"
#include "origin_search.h"
#include "utm.h"

namespace localization {

/// Where the local frame lies; survives a change.
struct Origin {
  bool known = false;
  std::int32_t zone = 31;
  bool south = false;
  double easting = 0.0;   ///< m
  double northing = 0.0;  ///< m

  static constexpr std::string_view type_name = "utm_origin/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("known", &Origin::known), mauve::field("zone", &Origin::zone),
                      mauve::field("south", &Origin::south),
                      mauve::field("easting", &Origin::easting, "m"),
                      mauve::field("northing", &Origin::northing, "m")};
  }
};

struct GnssToUtmShell : mauve::Shell {
  mauve::WritePort<rover::Pose> pose{*this, "pose"};
};

class GnssToUtmCore final : public mauve::Core<GnssToUtmShell> {
 public:
  /// [rt] Without a position nothing is written.
  void convert(const rover::GnssFix& fix) {
    satellites = fix.satellites;
    mode = fix.mode;
    hdop = std::isfinite(fix.hdop) ? fix.hdop : 0.0;
    if (fix.mode < 2) {
      ++without_position;
      return silence_.look("its receiver has no fix");
    }
    if (fix.latitude == 0.0 && fix.longitude == 0.0) {  // of receivers that have none yet
      ++without_position;
      return silence_.look("its receiver says that it is at exactly 0, 0");
    }
    const Geographic position{fix.latitude, fix.longitude};
    if (!fixed_.known && !origin_->known) {
      const OriginSearch::Found found = search_.look(position, now());
      if (found == OriginSearch::Found::nothing) {
        return silence_.look("no 3 fixes in a row agree on an origin");
      }
      if (found == OriginSearch::Found::origin) *origin_ = origin_at(search_.first());
    }
    const Origin& origin = fixed_.known ? fixed_ : *origin_;
    const std::optional<rover::Point2D> point = utm_.forward(position, {origin.zone, origin.south});
    zone = origin.known ? origin.zone : 0;
    if (!origin.known || !point) {
      ++refused;
      return refuse(origin);
    }
    const bool says = fix.hdop > 0.0 && fix.hdop <= kWorstHdop;
    shell().pose.write({now() - latency, point->x - origin.easting, point->y - origin.northing,
                        says ? fix.hdop * range_error : 0.0});
    ++positions;
    look_at_distance(std::hypot(point->x - origin.easting, point->y - origin.northing));
    silence_.ended();
  }

 private:
  static constexpr double kFar = 100'000.0;   // m from the origin
  static constexpr double kWorstHdop = 99.0;  // beyond it the receiver does not know

  [[nodiscard]] static double now() { return mauve::to_seconds(mauve::job_time()); }

  mauve::State<Origin> origin_{*this};
  mauve::Property<bool> origin_at_first_fix{*this, "origin_at_first_fix", true,
                                            "the first of three that agree; else at the two below"};
  mauve::Property<double> origin_latitude{*this,
                                          "origin_latitude",
                                          0.0,
                                          "of the local frame, north positive",
                                          {.unit = "deg", .min = -80.0, .max = 84.0}};
  mauve::Property<double> origin_longitude{*this,
                                           "origin_longitude",
                                           0.0,
                                           "of the local frame, east positive",
                                           {.unit = "deg", .min = -180.0, .max = 180.0}};
  mauve::Property<double> range_error{*this,
                                      "range_error",
                                      3.0,
                                      "deviation of a position at an HDOP of 1",
                                      {.unit = "m", .min = 0.001, .max = 1000.0}};
  mauve::Property<double> latency{*this,
                                  "latency",
                                  0.0,
                                  "a fix is that old when it is written here",
                                  {.unit = "s", .min = 0.0, .max = 10.0}};
  mauve::Observable<std::uint64_t> positions{*this, "positions", 0, "written on"};
  mauve::Observable<std::uint64_t> without_position{*this, "without_position", 0,
                                                    "epochs of mode 1, or at 0, 0; dropped"};
  mauve::Observable<std::uint64_t> refused{*this, "refused", 0,
                                           "positions that are none, or far from the zone"};
  mauve::Observable<int> satellites{*this, "satellites", 0, "used in the last epoch"};
  mauve::Observable<int> mode{*this, "mode", 1, "1 none, 2 two dimensions, 3 three"};
  mauve::Observable<double> hdop{*this, "hdop", 0.0, "of the last epoch"};
  mauve::Observable<int> zone{*this, "zone", 0, "of UTM; 0: not yet known"};
  mauve::Warning far{*this, "far", "the fixes are far from the origin"};

  mauve::Status on_configure() override {
    fixed_ = {};
    if (!origin_at_first_fix) fixed_ = origin_at({origin_latitude, origin_longitude});
    *origin_ = {};
    search_ = {};
    return mauve::ok();
  }

  /// Fixes that were wrong alike make a wrong origin.
  void look_at_distance(double metres) {
    if (metres > kFar) {
      far.begin(
          "the fixes are {} km from the origin: if that was found wrongly, declare the origin "
          "(origin_at_first_fix, origin_latitude, origin_longitude)",
          static_cast<std::int64_t>(metres / 1000.0));
    } else {
      far.end("the fixes are near the origin again");
    }
  }

  void refuse(const Origin& origin) {
    if (!origin.known) {
      return silence_.look("the fixes lie outside of UTM (80 degrees south to 84 north)");
    }
    silence_.look(
        "the fixes are far from zone {} of the origin: if that was found wrongly, declare the "
        "origin (origin_at_first_fix, origin_latitude, origin_longitude)",
        origin.zone);
  }

  [[nodiscard]] Origin origin_at(const Geographic& position) const {
    const std::optional<Zone> there = Utm::zone_of(position);
    if (!there) return {};
    const std::optional<rover::Point2D> point = utm_.forward(position, *there);
    if (!point) return {};
    return {true, there->number, there->south, point->x, point->y};
  }

  Utm utm_;
  Origin fixed_;  // by property: a change of it counts at once
  OriginSearch search_;
  rover::Silence silence_{*this};
};

struct GnssToUtmInterface : mauve::Interface<GnssToUtmCore> {
  mauve::WriteService<rover::GnssFix> fix{*this, "fix", &GnssToUtmCore::convert};
};

}  // namespace localization
