// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/text/json_hint.h"

#include <algorithm>
#include <cctype>

namespace mauve::arch {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

/// Where the token begins whose last character the parser has read: a string with its quotes, a
/// word, or one character.
std::size_t begin_of_token(std::string_view text, std::size_t last) {
  if (text[last] == '"') {
    for (std::size_t at = last; at-- > 0;) {
      if (text[at] == '\n') break;
      if (text[at] == '"' && (at == 0 || text[at - 1] != '\\')) return at;
    }
    return last;
  }
  constexpr std::string_view kEndsWord = " \t\r\n,:[]{}\"";
  const std::size_t before = text.find_last_of(kEndsWord, last);
  return before == std::string_view::npos ? 0 : std::min(before + 1, last);
}

/// The last character before the token that is no space; the line feed at the begin of the text.
char before_token(std::string_view text, std::size_t begin) {
  const std::size_t at =
      begin == 0 ? std::string_view::npos : text.find_last_not_of(kSpace, begin - 1);
  return at == std::string_view::npos ? '\n' : text[at];
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

constexpr const char* kCommaBefore = "remove the comma before it: none stands behind the last item";

std::string hint_of_closing(std::string_view text, std::size_t last) {
  return before_token(text, last) == ',' ? kCommaBefore
                                         : "write the value that is missing before it";
}

}  // namespace

std::string json_hint(std::string_view message, std::string_view text, std::size_t last) {
  if (contains(message, "unexpected end of input")) {
    return text.find_first_not_of(kSpace) == std::string_view::npos
               ? "the file is empty"
               : "a closing } or ] is missing, or the file was cut off";
  }
  if (contains(message, "missing closing quote") || contains(message, "control character")) {
    return "a string ends in the line in which it begins: a closing \" is missing";
  }
  if (text.empty()) return {};
  last = std::min(last, text.size() - 1);
  if (contains(message, "unexpected ']'") || contains(message, "unexpected '}'")) {
    if (contains(message, "parsing object key")) return kCommaBefore;
    if (contains(message, "parsing value")) return hint_of_closing(text, last);
    return contains(message, "unexpected ']'") ? "a { is closed by }" : "a [ is closed by ]";
  }
  const char first = text[begin_of_token(text, last)];
  if (first == '\'') return "strings and keys stand in double quotes: \"...\"";
  if (contains(message, "parsing object key")) return "keys stand in double quotes: \"name\": ...";
  if (contains(message, "parsing object separator")) return "write a colon between key and value";
  if (contains(message, "invalid literal") &&
      std::isdigit(static_cast<unsigned char>(first)) != 0) {
    return "text with a unit stands in double quotes: \"10ms\"";
  }
  if (contains(message, "expected '}'") || contains(message, "expected ']'")) {
    return "a comma is missing behind the value before it";
  }
  if (contains(message, "expected end of input")) return "a file holds one value: remove the rest";
  if (contains(message, "invalid literal") &&
      std::isalpha(static_cast<unsigned char>(first)) != 0) {
    return "text stands in double quotes; the words without are true, false and null";
  }
  if (first == '+' || first == '.') return "a number begins with a digit or a minus sign";
  return {};
}

}  // namespace mauve::arch
