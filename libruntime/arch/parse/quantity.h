// SPDX-License-Identifier: LGPL-3.0-or-later
/// Quantity: one plain value that a condition can compare, found by its address. [control]
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "arch/parse/target.h"
#include "rules/condition.h"

namespace mauve::arch {

/// The source of the value behind an address:
///   `control.missed`, `control.state`: a statistic of a component.
///   `control.core.gain`, `fix.read`: a property, observable or service, by find_target().
///   `control.ports.scan`: the value that a read port gets.
///   `control.ports.scan.status`, `fix.read.age`: the status and the age of that value.
///   `gnss.core.satellites.age`: the time since the observable was written last, or else since the
///   first job of the core; no value: it has run none.
///   `fix.read.position.x`: a field of any of these values.
struct Quantity {
  enum class Aspect : std::uint8_t { value, status, age };

  Target target;
  std::string statistic;  ///< its name, or empty: then the target is set
  Aspect aspect = Aspect::value;
  std::vector<std::string> fields;  ///< within the value
  rules::Kind kind = rules::Kind::number;
  std::vector<std::string> words;  ///< all that it can be; empty: anything
};

/// Refused: there is no such thing (with the nearest name), or it is no plain value. `at` of the
/// error is the address.
[[nodiscard]] Result<Quantity> find_quantity(const Architecture& architecture,
                                             std::string_view address);

/// The member that `fields` lead to, or null (the value) when there is none.
[[nodiscard]] Value field_of(const Value& value, const std::vector<std::string>& fields);

}  // namespace mauve::arch
