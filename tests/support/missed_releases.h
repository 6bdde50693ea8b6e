// SPDX-License-Identifier: LGPL-3.0-or-later
/// Missed releases in a trace; disturbed ones are counted separately.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace mauve::test {

struct MissedReleases {
  std::uint64_t missed = 0;
  std::uint64_t disturbed = 0;  ///< more of them, while something foreign held a CPU
  std::int64_t from = 0;        ///< of the trace, ns since T0
};

/// The missed releases in a file that `mauvectl trace dump` wrote, from `since` on, of components
/// whose period is at most `period`.
inline MissedReleases missed_releases(const std::filesystem::path& trace, std::int64_t since,
                                      std::int64_t period) {
  constexpr std::int64_t kAround = 1'000'000;  // the period of the daemon's probe
  struct Missed {
    std::int64_t time;
    std::int64_t count;
  };
  std::vector<Missed> all;
  std::vector<std::pair<std::int64_t, std::int64_t>> windows;
  MissedReleases result;
  std::ifstream lines(trace);
  for (std::string line; std::getline(lines, line);) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (json.is_object() && json.contains("from")) result.from = json["from"];
    if (!json.is_array() || json[0] < since || json.size() < 5) continue;
    const std::int64_t time = json[0];
    const std::int64_t number = json[4];
    if (json[2] == "missed") all.push_back({time, number});
    if (json[2] == "disturbed") windows.emplace_back(time - number - kAround, time + kAround);
  }
  for (const Missed& one : all) {
    const bool touched = std::any_of(windows.begin(), windows.end(), [&](const auto& window) {
      return window.first <= one.time && one.time - (one.count + 1) * period <= window.second;
    });
    (touched ? result.disturbed : result.missed) += static_cast<std::uint64_t>(one.count);
  }
  return result;
}

}  // namespace mauve::test
