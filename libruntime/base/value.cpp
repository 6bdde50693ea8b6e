// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/value.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

namespace mauve {

Value::Value(std::uint64_t value) {
  if (std::in_range<std::int64_t>(value)) {
    content_ = static_cast<std::int64_t>(value);
  } else {
    content_ = value;
  }
}

Value::Value(const Value& other) = default;
Value::Value(Value&& other) noexcept = default;
Value& Value::operator=(const Value& other) = default;
Value& Value::operator=(Value&& other) noexcept = default;
Value::~Value() = default;

namespace {

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      out += '?';
    } else {
      out += c;
    }
  }
  return out + '"';
}

/// The shortest text that reads back as the same number.
std::string shortest(double number) {
  if (const std::string_view word = word_of_number(number); !word.empty()) return std::string(word);
  char buffer[40];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, number).ptr;
  return {buffer, end};
}

struct Printer {
  std::string operator()(std::monostate) const { return "null"; }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(std::uint64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return shortest(value); }
  std::string operator()(const std::string& value) const { return quoted(value); }
  std::string operator()(const Value::Array& items) const {
    std::string out = "[";
    for (const Value& item : items) out += (out.size() > 1 ? "," : "") + to_string(item);
    return out + "]";
  }
  std::string operator()(const Value::Object& members) const {
    std::string out = "{";
    for (const auto& [name, member] : members) {
      out += (out.size() > 1 ? "," : "") + quoted(name) + ":" + to_string(member);
    }
    return out + "}";
  }
};

struct KindName {
  std::string_view operator()(std::monostate) const { return "null"; }
  std::string_view operator()(bool) const { return "a boolean"; }
  std::string_view operator()(std::int64_t) const { return "an integer"; }
  std::string_view operator()(std::uint64_t) const { return "an integer"; }
  std::string_view operator()(double) const { return "a number"; }
  std::string_view operator()(const std::string&) const { return "a string"; }
  std::string_view operator()(const Value::Array&) const { return "an array"; }
  std::string_view operator()(const Value::Object&) const { return "an object"; }
};

}  // namespace

std::optional<double> Value::number() const {
  if (const auto* number = get_if<double>()) return *number;
  if (const auto* integer = get_if<std::int64_t>()) return static_cast<double>(*integer);
  if (const auto* integer = get_if<std::uint64_t>()) return static_cast<double>(*integer);
  return std::nullopt;
}

const Value* Value::find(std::string_view name) const {
  const auto* object = get_if<Object>();
  if (object == nullptr) return nullptr;
  for (const auto& [key, member] : *object) {
    if (key == name) return &member;
  }
  return nullptr;
}

std::string_view kind_of(const Value& value) { return value.visit(KindName{}); }

std::string to_string(const Value& value) { return value.visit(Printer{}); }

std::string_view word_of_number(double number) {
  if (std::isfinite(number)) return {};
  if (std::isnan(number)) return "nan";
  return number < 0.0 ? "-inf" : "inf";
}

}  // namespace mauve
