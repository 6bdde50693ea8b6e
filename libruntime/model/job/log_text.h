// SPDX-License-Identifier: LGPL-3.0-or-later
/// The text of a message whose arguments were kept beside its literal.
#pragma once

#include <string>

#include <mauve/log.h>

namespace mauve {

/// Each "{}" of the literal takes the next argument. [any but rt]
[[nodiscard]] std::string fill_in(std::string literal, const LogArgument& a, const LogArgument& b);

}  // namespace mauve
