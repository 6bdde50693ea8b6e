// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/codec_scalar.h>

#include <limits>

namespace mauve::detail {

Error wrong_kind(std::string_view wanted, const Value& value) {
  return refuse({Errc::invalid_value, "value_wrong_kind"}, {},
                "expected " + std::string(wanted) + ", got " + to_string(value));
}

Status inside(Status done, const std::string& part) {
  if (!done) {
    std::string& at = done.error().at;
    at = part + (at.empty() || at.front() == '[' ? "" : ".") + at;
  }
  return done;
}

void add_member(Value::Object& object, std::string_view name, Value value) {
  object.emplace_back(std::string(name), std::move(value));
}

void add_field(Value::Array& fields, std::string_view name, Value kind, std::string_view unit,
               std::string_view text) {
  fields.emplace_back(
      Value::Object{{"name", name}, {"kind", std::move(kind)}, {"unit", unit}, {"text", text}});
}

std::string fields_in_words(std::string_view type, std::span<const std::string_view> fields) {
  std::string names;
  for (const std::string_view field : fields) {
    names += (names.empty() ? "" : ", ") + std::string(field);
  }
  return std::string(type) + " has the fields " + names;
}

Error no_field(const std::string& name, std::string_view type,
               std::span<const std::string_view> fields) {
  return refuse({Errc::unknown_name, "unknown_field"}, name, "is no field of " + std::string(type),
                fields_in_words(type, fields));
}

std::optional<double> number_of_word(const Value& value) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto* word = value.get_if<std::string>();
  if (word == nullptr) return std::nullopt;
  for (const double number : {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity}) {
    if (*word == word_of_number(number)) return number;
  }
  return std::nullopt;
}

Error out_of_range(std::int64_t low, std::uint64_t high, const Value& value) {
  return refuse(
      {Errc::invalid_value, "value_out_of_range"}, {},
      to_string(value) + " is not from " + std::to_string(low) + " to " + std::to_string(high));
}

}  // namespace mauve::detail
