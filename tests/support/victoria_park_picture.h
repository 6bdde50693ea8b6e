// SPDX-License-Identifier: LGPL-3.0-or-later
/// A replay of Victoria Park as a picture: positions, where the filter believed the antenna to be,
/// and in outages how far off it admits to be.
#pragma once

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "support/victoria_park.h"

namespace support::park {

class Picture {
 public:
  Picture(const Replay& run, const localization::Parameters& parameters)
      : run_(run), mount_(parameters.antenna) {
    for (const Sample& sample : run.samples) {
      if (sample.rejected || sample.error > 50.0) continue;
      left_ = std::min(left_, sample.fix.x - kMargin);
      right_ = std::max(right_, sample.fix.x + kMargin);
      top_ = std::max(top_, sample.fix.y + kMargin);
      bottom_ = std::min(bottom_, sample.fix.y - kMargin);
    }
  }

  std::string svg() {
    out_ << "<svg xmlns='http://www.w3.org/2000/svg' width='" << (right_ - left_) * kScale
         << "' height='" << (top_ - bottom_) * kScale << "'>\n<rect width='100%' height='100%' "
         << "fill='white'/>\n";
    draw_fixes();
    draw_track();
    draw_ellipses();
    draw_legend();
    out_ << "</svg>\n";
    return out_.str();
  }

 private:
  static constexpr double kMargin = 12.0;  // m
  static constexpr double kScale = 4.0;    // pixels a metre

  double across(double x) const { return (x - left_) * kScale; }
  double down(double y) const { return (top_ - y) * kScale; }

  void dot(const rover::Pose& at, const char* colour, double radius) {
    out_ << "<circle cx='" << across(at.x) << "' cy='" << down(at.y) << "' r='" << radius
         << "' fill='" << colour << "'/>\n";
  }
  void draw_fixes() {
    for (const Sample& sample : run_.samples) {
      if (sample.outage >= 0.0) {
        dot(sample.fix, "#2a2", 2.0);
      } else if (sample.rejected) {
        dot(sample.fix, "#f80", 2.5);
      } else {
        dot(sample.fix, "#bbb", 1.5);
      }
    }
  }
  rover::Point2D antenna(const rover::MotionState& state) const {
    const double cosine = std::cos(state.heading);
    const double sine = std::sin(state.heading);
    return {state.x + cosine * mount_.x - sine * mount_.y,
            state.y + sine * mount_.x + cosine * mount_.y};
  }
  /// Blue, and red where no position came for a second.
  void draw_track() {
    auto fix = run_.samples.begin();
    double last = 0.0;
    for (std::size_t i = 1; i < run_.track.size(); ++i) {
      const rover::MotionState& state = run_.track[i];
      for (; fix != run_.samples.end() && fix->fix.time <= state.time; ++fix) {
        if (fix->outage < 0.0) last = fix->fix.time;
      }
      if (state.variance_heading > 1.0) continue;
      const rover::Point2D from = antenna(run_.track[i - 1]);
      const rover::Point2D to = antenna(state);
      out_ << "<line x1='" << across(from.x) << "' y1='" << down(from.y) << "' x2='" << across(to.x)
           << "' y2='" << down(to.y) << "' stroke='" << (state.time - last > 1.0 ? "#d22" : "#24c")
           << "' stroke-width='1.2'/>\n";
    }
  }
  /// 95 %, every five seconds of an outage.
  void draw_ellipses() {
    double next = 0.0;
    for (const Sample& sample : run_.samples) {
      if (sample.outage < 0.0) next = 5.0;
      if (sample.outage < next) continue;
      next = sample.outage + 5.0;
      const rover::MotionState& s = sample.state;
      const double middle = (s.variance_x + s.variance_y) / 2.0;
      const double half = std::hypot((s.variance_x - s.variance_y) / 2.0, s.covariance_xy);
      const double turn = -std::atan2(2.0 * s.covariance_xy, s.variance_x - s.variance_y) / 2.0;
      const rover::Point2D at = antenna(s);
      out_ << "<ellipse rx='" << std::sqrt(5.991 * (middle + half)) * kScale << "' ry='"
           << std::sqrt(5.991 * std::max(0.0, middle - half)) * kScale << "' transform='translate("
           << across(at.x) << " " << down(at.y) << ") rotate(" << turn * 57.29578
           << ")' fill='#d22' fill-opacity='0.06' stroke='#d22' stroke-width='0.6'/>\n";
      out_ << "<line x1='" << across(at.x) << "' y1='" << down(at.y) << "' x2='"
           << across(sample.fix.x) << "' y2='" << down(sample.fix.y)
           << "' stroke='#080' stroke-width='0.8'/>\n";
    }
  }
  void draw_legend() {
    static constexpr const char* kLines[][2] = {
        {"#999", "positions given to the filter"},
        {"#f80", "positions outside the gate"},
        {"#2a2", "positions withheld"},
        {"#24c", "estimate"},
        {"#d22", "estimate without positions, with its 95 % ellipse"}};
    const double x = (right_ - left_) * kScale * 0.25;
    double y = 24.0;
    for (const auto& line : kLines) {
      out_ << "<text x='" << x << "' y='" << y << "' font-family='sans-serif' font-size='15' fill='"
           << line[0] << "'>" << line[1] << "</text>\n";
      y += 20.0;
    }
    out_ << "<line x1='" << x << "' y1='" << y << "' x2='" << x + 50 * kScale << "' y2='" << y
         << "' stroke='black' stroke-width='2'/><text x='" << x << "' y='" << y + 18
         << "' font-family='sans-serif' font-size='15'>50 m</text>\n";
  }

  const Replay& run_;
  rover::Point2D mount_;
  double left_ = 1e9;
  double right_ = -1e9;
  double top_ = -1e9;
  double bottom_ = 1e9;
  std::ostringstream out_;
};

inline std::string picture(const Replay& run, const localization::Parameters& parameters) {
  return Picture(run, parameters).svg();
}

}  // namespace support::park
