// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/duration.h"

#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace mauve {
namespace {

struct Unit {
  std::string_view name;
  std::uint64_t nanoseconds;
};
constexpr std::array<Unit, 6> kTimeUnits{{{"h", 3'600'000'000'000},
                                          {"min", 60'000'000'000},
                                          {"s", 1'000'000'000},
                                          {"ms", 1'000'000},
                                          {"us", 1'000},
                                          {"ns", 1}}};
constexpr std::uint64_t kLongestTime = std::numeric_limits<std::int64_t>::max();
constexpr std::string_view kHint =
    "write a number and a unit, such as \"10ms\" (ns, us, ms, s, min, h)";

std::string_view take_digits(std::string_view& rest) {
  std::size_t count = 0;
  while (count < rest.size() && rest[count] >= '0' && rest[count] <= '9') ++count;
  const std::string_view digits = rest.substr(0, count);
  rest.remove_prefix(count);
  return digits;
}

// Value of the digits times scale; nothing if it does not fit.
std::optional<std::uint64_t> scaled(std::string_view digits, std::uint64_t scale) {
  std::uint64_t value = 0;
  for (const char c : digits) {
    if (value > kLongestTime / 10) return std::nullopt;
    value = value * 10 + static_cast<std::uint64_t>(c - '0');
  }
  if (value > kLongestTime / scale) return std::nullopt;
  return value * scale;
}

// Nanoseconds of the digits behind the point; nothing if they are not a whole number.
std::optional<std::uint64_t> fraction(std::string_view digits, std::uint64_t scale) {
  while (!digits.empty() && digits.back() == '0') digits.remove_suffix(1);
  if (digits.size() > 18) return std::nullopt;
  std::uint64_t value = 0;
  std::uint64_t divisor = 1;
  for (const char c : digits) {
    value = value * 10 + static_cast<std::uint64_t>(c - '0');
    divisor *= 10;
  }
  const std::uint64_t common = std::gcd(scale, divisor);
  divisor /= common;
  if (value % divisor != 0) return std::nullopt;
  return value / divisor * (scale / common);
}

Error no_duration(std::string_view text, std::string_view why) {
  std::string message = "\"";
  message.append(text.substr(0, 40)).append("\" ").append(why);
  return refuse({Errc::invalid_value, "not_a_duration"}, "", std::move(message),
                std::string(kHint));
}

const Unit* find_unit(std::string_view name) {
  for (const Unit& unit : kTimeUnits) {
    if (unit.name == name) return &unit;
  }
  return nullptr;
}

// "1.5ms" for 1'500'000 in milliseconds; empty where the unit would need a leading zero.
std::string in_unit(std::uint64_t value, const Unit& unit) {
  const std::uint64_t whole = value / unit.nanoseconds;
  std::uint64_t rest = value % unit.nanoseconds;
  if (whole == 0) return {};
  std::string text = std::to_string(whole);
  if (rest != 0) {
    const bool decimal = unit.nanoseconds <= 1'000'000'000;
    if (!decimal) return {};
    text += '.';
    for (std::uint64_t weight = unit.nanoseconds / 10; rest != 0; weight /= 10) {
      text += static_cast<char>('0' + rest / weight);
      rest %= weight;
    }
  }
  return text.append(unit.name);
}

}  // namespace

Result<std::chrono::nanoseconds> parse_duration(std::string_view text) {
  std::string_view rest = text;
  if (rest.starts_with('-')) return no_duration(text, "is negative");
  const std::string_view whole = take_digits(rest);
  std::string_view decimals;
  bool complete = !whole.empty();
  if (rest.starts_with('.')) {
    rest.remove_prefix(1);
    decimals = take_digits(rest);
    complete = complete && !decimals.empty();
  }
  if (!complete) return no_duration(text, "is not a duration");
  if (rest.empty()) return no_duration(text, "has no unit");
  const Unit* unit = find_unit(rest);
  if (unit == nullptr) return no_duration(text, "has an unknown unit");

  const auto high = scaled(whole, unit->nanoseconds);
  if (!high) return no_duration(text, "is too long");
  const auto low = fraction(decimals, unit->nanoseconds);
  if (!low) return no_duration(text, "is not a whole number of nanoseconds");
  if (*low > kLongestTime - *high) return no_duration(text, "is too long");
  return std::chrono::nanoseconds(static_cast<std::int64_t>(*high + *low));
}

std::string format_duration(std::chrono::nanoseconds value) {
  if (value.count() == 0) return "0s";
  const bool negative = value.count() < 0;
  const auto bits = static_cast<std::uint64_t>(value.count());
  const std::uint64_t size = negative ? 0 - bits : bits;
  std::string best;
  for (const Unit& unit : kTimeUnits) {
    std::string text = in_unit(size, unit);
    if (!text.empty() && (best.empty() || text.size() < best.size())) best = std::move(text);
  }
  return negative ? "-" + best : best;
}

}  // namespace mauve
