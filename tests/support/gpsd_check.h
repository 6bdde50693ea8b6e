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

/// The report of gpsd between one GGA sentence and the next.
struct GpsdReport {
  int mode = 0;
  std::optional<double> latitude;
  std::optional<double> longitude;
  std::optional<double> altitude;  ///< above mean sea level
  std::optional<double> time;      ///< s of the day, UTC
};

/// One epoch: a GGA sentence and the reports that followed it, perhaps none.
struct GpsdEpoch {
  std::string gga;
  std::vector<GpsdReport> reports;
  std::vector<double> dilutions;  ///< horizontal, each time it was reported
  std::optional<int> satellites;  ///< used, when the epoch was complete
};

/// Of "2014-12-31T03:07:19.000Z".
inline std::optional<double> second_of_day(const nlohmann::json& report) {
  if (!report.contains("time")) return std::nullopt;
  const auto text = report.at("time").get<std::string>();
  return std::stod(text.substr(11, 2)) * 3600.0 + std::stod(text.substr(14, 2)) * 60.0 +
         std::stod(text.substr(17));
}

inline std::vector<GpsdEpoch> gpsd_epochs(const std::filesystem::path& check) {
  std::vector<GpsdEpoch> epochs;
  std::ifstream file(check);
  const auto number = [](const nlohmann::json& json, const char* name) {
    return json.contains(name) ? std::optional<double>(json.at(name)) : std::nullopt;
  };
  for (std::string line; std::getline(file, line);) {
    if (line.size() > 6 && line[0] == '$' && line.compare(3, 3, "GGA") == 0) {
      epochs.push_back({line, {}, {}, {}});
    } else if (!epochs.empty() && line.find("\"class\":\"TPV\"") != std::string::npos) {
      const auto json = nlohmann::json::parse(line);
      epochs.back().reports.push_back({json.value("mode", 0), number(json, "lat"),
                                       number(json, "lon"), number(json, "altMSL"),
                                       second_of_day(json)});
    } else if (!epochs.empty() && line.find("\"class\":\"SKY\"") != std::string::npos) {
      const auto json = nlohmann::json::parse(line);
      if (const auto hdop = number(json, "hdop")) epochs.back().dilutions.push_back(*hdop);
      if (json.contains("uSat")) epochs.back().satellites = json.at("uSat").get<int>();
    }
  }
  return epochs;
}

}  // namespace support
