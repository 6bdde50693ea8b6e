// SPDX-License-Identifier: LGPL-3.0-or-later
/// Turns values of the system into a MapPicture.
#include <cmath>
#include <cstdio>
#include <utility>

#include "cli/output.h"
#include "commands/actions.h"
#include "commands/recording.h"
#include "picture/map_picture.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

/// Scans are drawn each time it has gone on so far, m: else they cover everything.
constexpr double kBetweenScans = 1.0;

std::optional<Place> place_of(const Json& value) {
  // A coordinate that is "nan" on the wire is a string: there is no place to draw.
  if (!member(value, "x").is_number() || !member(value, "y").is_number()) return std::nullopt;
  return Place{number(value, "x"), number(value, "y")};
}

class Drawing {
 public:
  explicit Drawing(const Arguments& given)
      : pose_(given.one("POSE")),
        scan_(given.one("--scan")),
        path_(given.one("--path")),
        goal_(given.one("--goal")),
        mode_(given.one("--mode")) {}

  /// The addresses of the values that change on the way.
  [[nodiscard]] std::vector<std::string> addresses() const {
    std::vector<std::string> all{pose_};
    for (const std::string& one : {scan_, path_, goal_, mode_}) {
      if (!one.empty()) all.push_back(one);
    }
    return all;
  }
  void take(const Sample& sample) {
    if (sample.value.is_null()) return;
    if (sample.address == pose_) go_on(sample.value);
    if (sample.address == scan_) see(sample.value);
    if (sample.address == path_) follow_path(sample.value);
    if (sample.address == goal_) picture.goal = place_of(sample.value);
    if (sample.address == mode_) set_mode(compact(sample.value));
  }

  MapPicture picture;

 private:
  void go_on(const Json& pose) {
    const auto at = place_of(pose);
    if (!at) return;
    picture.way.push_back({*at, number(pose, "heading"), now_, number(pose, "variance_x"),
                           number(pose, "variance_y"), number(pose, "covariance_xy")});
  }
  /// The first mode that arrives was in force before as well.
  void set_mode(const std::string& mode) {
    if (now_.empty()) {
      for (MapPicture::Step& step : picture.way) step.mode = mode;
    }
    now_ = mode;
  }
  void see(const Json& scan) {
    if (picture.way.empty()) return;
    const MapPicture::Step& here = picture.way.back();
    if (seen_from_ &&
        std::hypot(here.at.x - seen_from_->x, here.at.y - seen_from_->y) < kBetweenScans) {
      return;
    }
    seen_from_ = here.at;
    double angle = here.heading + number(scan, "angle_min");
    for (const Json& range : list_in(scan, "ranges")) {
      const double r = range.is_number() ? range.get<double>() : 0.0;
      if (r >= number(scan, "range_min") && r < number(scan, "range_max")) {
        picture.returns.push_back(
            {here.at.x + r * std::cos(angle), here.at.y + r * std::sin(angle)});
      }
      angle += number(scan, "angle_increment");
    }
  }
  void follow_path(const Json& path) {
    picture.path.clear();
    for (const Json& point : list_in(path, "points")) {
      if (const auto place = place_of(point)) picture.path.push_back(*place);
    }
  }

  std::string pose_;
  std::string scan_;
  std::string path_;
  std::string goal_;
  std::string mode_;
  std::string now_;
  std::optional<Place> seen_from_;
};

double length_of(const std::vector<MapPicture::Step>& way) {
  double length = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    length += std::hypot(way[i].at.x - way[i - 1].at.x, way[i].at.y - way[i - 1].at.y);
  }
  return length;
}

/// "4.2 m of way": a robot that stood is not seen in a picture.
std::string in_words(const std::vector<MapPicture::Step>& way) {
  char text[40];
  std::snprintf(text, sizeof text, "%.1f m of way", length_of(way));
  return text;
}

/// The value behind an option, null when it is not given.
std::variant<Json, Fault> value_of(Session& session, std::string_view option) {
  if (!session.arguments.has(option)) return Json();
  auto answer = session.call("param.get", {{"address", session.arguments.one(option)}});
  if (const auto* fault = std::get_if<Fault>(&answer)) return *fault;
  return std::get<Json>(answer).value("value", Json());
}

}  // namespace

int run_map(Session& session) {
  if (const auto refused = refused_output(session, kPictureOutput)) return session.fail(*refused);
  Drawing drawing(session.arguments);
  auto grid = value_of(session, "--grid");
  if (const auto* fault = std::get_if<Fault>(&grid)) return session.fail(*fault);
  drawing.picture.grid = std::get<Json>(std::move(grid));
  const auto discs = value_of(session, "--discs");
  if (const auto* fault = std::get_if<Fault>(&discs)) return session.fail(*fault);
  for (const Json& disc : std::get<Json>(discs)) {
    const auto at = place_of(disc.is_object() ? disc.value("at", Json()) : Json());
    if (at) drawing.picture.discs.push_back({*at, number(disc, "radius")});
  }
  const auto fault =
      follow(session, drawing.addresses(), [&](const Sample& sample) { drawing.take(sample); });
  if (drawing.picture.way.empty()) {
    return session.fail(fault.value_or(
        protocol::wrong_use("usage_nothing_to_draw", "it never had a place with x and y",
                            session.arguments.one("POSE"), "example: mauvectl map pose.read")));
  }
  const auto& way = drawing.picture.way;
  const int written = write_output(session, kPictureOutput, draw_map(drawing.picture),
                                   "drew " + counted(way.size(), "place") + ", " + in_words(way),
                                   {{"places", way.size()}, {"length_m", length_of(way)}});
  return fault ? session.fail(*fault) : written;  // the values before the daemon went are drawn
}

}  // namespace mauve::ctl
