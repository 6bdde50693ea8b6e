// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/log_time.h"

#include <array>
#include <cctype>
#include <cstdio>
#include <ctime>

#include "base/duration.h"

namespace mauve::ctl {
namespace {

using std::chrono::system_clock;

std::string utc(system_clock::time_point time) {
  const std::time_t seconds = system_clock::to_time_t(time);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

/// Two digits each, "12:30" or "12:30:05".
std::optional<std::tm> clock_time(std::string_view text) {
  const std::string whole = text.size() == 5 ? std::string(text) + ":00" : std::string(text);
  if (whole.size() != 8) return std::nullopt;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const bool colon = i == 2 || i == 5;
    const bool digit = std::isdigit(static_cast<unsigned char>(whole[i])) != 0;
    if (colon ? whole[i] != ':' : !digit) return std::nullopt;
  }
  std::tm time{};
  time.tm_hour = std::stoi(whole.substr(0, 2));
  time.tm_min = std::stoi(whole.substr(3, 2));
  time.tm_sec = std::stoi(whole.substr(6, 2));
  if (time.tm_hour > 23 || time.tm_min > 59 || time.tm_sec > 59) return std::nullopt;
  return time;
}

/// The last time that clocks here showed this.
system_clock::time_point last_time(const std::tm& clock, system_clock::time_point now) {
  const std::time_t seconds = system_clock::to_time_t(now);
  std::tm day{};
  localtime_r(&seconds, &day);
  day.tm_hour = clock.tm_hour;
  day.tm_min = clock.tm_min;
  day.tm_sec = clock.tm_sec;
  day.tm_isdst = -1;
  if (const auto today = system_clock::from_time_t(std::mktime(&day)); today <= now) return today;
  --day.tm_mday;
  day.tm_isdst = -1;
  return system_clock::from_time_t(std::mktime(&day));
}

}  // namespace

std::optional<std::string> since_when(std::string_view text, system_clock::time_point now) {
  if (const auto length = parse_duration(text)) {
    const auto ago = std::chrono::duration_cast<system_clock::duration>(*length);
    if (ago.count() < 0) return std::nullopt;
    return utc(now - ago);
  }
  if (const auto clock = clock_time(text)) return utc(last_time(*clock, now));
  const bool whole = text.size() >= 10 && text[4] == '-' && text[7] == '-';
  return whole ? std::optional(std::string(text)) : std::nullopt;
}

}  // namespace mauve::ctl
