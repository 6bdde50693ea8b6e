// SPDX-License-Identifier: LGPL-3.0-or-later
/// The refusal of an address that names a part of a value, where only the whole has an address.
#pragma once

#include <string>
#include <string_view>

#include "mauve/result.h"

namespace mauve {

class Architecture;

}  // namespace mauve

namespace mauve::arch {

/// The refusal to read the value at `address`, a structure or an array within another value.
/// `otherwise` when the address names nothing of that kind. [control]
[[nodiscard]] Error part_not_read(const Architecture& architecture, std::string_view address,
                                  Error otherwise);

/// The refusal to set the value at `address`, a field of a property or of a value of a resource.
/// `otherwise` when the address names nothing of that kind. `value` is JSON. [control]
[[nodiscard]] Error part_not_set(const Architecture& architecture, std::string_view address,
                                 std::string_view value, Error otherwise);

}  // namespace mauve::arch
