// SPDX-License-Identifier: LGPL-3.0-or-later
/// The dotted addresses that name everything: "control", "control.core.gain", "scan.read".
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mauve/result.h"

namespace mauve {

inline constexpr std::size_t kLongestName = 64;
inline constexpr std::size_t kLongestAddress = 255;

/// True for ^[a-z][a-z0-9_]{0,63}$: the form of the name of every element, port, property and
/// state. [any]
[[nodiscard]] bool is_name(std::string_view text);

/// True for a name, or two names with one slash between them: "shared_data", "drivers/laser_sim".
[[nodiscard]] bool is_type_name(std::string_view text);

/// True for a name (or type name), a slash and a revision: "laser_scan/1", "guidance/core/1".
[[nodiscard]] bool is_revised_name(std::string_view text);

/// Refuses what is_name() refuses and states the form of a name; `at` of the error is `at`.
[[nodiscard]] Status check_name(std::string_view text, std::string_view at);

/// A valid dotted address of one or more names.
class Address {
 public:
  /// Refused: no name, an empty or invalid name, more than 255 characters. [any]
  [[nodiscard]] static Result<Address> parse(std::string_view text);

  [[nodiscard]] std::size_t size() const { return parts_.size(); }
  /// The part at `index`, or an empty text behind the last.
  [[nodiscard]] std::string_view part(std::size_t index) const;
  /// The component or resource: the first name.
  [[nodiscard]] std::string_view element() const { return part(0); }
  /// Everything behind the first name: "core.gain" of "control.core.gain"; may be empty.
  [[nodiscard]] std::string_view rest() const;
  [[nodiscard]] const std::string& text() const { return text_; }

  friend bool operator==(const Address& a, const Address& b) { return a.text_ == b.text_; }

 private:
  std::string text_;
  std::vector<std::size_t> parts_;  // offset of each name in text_
};

}  // namespace mauve
