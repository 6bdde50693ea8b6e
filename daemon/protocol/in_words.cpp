// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/in_words.h"

#include <array>
#include <cstdio>

namespace mauve::protocol {

namespace {

std::string members_in_words(const Json& value) {
  std::string text;
  for (const auto& [key, member] : value.items()) {
    text += (text.empty() ? "" : ", ") + (value.is_object() ? key + ": " : "") + in_words(member);
  }
  return text;
}

/// Enough for people and for a millimetre on the globe; JSON is exact.
std::string ten_digits(double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.10g", value);
  return text.data();
}

std::string member_of(const Json& line, const char* key) {
  const auto found = line.find(key);
  return found == line.end() ? std::string() : in_words(*found);
}

}  // namespace

std::string in_words(const Json& value) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_object()) return "{" + members_in_words(value) + "}";
  if (value.is_array()) return "[" + members_in_words(value) + "]";
  if (value.is_number_float()) return ten_digits(value.get<double>());
  return to_line(value);
}

std::string line_in_words(const Json& line) {
  if (!line.is_object()) return {};
  const std::string op = member_of(line, "op");
  const std::string kind = member_of(line, "kind");
  const bool element = kind == "component" || kind == "resource";
  // The kind stands before an address that does not show it.
  const std::string subject =
      (element || kind == "plugin" ? kind + " " : "") + member_of(line, "address");
  if (op == "change") {
    const std::string before = member_of(line, "old");
    const std::string after = member_of(line, "new");
    const bool anew = kind == "core" && before == after;
    return "~ " + subject + ": " + (anew ? after + ", made anew" : before + " -> " + after);
  }
  const bool added = op == "add";
  const std::string text = (added ? "+ " : "- ") + subject;
  const std::string content = member_of(line, added ? "new" : "old");
  if (element) return text + " (" + content + ")";
  return kind == "plugin" ? text : text + ": " + content;
}

std::string lines_in_words(const Json& lines, std::size_t most) {
  std::string text;
  if (!lines.is_array()) return text;
  for (std::size_t i = 0; i < lines.size() && i < most; ++i) {
    text += (i == 0 ? "" : "; ") + line_in_words(lines[i]);
  }
  if (lines.size() > most) text += "; and " + std::to_string(lines.size() - most) + " more";
  return text;
}

}  // namespace mauve::protocol
