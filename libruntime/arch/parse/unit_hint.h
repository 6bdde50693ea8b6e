// SPDX-License-Identifier: LGPL-3.0-or-later
/// The hint of a refused value of a property that is a number with a unit.
#pragma once

#include "mauve/detail/property_base.h"

namespace mauve::arch {

/// The refusal of `value`, with a hint where a number in the unit of the property was expected:
/// "a number in s: 0.05" for "50ms", else "a number in s, such as 0.5, its value now". [any]
[[nodiscard]] Error with_unit(const PropertyBase& property, const Value& value, Error error);

}  // namespace mauve::arch
