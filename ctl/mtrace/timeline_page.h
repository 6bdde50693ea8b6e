// SPDX-License-Identifier: LGPL-3.0-or-later
/// The surroundings of the rows of a timeline: axis, colours, legend, title, notes.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mtrace/scene.h"
#include "picture/svg.h"

namespace mauve::ctl::mtrace {

/// Of the fonts, in pixels, as the page's style has them.
inline constexpr double kLabelSize = 11.0;
inline constexpr double kSmallSize = 10.5;

/// The signs that the legend explains, where they occur.
enum class Sign : std::uint8_t {
  release,
  job,
  many,
  preempted,
  blocked,
  held,
  deadline,
  overrun,
  missed,
  fault,
  user,
  stopped,
  applied,
  prepare,
  commit,
  rollback,
  aborted,
  disturbed
};

class Page {
 public:
  static constexpr double kWidth = 1280.0;
  static constexpr double kLeft = 176.0;
  static constexpr double kInner = kWidth - kLeft - 24.0;

  Page(const Trace& trace, const Scene& scene, double top_of_rows, double bottom_of_rows);

  const double left = kLeft;
  const double right = kLeft + kInner;
  const double top;
  const double bottom;
  Svg svg;

  [[nodiscard]] double x(std::int64_t time) const;
  [[nodiscard]] bool shows(std::int64_t time) const { return time >= from_ && time <= to_; }
  void occurs(Sign sign) { occurring_[static_cast<std::size_t>(sign)] = true; }
  /// The class of a state's boxes; equal names have equal colours.
  [[nodiscard]] std::string colour_of(Word state);

  void draw_axis();
  /// The base line of a row, with its name and further words.
  void draw_baseline(double y, std::string_view name, std::string_view more);
  /// Adds title, legend and notes, and the frame of a file.
  [[nodiscard]] std::string file(const std::string& title,
                                 const std::vector<std::string>& left_out);

 private:
  static constexpr std::size_t kSigns = static_cast<std::size_t>(Sign::disturbed) + 1;

  double draw_legend(double y);

  const Trace& trace_;
  std::int64_t from_;
  std::int64_t to_;
  std::array<bool, kSigns> occurring_{};
  std::map<Word, std::size_t> colours_;
  std::vector<Word> states_;  // as they came
};

}  // namespace mauve::ctl::mtrace
