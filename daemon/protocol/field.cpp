// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/field.h"

#include <algorithm>
#include <array>

namespace mauve::protocol {
namespace {

using Kind = Type::Kind;
using Shape = Type::Shape;

constexpr std::array<std::string_view, 10> kKinds = {
    "text", "boolean", "count", "integer", "number", "duration", "time", "value", "object", ""};
constexpr std::array<std::string_view, 10> kExpected = {"a string",
                                                        "true or false",
                                                        "an integer of 0 or more",
                                                        "an integer",
                                                        "a number",
                                                        "a string such as \"50ms\"",
                                                        "a string such as \"2026-01-31T12:00:00Z\"",
                                                        "a value",
                                                        "an object",
                                                        "an object"};

std::string_view word_of(const Type& type, const std::array<std::string_view, 10>& words) {
  return words.at(static_cast<std::size_t>(type.kind));
}

Type one_of_many(Type type) {
  type.shape = Shape::one;
  type.nullable = false;
  return type;
}

bool is_count(const Json& value) {
  return value.is_number_unsigned() || (value.is_number_integer() && value >= 0);
}

bool is_choice(const Json& value, const Type& type) {
  const auto words = choices_of(type);
  return words.empty() ||
         std::ranges::find(words, value.get_ref<const std::string&>()) != words.end();
}

bool fits_kind(const Json& value, const Type& type) {
  switch (type.kind) {
    case Kind::text:
      return value.is_string() && is_choice(value, type);
    case Kind::duration:
    case Kind::time:
      return value.is_string();
    case Kind::boolean:
      return value.is_boolean();
    case Kind::count:
      return is_count(value);
    case Kind::integer:
      return value.is_number_integer();
    case Kind::number:
      return value.is_number() || value == "nan" || value == "inf" || value == "-inf";
    case Kind::value:
      return true;
    case Kind::object:
    case Kind::record:
      return value.is_object();
  }
  return false;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

std::vector<std::string> choices_of(const Type& type) {
  std::vector<std::string> words;
  for (auto rest = type.choices; !rest.empty();) {
    words.emplace_back(rest.substr(0, rest.find(' ')));
    rest.remove_prefix(std::min(rest.size(), words.back().size() + 1));
  }
  return words;
}

std::string in_words(const Type& type) {
  std::string words(type.kind == Kind::record ? type.record->name : word_of(type, kKinds));
  if (!type.unit.empty()) words += " in " + std::string(type.unit);
  if (type.shape == Shape::list) words.insert(0, "list of ");
  if (type.shape == Shape::map) words.insert(0, "map of ");
  return type.nullable ? words + " or null" : words;
}

std::string sentence_of(const Field& field) {
  std::string text = std::string(field.text) + ".";
  const auto words = choices_of(field.type);
  return words.empty() ? text : text + " One of: " + joined(words) + ".";
}

bool fits(const Json& value, const Type& type) {
  if (type.nullable && value.is_null()) return true;
  const auto each = [&](const Json& item) { return fits(item, one_of_many(type)); };
  switch (type.shape) {
    case Shape::list:
      return value.is_array() && std::all_of(value.begin(), value.end(), each);
    case Shape::map:
      return value.is_object() && std::all_of(value.begin(), value.end(), each);
    case Shape::one:
      break;
  }
  return fits_kind(value, type);
}

std::string expected_words(const Type& type) {
  if (type.shape == Shape::map) return "an object";
  if (type.shape == Shape::list)
    return type.kind == Kind::text ? "an array of strings" : "an array";
  const auto words = choices_of(type);
  return words.empty() ? std::string(word_of(type, kExpected)) : "one of " + joined(words);
}

}  // namespace mauve::protocol
