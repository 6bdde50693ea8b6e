// SPDX-License-Identifier: LGPL-3.0-or-later
#include "picture/map_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/concat.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

constexpr double kLongerSide = 1000.0;  // pixels
constexpr double kLegend = 22.0;        // pixels a line of it is high
constexpr double kAir = 0.7;            // m around everything
/// Two deviations along each axis: 86 % lie inside.
constexpr double kDeviations = 2.0;

struct Frame {
  double left = std::numeric_limits<double>::infinity();
  double bottom = std::numeric_limits<double>::infinity();
  double right = -std::numeric_limits<double>::infinity();
  double top = -std::numeric_limits<double>::infinity();
  double scale = 1.0;  // pixels a metre

  void take(const Place& place, double radius = 0.0) {
    if (!std::isfinite(place.x) || !std::isfinite(place.y)) return;
    left = std::min(left, place.x - radius);
    right = std::max(right, place.x + radius);
    bottom = std::min(bottom, place.y - radius);
    top = std::max(top, place.y + radius);
  }
  void fit() {
    if (left > right) *this = {0.0, 0.0, 1.0, 1.0};
    left -= kAir;
    bottom -= kAir;
    right += kAir;
    top += kAir;
    scale = kLongerSide / std::max(right - left, top - bottom);
  }
  [[nodiscard]] double width() const { return (right - left) * scale; }
  [[nodiscard]] double height() const { return (top - bottom) * scale; }
  [[nodiscard]] Place at(const Place& place) const {
    return {(place.x - left) * scale, (top - place.y) * scale};
  }
};

/// The grid's cells in the world; its origin may be turned.
struct Grid {
  explicit Grid(const Json& json)
      : resolution(number(json, "resolution")),
        width(static_cast<long>(number(json, "width"))),
        cells(list_in(json, "cells")) {
    const Json origin = json.is_object() ? json.value("origin", Json()) : Json();
    corner = {number(origin, "x"), number(origin, "y")};
    turn = number(origin, "heading");
    const bool whole = resolution > 0.0 && width > 0 && !cells.empty();
    rows = whole ? static_cast<long>(cells.size()) / width : 0;
  }
  [[nodiscard]] Place at(long column, long row) const {
    const double x = static_cast<double>(column) * resolution;
    const double y = static_cast<double>(row) * resolution;
    return {corner.x + std::cos(turn) * x - std::sin(turn) * y,
            corner.y + std::sin(turn) * x + std::cos(turn) * y};
  }
  [[nodiscard]] int cell(long column, long row) const {
    const Json& value = cells[static_cast<std::size_t>(row * width + column)];
    return value.is_number() ? value.get<int>() : -1;
  }

  double resolution;
  long width;
  const Json& cells;
  Place corner;
  double turn = 0.0;
  long rows = 0;
};

std::string_view fill_of(int cell) {
  if (cell < 0) return "#d8dee4";
  return cell >= 50 ? "#57606a" : "";
}

/// Runs of equal cells as one thick line each: a cell is too small to be distinguished.
void draw_grid(Svg& svg, const Frame& frame, const Grid& grid) {
  const std::string width = concat(
      {"stroke-width=\"", std::to_string(grid.resolution * frame.scale + 0.3), "\" stroke=\""});
  for (long row = 0; row < grid.rows; ++row) {
    for (long from = 0; from < grid.width;) {
      const std::string_view fill = fill_of(grid.cell(from, row));
      long to = from;
      while (to < grid.width && fill_of(grid.cell(to, row)) == fill) ++to;
      if (!fill.empty()) {
        const Place a = grid.at(from, row);
        const Place b = grid.at(to, row);
        const Place up = grid.at(from, row + 1);
        const Place half{(up.x - a.x) / 2, (up.y - a.y) / 2};
        svg.line(frame.at({a.x + half.x, a.y + half.y}), frame.at({b.x + half.x, b.y + half.y}),
                 concat({width, fill, "\""}));
      }
      from = to;
    }
  }
}

std::vector<std::string> modes_of(const std::vector<MapPicture::Step>& way) {
  std::vector<std::string> modes;
  for (const auto& step : way) {
    if (std::find(modes.begin(), modes.end(), step.mode) == modes.end()) modes.push_back(step.mode);
  }
  return modes;
}

std::string colour_of(const std::vector<std::string>& modes, const std::string& mode) {
  const auto found = std::find(modes.begin(), modes.end(), mode);
  return std::string(line_colour(static_cast<std::size_t>(found - modes.begin())));
}

/// Neighbouring pieces share a place.
void draw_way(Svg& svg, const Frame& frame, const std::vector<MapPicture::Step>& way,
              const std::vector<std::string>& modes) {
  for (std::size_t from = 0; from < way.size();) {
    std::vector<Place> piece;
    if (from > 0) piece.push_back(frame.at(way[from - 1].at));
    std::size_t to = from;
    for (; to < way.size() && way[to].mode == way[from].mode; ++to) {
      piece.push_back(frame.at(way[to].at));
    }
    svg.polyline(piece, concat({"stroke-width=\"3\" stroke-linejoin=\"round\" stroke=\"",
                                colour_of(modes, way[from].mode), "\""}));
    from = to;
  }
}

/// The axes of the covariance: eigenvectors of a symmetric 2 x 2 matrix.
void draw_ellipse(Svg& svg, const Frame& frame, const MapPicture::Step& step) {
  const double mean = (step.variance_x + step.variance_y) / 2.0;
  const double half = (step.variance_x - step.variance_y) / 2.0;
  const double spread = std::hypot(half, step.covariance);
  const double longest = kDeviations * std::sqrt(std::max(0.0, mean + spread));
  if (!(longest > 0.0 && longest < (frame.right - frame.left) / 2)) return;  // else it hides all
  const double angle = 0.5 * std::atan2(step.covariance, half);
  const double pixels = kDeviations * frame.scale;
  svg.ellipse(frame.at(step.at),
              {pixels * std::sqrt(mean + spread), pixels * std::sqrt(std::max(0.0, mean - spread))},
              -angle * 180.0 / std::numbers::pi,
              "fill=\"#8250df\" fill-opacity=\"0.08\" stroke=\"#8250df\" stroke-opacity=\"0.5\"");
}

void draw_robot(Svg& svg, const Frame& frame, const MapPicture::Step& step) {
  const Place centre = frame.at(step.at);
  svg.circle(centre, 7, "fill=\"white\" stroke=\"black\" stroke-width=\"2\"", "here it is");
  svg.line(centre, {centre.x + 12 * std::cos(step.heading), centre.y - 12 * std::sin(step.heading)},
           "stroke=\"black\" stroke-width=\"2\"");
}

Frame frame_of(const MapPicture& picture, const Grid& grid) {
  Frame frame;
  for (const auto& step : picture.way) frame.take(step.at);
  for (const Place& place : picture.returns) frame.take(place);
  for (const Place& place : picture.path) frame.take(place);
  for (const auto& disc : picture.discs) frame.take(disc.at, disc.radius);
  if (picture.goal) frame.take(*picture.goal);
  if (grid.rows > 0) {
    for (const long column : {0L, grid.width}) {
      for (const long row : {0L, grid.rows}) frame.take(grid.at(column, row));
    }
  }
  frame.fit();
  return frame;
}

void draw_legend(Svg& svg, const Frame& frame, const std::vector<std::string>& modes) {
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const double y = frame.height() + kLegend * (static_cast<double>(i) + 0.7);
    svg.line({12, y - 4}, {44, y - 4},
             concat({"stroke-width=\"4\" stroke=\"", colour_of(modes, modes[i]), "\""}));
    svg.text({52, y}, modes[i].empty() ? "the way driven" : modes[i]);
  }
  const double metre = nice_step(frame.right - frame.left, 8);
  const Place right{frame.width() - 16, frame.height() + kLegend * 0.7};
  const double length = metre * frame.scale;
  svg.line({right.x - length, right.y - 4}, {right.x, right.y - 4},
           "stroke=\"black\" stroke-width=\"2\"");
  svg.text({right.x - length - 8, right.y}, compact(Json(metre)) + " m", "text-anchor=\"end\"");
}

}  // namespace

std::string draw_map(const MapPicture& picture) {
  const Grid grid(picture.grid);
  const Frame frame = frame_of(picture, grid);
  const std::vector<std::string> modes = modes_of(picture.way);
  const double lines = std::max<double>(1.0, static_cast<double>(modes.size()));
  Svg svg(frame.width(), frame.height() + kLegend * lines + 8.0);
  draw_grid(svg, frame, grid);
  for (const auto& disc : picture.discs) {
    svg.circle(frame.at(disc.at), disc.radius * frame.scale, "fill=\"#8c959f\"", "obstacle");
  }
  for (const Place& place : picture.returns) svg.circle(frame.at(place), 1.2, "fill=\"#d1242f\"");
  std::vector<Place> path;
  for (const Place& place : picture.path) path.push_back(frame.at(place));
  svg.polyline(path, "stroke=\"#57606a\" stroke-width=\"1.5\" stroke-dasharray=\"6 5\"");
  const std::size_t between = std::max<std::size_t>(1, picture.way.size() / 25);
  for (std::size_t i = 0; i < picture.way.size(); i += between) {
    draw_ellipse(svg, frame, picture.way[i]);
  }
  draw_way(svg, frame, picture.way, modes);
  if (!picture.way.empty()) {
    svg.circle(frame.at(picture.way.front().at), 5, "fill=\"black\"", "start");
    draw_robot(svg, frame, picture.way.back());
  }
  if (picture.goal) {
    svg.circle(frame.at(*picture.goal), 9, "fill=\"none\" stroke=\"black\" stroke-width=\"3\"",
               "goal");
  }
  draw_legend(svg, frame, modes);
  return svg.file();
}

}  // namespace mauve::ctl
