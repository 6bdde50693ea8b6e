// SPDX-License-Identifier: LGPL-3.0-or-later
#include "nmea_fields.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

namespace drivers {
namespace {

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

}  // namespace

Fields::Fields(std::string_view frame) {
  while (size_ < text_.size()) {
    const std::size_t comma = frame.find(',');
    text_[size_++] = without_blanks(frame.substr(0, comma));
    if (comma == std::string_view::npos) break;
    frame.remove_prefix(comma + 1);
  }
}

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return {};
  }
  const auto plain = [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; };
  if (!std::all_of(text.begin(), text.end(), plain)) return {};
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

std::optional<double> number_or(std::string_view text, double otherwise) {
  return text.empty() ? otherwise : number(text);
}

std::optional<double> angle(std::string_view text, std::string_view side, std::string_view sides,
                            double largest) {
  const std::optional<double> packed = number(text);
  if (!packed || side.size() != 1 || sides.find(side) == std::string_view::npos) return {};
  const double degrees = std::floor(*packed / 100.0);
  const double minutes = *packed - 100.0 * degrees;
  const double angle = degrees + minutes / 60.0;
  if (*packed < 0.0 || minutes > 60.0 || angle > largest) return {};
  return side[0] == sides[0] ? angle : -angle;
}

std::optional<double> time_of_day(std::string_view text) {
  const std::optional<double> packed = number_or(text, 0.0);
  if (!packed || *packed < 0.0 || *packed >= 240000.0) return {};
  const double hours = std::floor(*packed / 10000.0);
  const double minutes = std::floor(std::fmod(*packed, 10000.0) / 100.0);
  const double seconds = std::fmod(*packed, 100.0);
  if (minutes >= 60.0 || seconds >= 61.0) return {};
  return hours * 3600.0 + minutes * 60.0 + seconds;
}

double grain_of(std::string_view text) {
  const std::size_t dot = text.find('.');
  const std::size_t decimals = dot == std::string_view::npos ? 0 : text.size() - dot - 1;
  return std::pow(10.0, -static_cast<double>(decimals)) / 60.0;
}

}  // namespace drivers
