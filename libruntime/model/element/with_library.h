// SPDX-License-Identifier: LGPL-3.0-or-later
/// Objects whose code lies in a plugin.
#pragma once

#include <memory>

namespace mauve {

/// The object goes first, then the library whose code destroys it.
[[nodiscard]] std::shared_ptr<void> with_library(std::shared_ptr<void> library,
                                                 std::shared_ptr<void> object);

}  // namespace mauve
