// SPDX-License-Identifier: LGPL-3.0-or-later
#include "picture/series_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/concat.h"

namespace mauve::ctl {
namespace {

constexpr double kWidth = 900.0;
constexpr double kLeft = 80.0;
constexpr double kPanel = 220.0;  // pixels a panel is high
constexpr double kBetween = 50.0;
constexpr double kInner = kWidth - kLeft - 20.0;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void take(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Never empty, with some air around.
  [[nodiscard]] Range widened(double share) const {
    if (low > high) return {0.0, 1.0};
    const double air = high > low ? share * (high - low) : std::max(1.0, std::abs(low)) * 0.1;
    return {low - air, high + air};
  }
};

struct Panel {
  double top;
  Range time;
  Range value;

  [[nodiscard]] Place at(const Place& point) const {
    return {kLeft + (point.x - time.low) / (time.high - time.low) * kInner,
            top + (value.high - point.y) / (value.high - value.low) * kPanel};
  }
};

std::string number_text(double value, double step) {
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, std::abs(value) < step / 2 ? 0.0 : value);
  return text.data();
}

void draw_axes(Svg& svg, const Panel& panel) {
  constexpr std::string_view kGrid = "stroke=\"#d8dee4\"";
  const double step = nice_step(panel.value.high - panel.value.low, 5);
  for (double y = std::ceil(panel.value.low / step) * step; y <= panel.value.high; y += step) {
    const Place left = panel.at({panel.time.low, y});
    svg.line(left, {kLeft + kInner, left.y}, kGrid);
    svg.text({kLeft - 8, left.y + 4}, number_text(y, step), "text-anchor=\"end\"");
  }
  const double seconds = nice_step(panel.time.high - panel.time.low, 8);
  for (double x = std::ceil(panel.time.low / seconds) * seconds; x <= panel.time.high;
       x += seconds) {
    const Place top = panel.at({x, panel.value.high});
    svg.line(top, {top.x, panel.top + kPanel}, kGrid);
    svg.text({top.x, panel.top + kPanel + 18}, number_text(x, seconds) + " s",
             "text-anchor=\"middle\"");
  }
  svg.rectangle({kLeft, panel.top}, kInner, kPanel, "fill=\"none\" stroke=\"#57606a\"");
}

/// Cut where values are missing.
void draw_line(Svg& svg, const Panel& panel, const Series& series, std::string_view colour) {
  const std::string attributes = concat({"stroke=\"", colour, "\" stroke-width=\"1.6\""});
  std::vector<Place> piece;
  for (const Place& point : series.points) {
    if (std::isfinite(point.y)) {
      piece.push_back(panel.at(point));
      continue;
    }
    svg.polyline(piece, attributes);
    piece.clear();
  }
  svg.polyline(piece, attributes);
}

void draw_panel(Svg& svg, const Panel& panel, const std::vector<const Series*>& all) {
  draw_axes(svg, panel);
  svg.open_clip({kLeft, panel.top}, kInner, kPanel);
  for (std::size_t i = 0; i < all.size(); ++i) draw_line(svg, panel, *all[i], line_colour(i));
  svg.close_clip();
  double x = kLeft;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string words =
        all[i]->unit.empty() ? all[i]->name : concat({all[i]->name, " [", all[i]->unit, "]"});
    svg.text({x, panel.top - 6}, words, concat({"fill=\"", line_colour(i), "\""}));
    x += 8.0 * static_cast<double>(words.size()) + 16.0;
  }
}

/// In the order in which the units come first.
std::vector<std::vector<const Series*>> by_unit(const std::vector<Series>& all) {
  std::vector<std::vector<const Series*>> panels;
  for (const Series& series : all) {
    const auto same = [&](const auto& panel) { return panel.front()->unit == series.unit; };
    const auto found = std::find_if(panels.begin(), panels.end(), same);
    if (found == panels.end()) {
      panels.push_back({&series});
    } else {
      found->push_back(&series);
    }
  }
  return panels;
}

}  // namespace

std::string draw_series(const std::vector<Series>& all) {
  const auto panels = by_unit(all);
  Range time;
  for (const Series& series : all) {
    for (const Place& point : series.points) time.take(point.x);
  }
  Svg svg(kWidth, kBetween / 2 + static_cast<double>(panels.size()) * (kPanel + kBetween));
  double top = kBetween / 2 + 5.0;
  for (const auto& panel : panels) {
    Range value;
    for (const Series* series : panel) {
      for (const Place& point : series->points) value.take(point.y);
    }
    draw_panel(svg, {top, time.widened(0.0), value.widened(0.06)}, panel);
    top += kPanel + kBetween;
  }
  return svg.file();
}

}  // namespace mauve::ctl
