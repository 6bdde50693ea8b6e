// SPDX-License-Identifier: LGPL-3.0-or-later
/// gpsd's reading of a recorded receiver (its .chk files), epoch by epoch.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace support {

/// What gpsd reported between one GGA sentence and the next.
struct GpsdReport {
  int mode = 0;
  std::optional<double> latitude;
  std::optional<double> longitude;
  std::optional<double> altitude;  ///< above mean sea level
};

/// One epoch: a GGA sentence and the reports that followed it, perhaps none.
struct GpsdEpoch {
  std::string gga;
  std::vector<GpsdReport> reports;
};

inline std::vector<GpsdEpoch> gpsd_epochs(const std::filesystem::path& check) {
  std::vector<GpsdEpoch> epochs;
  std::ifstream file(check);
  const auto number = [](const nlohmann::json& json, const char* name) {
    return json.contains(name) ? std::optional<double>(json.at(name)) : std::nullopt;
  };
  for (std::string line; std::getline(file, line);) {
    if (line.size() > 6 && line[0] == '$' && line.compare(3, 3, "GGA") == 0) {
      epochs.push_back({line, {}});
    } else if (!epochs.empty() && line.find("\"class\":\"TPV\"") != std::string::npos) {
      const auto json = nlohmann::json::parse(line);
      epochs.back().reports.push_back({json.value("mode", 0), number(json, "lat"),
                                       number(json, "lon"), number(json, "altMSL")});
    }
  }
  return epochs;
}

}  // namespace support
