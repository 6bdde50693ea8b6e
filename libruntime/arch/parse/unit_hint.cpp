// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/unit_hint.h"

#include <optional>
#include <string>

#include "base/duration.h"

namespace mauve::arch {
namespace {

/// "0.05" for "50ms" where the unit is s; empty for other texts and units.
std::optional<std::string> as_number(const PropertyBase& property, const Value& value) {
  const auto* text = value.get_if<std::string>();
  const auto one = parse_duration("1" + std::string(property.unit()));
  if (text == nullptr || !one) return std::nullopt;
  const auto duration = parse_duration(*text);
  if (!duration) return std::nullopt;
  const bool whole = *duration % *one == duration->zero();
  const Value number =
      whole ? Value(static_cast<std::int64_t>(*duration / *one))
            : Value(static_cast<double>(duration->count()) / static_cast<double>(one->count()));
  return property.accepts(number) ? std::optional(to_string(number)) : std::nullopt;
}

}  // namespace

Error with_unit(const PropertyBase& property, const Value& value, Error error) {
  const bool number = property.value().number().has_value();
  if (error.id != "value_wrong_kind" || !number || !error.hint.empty() || property.unit().empty()) {
    return error;
  }
  const auto meant = as_number(property, value);
  error.hint =
      "a number in " + std::string(property.unit()) +
      (meant ? ": " + *meant : ", such as " + to_string(property.value()) + ", its value now");
  return error;
}

}  // namespace mauve::arch
