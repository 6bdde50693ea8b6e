// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/json_text.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "base/terminal_text.h"

namespace mauve::logging {

namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

bool continues(std::string_view text, std::size_t count) {
  if (text.size() <= count) {
    return false;
  }
  for (std::size_t i = 1; i <= count; ++i) {
    if ((static_cast<std::uint8_t>(text[i]) & 0xC0U) != 0x80U) {
      return false;
    }
  }
  return true;
}

/// Length of the well-formed UTF-8 sequence at the start of `text`, 0 if there is none: overlong
/// forms, surrogates and values beyond U+10FFFF are not well-formed (Unicode, table 3-7).
std::size_t utf8_length(std::string_view text) {
  const auto first = static_cast<std::uint8_t>(text[0]);
  const auto second = text.size() > 1 ? static_cast<std::uint8_t>(text[1]) : std::uint8_t{0};
  if (first < 0x80) {
    return 1;
  }
  if (first >= 0xC2 && first <= 0xDF) {
    return continues(text, 1) ? 2 : 0;
  }
  if (first >= 0xE0 && first <= 0xEF) {
    const bool overlong = first == 0xE0 && second < 0xA0;
    const bool surrogate = first == 0xED && second >= 0xA0;
    return !overlong && !surrogate && continues(text, 2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const bool overlong = first == 0xF0 && second < 0x90;
    const bool beyond = first == 0xF4 && second >= 0x90;
    return !overlong && !beyond && continues(text, 3) ? 4 : 0;
  }
  return 0;
}

std::string escaped(char c) {
  switch (c) {
    case '"':
      return "\\\"";
    case '\\':
      return "\\\\";
    case '\n':
      return "\\n";
    case '\t':
      return "\\t";
    default:
      return fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<std::uint8_t>(c)));
  }
}

bool must_escape(char c) {
  return c == '"' || c == '\\' || static_cast<std::uint8_t>(c) < 0x20 || c == 0x7F;
}

std::string escaped_sequence(std::string_view sequence) {
  if (sequence.size() == 1) {
    return escaped(sequence[0]);
  }
  std::string out;
  for (const char byte : sequence) {
    out += fmt::format("\\x{:02x}", static_cast<unsigned>(static_cast<std::uint8_t>(byte)));
  }
  return out;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto length = utf8_length(text);
    const auto sequence = text.substr(0, std::max<std::size_t>(length, 1));
    if (length == 0) {
      out += kReplacement;
    } else if (terminal_command(sequence) > 0) {
      out += escaped_sequence(sequence);
    } else {
      out += sequence;
    }
    text.remove_prefix(sequence.size());
  }
  return out;
}

std::string json_string(std::string_view text) {
  std::string out = "\"";
  while (!text.empty()) {
    const auto length = utf8_length(text);
    if (length == 0) {
      out += kReplacement;
    } else if (length == 1 && must_escape(text[0])) {
      out += escaped(text[0]);
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  out += '"';
  return json_for_terminals(std::move(out));
}

}  // namespace mauve::logging
