// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/codec_scalar.h>

#include <limits>
#include <optional>

#include "base/terminal_text.h"

namespace mauve::detail {
namespace {

/// A double that is a whole number has a fraction here, else a message would call it an integer.
std::string shown(const Value& value) {
  std::string text = to_string(value);
  const bool is_double = value.get_if<double>() != nullptr;
  if (is_double && text.find_first_not_of("-0123456789") == std::string::npos) text += ".0";
  return beginning_of(text);
}

/// The addition about a text that was meant as a structure or an array.
std::string_view about_text(const Value& value) {
  const auto* text = value.get_if<std::string>();
  const bool composed = text != nullptr && (text->starts_with('{') || text->starts_with('['));
  return composed ? ", which is no JSON: names and texts need double quotes" : "";
}

/// An integer that no integer type holds arrives as a number.
std::optional<Error> beyond_integers(const Value& value) {
  const auto* number = value.get_if<double>();
  if (number == nullptr) return std::nullopt;
  const bool above = *number >= 0x1p64;
  if (!above && !(*number < -0x1p63)) return std::nullopt;
  return refuse({Errc::invalid_value, "value_out_of_range"}, {},
                above ? "is above 18446744073709551615" : "is below -9223372036854775808");
}

}  // namespace

Error wrong_kind(std::string_view wanted, const Value& value) {
  if (wanted == "an integer") {
    if (auto beyond = beyond_integers(value)) return *std::move(beyond);
  }
  return refuse(
      {Errc::invalid_value, "value_wrong_kind"}, {},
      "expected " + std::string(wanted) + ", got " + shown(value) + std::string(about_text(value)));
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
  return refuse({Errc::unknown_name, "unknown_field"}, beginning_of(name),
                "is no field of " + std::string(type), fields_in_words(type, fields));
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
      shown(value) + " is not from " + std::to_string(low) + " to " + std::to_string(high));
}

Error text_too_long(std::size_t most, std::size_t size) {
  return refuse({Errc::invalid_value, "value_out_of_range"}, {},
                "is a text of " + std::to_string(size) + " bytes, and at most " +
                    std::to_string(most) + " are taken");
}

}  // namespace mauve::detail
