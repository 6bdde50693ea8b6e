// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/size.h"

#include <array>
#include <charconv>
#include <limits>
#include <utility>

namespace mauve {
namespace {

constexpr std::array<std::pair<std::string_view, std::uint64_t>, 4> kSizeUnits{
    {{"GiB", 1U << 30U}, {"MiB", 1U << 20U}, {"KiB", 1U << 10U}, {"B", 1}}};

Error no_size(std::string_view text, std::string_view why) {
  std::string message = "\"";
  message.append(text.substr(0, 40)).append("\" ").append(why);
  return refuse({Errc::invalid_value, "not_a_size"}, "", std::move(message),
                "write a whole number and a unit, such as \"64KiB\" (B, KiB, MiB, GiB)");
}

}  // namespace

Result<std::uint64_t> parse_size(std::string_view text) {
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, number);
  if (status == std::errc::result_out_of_range) return no_size(text, "is too large");
  if (status != std::errc()) return no_size(text, "is not a size");
  if (stop == end) return no_size(text, "has no unit");
  const std::string_view rest(stop, static_cast<std::size_t>(end - stop));
  for (const auto& [name, factor] : kSizeUnits) {
    if (name != rest) continue;
    if (number > std::numeric_limits<std::uint64_t>::max() / factor) {
      return no_size(text, "is too large");
    }
    return number * factor;
  }
  return no_size(text, "has an unknown unit");
}

std::string format_size(std::uint64_t bytes) {
  for (const auto& [name, factor] : kSizeUnits) {
    if (bytes >= factor && bytes % factor == 0) {
      return std::to_string(bytes / factor).append(name);
    }
  }
  return "0B";
}

}  // namespace mauve
