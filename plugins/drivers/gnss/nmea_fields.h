// SPDX-License-Identifier: LGPL-3.0-or-later
/// The fields of an NMEA sentence, and the numbers, times and angles in them. All of it is [rt].
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace drivers {

/// The comma-separated fields of a sentence without the blanks around them; field 0 is the address.
/// Beyond the capacity they are cut.
class Fields {
 public:
  explicit Fields(std::string_view frame);

  [[nodiscard]] std::string_view operator[](std::size_t i) const {
    return i < size_ ? text_[i] : std::string_view();
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::array<std::string_view, 32> text_{};
  std::size_t size_ = 0;
};

/// Plain decimal: digits, at most one dot, perhaps a sign. No exponent, no "inf".
[[nodiscard]] std::optional<double> number(std::string_view text);
/// An optional number: empty is `otherwise`, nonsense is nothing.
[[nodiscard]] std::optional<double> number_or(std::string_view text, double otherwise);
/// "dddmm.mmmm" with its hemisphere: degrees, or nothing when it cannot be. A sender that rounds
/// may say 60 minutes.
[[nodiscard]] std::optional<double> angle(std::string_view text, std::string_view side,
                                          std::string_view sides, double largest);
/// "hhmmss.ss": seconds of the day; empty is 0.
[[nodiscard]] std::optional<double> time_of_day(std::string_view text);
/// Degrees that the last digit of "dddmm.mmmm" stands for.
[[nodiscard]] double grain_of(std::string_view text);

}  // namespace drivers
