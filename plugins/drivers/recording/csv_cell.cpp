// SPDX-License-Identifier: LGPL-3.0-or-later
#include "csv_cell.h"

#include <charconv>
#include <cstdint>
#include <utility>

namespace drivers {
namespace {

using mauve::Value;

/// The whole text as a number, an integer where it is written as one.
std::optional<Value> number_in(std::string_view text) {
  const char* const end = text.data() + text.size();
  const auto is_whole = [&](auto& whole) {
    const auto [rest, error] = std::from_chars(text.data(), end, whole);
    return error == std::errc() && rest == end;
  };
  if (std::int64_t whole = 0; is_whole(whole)) return whole;
  if (std::uint64_t whole = 0; is_whole(whole)) return whole;
  double real = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), end, real);
  const bool digit_first = text.find_first_of("0123456789") <= 1;  // not "nan", "inf", "-inf"
  if (error != std::errc() || rest != end || !digit_first) return std::nullopt;
  return real;
}

/// Reads the JSON that the client wrote: no white space, no escapes beyond those of quotes.
class JsonReader {
 public:
  explicit JsonReader(std::string_view text) : rest_(text) {}

  std::optional<Value> whole() {
    auto value = read(0);
    return rest_.empty() ? value : std::nullopt;
  }

 private:
  static constexpr int kDeepest = 16;

  bool take(char c) {
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }

  std::optional<std::string> string() {
    if (!take('"')) return std::nullopt;
    std::string text;
    while (!rest_.empty() && rest_.front() != '"') {
      if (rest_.front() == '\\') rest_.remove_prefix(1);
      if (rest_.empty()) return std::nullopt;
      text += rest_.front();
      rest_.remove_prefix(1);
    }
    return take('"') ? std::optional(text) : std::nullopt;
  }

  std::optional<Value> array(int depth) {
    Value::Array items;
    if (take(']')) return items;
    do {
      auto item = read(depth + 1);
      if (!item) return std::nullopt;
      items.push_back(*std::move(item));
    } while (take(','));
    return take(']') ? std::optional<Value>(std::move(items)) : std::nullopt;
  }

  std::optional<Value> object(int depth) {
    Value::Object members;
    if (take('}')) return members;
    do {
      auto name = string();
      if (!name || !take(':')) return std::nullopt;
      auto member = read(depth + 1);
      if (!member) return std::nullopt;
      members.emplace_back(*std::move(name), *std::move(member));
    } while (take(','));
    return take('}') ? std::optional<Value>(std::move(members)) : std::nullopt;
  }

  std::optional<Value> read(int depth) {
    if (depth > kDeepest) return std::nullopt;
    if (take('[')) return array(depth);
    if (take('{')) return object(depth);
    if (!rest_.empty() && rest_.front() == '"') {
      auto text = string();
      return text ? std::optional<Value>(*std::move(text)) : std::nullopt;
    }
    const std::string_view word = rest_.substr(0, rest_.find_first_of(",]}"));
    rest_.remove_prefix(word.size());
    if (word == "true" || word == "false") return Value(word == "true");
    return word == "null" ? std::optional(Value()) : number_in(word);
  }

  std::string_view rest_;
};

}  // namespace

std::optional<std::vector<std::string>> take_row(std::string_view& text, std::size_t& lines) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  while (!text.empty()) {
    const char c = text.front();
    text.remove_prefix(1);
    if (c == '\n') ++lines;
    if (c == '"' && quoted && text.starts_with('"')) {
      cells.back() += '"';
      text.remove_prefix(1);
    } else if (c == '"') {
      quoted = !quoted;
    } else if (quoted) {
      cells.back() += c;
    } else if (c == '\n') {
      return cells;
    } else if (c == ',') {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return quoted ? std::nullopt : std::optional(cells);
}

std::optional<Value> value_of_cell(std::string_view cell) {
  if (cell.starts_with('[') || cell.starts_with('{')) return JsonReader(cell).whole();
  if (cell == "true" || cell == "false") return Value(cell == "true");
  if (auto number = number_in(cell)) return number;
  return Value(cell);
}

}  // namespace drivers
