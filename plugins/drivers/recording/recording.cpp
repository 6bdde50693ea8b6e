// SPDX-License-Identifier: LGPL-3.0-or-later
#include "recording.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <numbers>

#include "../../navigation/regular_file.h"

namespace drivers {
namespace {

using mauve::Errc;
using mauve::refuse;
using mauve::Status;

/// Hours of scans; the same once more in memory while it is read.
constexpr std::size_t kLongestRecording = 256UL * 1024UL * 1024UL;
constexpr float kRangeMin = 0.02F;
constexpr float kRangeMax = 5.6F;
constexpr std::size_t kColumns = Recording::kFirstColumn + Recording::kBeams;
using Row = std::array<long, kColumns>;

/// Integers of one line; a fraction is read and dropped. False when there are too few.
bool read_row(std::string_view line, Row& row) {
  const char* at = line.data();
  const char* const end = at + line.size();
  for (long& number : row) {
    at = std::find_if(at, end, [](char c) { return c != ' ' && c != '\t'; });
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !(value > -1e15 && value < 1e15)) return false;
    number = static_cast<long>(value);
    at = next;
  }
  return true;
}

float metres(long millimetres, std::size_t beam) {
  const bool usable =
      beam >= Recording::kUnusable && beam < Recording::kBeams - Recording::kUnusable;
  return usable && millimetres >= 20 ? static_cast<float>(millimetres) / 1000.0F : 0.0F;
}

}  // namespace

mauve::Result<Recording> Recording::load(const std::string& path) {
  const auto text = navigation::read_regular_file(path, kLongestRecording, "recording");
  if (!text) return text.error();
  return parse(*text, path);
}

mauve::Result<Recording> Recording::parse(std::string_view text, const std::string& name) {
  Recording recording;
  Row row{};
  long first = 0;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view content = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (content.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    if (!read_row(content, row)) {
      return refuse(Errc::invalid_value, {}, name + ":" + std::to_string(line) + ": not a scan",
                    "a line has " + std::to_string(kColumns) + " numbers or more");
    }
    if (recording.times_.empty()) first = row[0];
    recording.times_.push_back(static_cast<double>(row[0] - first) * 1e-6);
    for (std::size_t beam = 0; beam < kBeams; ++beam) {
      recording.ranges_.push_back(metres(row[kFirstColumn + beam], beam));
    }
  }
  if (recording.times_.empty()) return refuse(Errc::invalid_value, {}, name + ": no scan in it");
  return recording;
}

void Recording::show(std::size_t index, rover::LaserScan& scan) const {
  constexpr double kStep = 2.0 * std::numbers::pi / 1024.0;
  scan.time = times_[index];
  scan.angle_increment = static_cast<float>(kStep);
  scan.angle_min = static_cast<float>(-kStep * static_cast<double>(kBeams - 1) / 2.0);
  scan.range_min = kRangeMin;
  scan.range_max = kRangeMax;
  scan.ranges.resize(kBeams);
  std::copy_n(ranges_.data() + index * kBeams, kBeams, scan.ranges.begin());
}

}  // namespace drivers
