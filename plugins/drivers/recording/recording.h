// SPDX-License-Identifier: LGPL-3.0-or-later
/// A laser recording, loaded whole so that replaying it needs no file.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/result.h>

#include "../../types/scan.h"

namespace drivers {

/// Scans of a Hokuyo URG-04LX, one a line of numbers: column 1 the time in microseconds, columns 25
/// to 706 the 682 ranges in millimetres over 240 degrees. Below 20 mm is an error code, and the
/// first and last 70 beams look at the robot itself.
class Recording {
 public:
  static constexpr std::size_t kBeams = 682;
  static constexpr std::size_t kFirstColumn = 24;
  static constexpr std::size_t kUnusable = 70;

  /// Reads the file. An error names the line and the problem. [factory]
  [[nodiscard]] static mauve::Result<Recording> load(const std::string& path);
  /// The same from text; `name` stands for the file in errors.
  [[nodiscard]] static mauve::Result<Recording> parse(std::string_view text,
                                                      const std::string& name);

  [[nodiscard]] std::size_t size() const { return times_.size(); }
  /// Fills `scan` with number `index` of the recording. [rt]
  void show(std::size_t index, rover::LaserScan& scan) const;

 private:
  std::vector<double> times_;  // s since the first scan
  std::vector<float> ranges_;  // kBeams for each scan
};

}  // namespace drivers
