// SPDX-License-Identifier: LGPL-3.0-or-later
/// concat(): a text from texts and whole numbers, with one allocation and little machine code
/// (decision 37).
#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <initializer_list>
#include <string>
#include <string_view>

namespace mauve {

/// A letter or a truth value is rarely meant as a number.
template <typename T>
concept WholeNumber = std::integral<T> && !std::same_as<T, bool> && !std::same_as<T, char>;

/// One part of such a text: a reference to the argument, valid during the call.
class TextPart {
 public:
  TextPart(const char* text) : text_(text) {}
  TextPart(std::string_view text) : text_(text) {}
  TextPart(const std::string& text) : text_(text) {}
  template <WholeNumber T>
  TextPart(T number) {
    const auto end = std::to_chars(digits_.data(), digits_.data() + digits_.size(), number).ptr;
    text_ = {digits_.data(), end};
  }
  TextPart(const TextPart&) = delete;
  TextPart& operator=(const TextPart&) = delete;
  [[nodiscard]] std::string_view text() const { return text_; }

 private:
  std::array<char, 20> digits_;  // the longest number of 64 bits, with its sign
  std::string_view text_;
};

/// concat({"n", 3, ":", port}) is "n3:p", where the text `port` is "p". [any], not in a job
[[nodiscard]] std::string concat(std::initializer_list<TextPart> parts);

}  // namespace mauve
