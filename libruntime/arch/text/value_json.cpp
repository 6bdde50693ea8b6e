// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/text/value_json.h"

#include <cstdint>
#include <utility>

#include "base/terminal_text.h"

namespace mauve::arch {
namespace {

template <typename Json>
Json converted(const Value& value) {
  if (const auto* flag = value.get_if<bool>()) return *flag;
  if (const auto* integer = value.get_if<std::int64_t>()) return *integer;
  if (const auto* integer = value.get_if<std::uint64_t>()) return *integer;
  if (const auto* number = value.get_if<double>()) {
    const std::string_view word = word_of_number(*number);
    return word.empty() ? Json(*number) : Json(word);
  }
  if (const auto* text = value.get_if<std::string>()) return *text;
  if (const auto* items = value.get_if<Value::Array>()) {
    Json array = Json::array();
    for (const Value& item : *items) array.push_back(converted<Json>(item));
    return array;
  }
  if (const auto* members = value.get_if<Value::Object>()) {
    Json object = Json::object();
    for (const auto& [key, member] : *members) object[key] = converted<Json>(member);
    return object;
  }
  return nullptr;
}

Result<Value> array_from(const nlohmann::json& json) {
  Value::Array array;
  array.reserve(json.size());
  for (const nlohmann::json& item : json) {
    Result<Value> value = from_json(item);
    if (!value) return value;
    array.push_back(*std::move(value));
  }
  return Value(std::move(array));
}

Result<Value> object_from(const nlohmann::json& json) {
  Value::Object object;
  object.reserve(json.size());
  for (const auto& [key, member] : json.items()) {
    Result<Value> value = from_json(member);
    if (!value) return value;
    object.emplace_back(key, *std::move(value));
  }
  return Value(std::move(object));
}

}  // namespace

nlohmann::ordered_json to_ordered_json(const Value& value) {
  return converted<nlohmann::ordered_json>(value);
}

nlohmann::json to_json(const Value& value) { return converted<nlohmann::json>(value); }

Result<Value> from_json(const nlohmann::json& json) {
  switch (json.type()) {
    case nlohmann::json::value_t::boolean:
      return Value(json.get<bool>());
    case nlohmann::json::value_t::number_integer:
      return Value(json.get<std::int64_t>());
    case nlohmann::json::value_t::number_unsigned:
      return Value(json.get<std::uint64_t>());
    case nlohmann::json::value_t::number_float:
      return Value(json.get<double>());
    case nlohmann::json::value_t::string:
      return Value(json.get_ref<const std::string&>());
    case nlohmann::json::value_t::array:
      return array_from(json);
    case nlohmann::json::value_t::object:
      return object_from(json);
    default:
      return Value();
  }
}

std::string to_json_text(const Value& value) {
  constexpr int kIndent = 2;
  return json_for_terminals(
      to_ordered_json(value).dump(kIndent, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace mauve::arch
