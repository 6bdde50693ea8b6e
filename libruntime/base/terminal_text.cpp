// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/terminal_text.h"

#include <array>
#include <cstdio>

namespace mauve {
namespace {

unsigned byte_of(char c) { return static_cast<unsigned char>(c); }

/// Of a sequence of two or three bytes.
unsigned code_point(std::string_view sequence) {
  if (sequence.size() == 2)
    return (byte_of(sequence[0]) & 0x1FU) << 6U | (byte_of(sequence[1]) & 0x3FU);
  return (byte_of(sequence[0]) & 0x0FU) << 12U | (byte_of(sequence[1]) & 0x3FU) << 6U |
         (byte_of(sequence[2]) & 0x3FU);
}

bool reorders_or_separates(unsigned code) {
  return code == 0x061C || code == 0x200E || code == 0x200F || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::size_t terminal_command(std::string_view text) {
  if (text.empty()) return 0;
  const unsigned first = byte_of(text[0]);
  if (first < 0x80) return first < 0x20 || first == 0x7F ? 1 : 0;
  if (first == 0xC2 && text.size() > 1) {
    return byte_of(text[1]) >= 0x80 && byte_of(text[1]) < 0xA0 ? 2 : 0;
  }
  if (first == 0xD8 && text.size() > 1)
    return reorders_or_separates(code_point(text.substr(0, 2))) ? 2 : 0;
  if (first == 0xE2 && text.size() > 2)
    return reorders_or_separates(code_point(text.substr(0, 3))) ? 3 : 0;
  return 0;
}

std::string json_for_terminals(std::string json) {
  constexpr std::string_view kBegins = "\x7F\xC2\xD8\xE2";
  for (std::size_t at = 0; (at = json.find_first_of(kBegins, at)) != std::string::npos; ++at) {
    const std::string_view rest = std::string_view(json).substr(at);
    const std::size_t length = terminal_command(rest);
    if (length == 0) continue;
    const unsigned code = length == 1 ? byte_of(rest[0]) : code_point(rest.substr(0, length));
    std::array<char, 8> escape{};
    std::snprintf(escape.data(), escape.size(), "\\u%04x", code);
    json.replace(at, length, escape.data());
  }
  return json;
}

std::string beginning_of(std::string_view text) {
  constexpr std::size_t kLongestShown = 120;
  constexpr std::size_t kBeginning = 60;
  if (text.size() <= kLongestShown) return std::string(text);
  std::size_t end = kBeginning;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return std::string(text.substr(0, end)) + "... (" + std::to_string(text.size()) + " bytes)";
}

}  // namespace mauve
