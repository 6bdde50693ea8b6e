// SPDX-License-Identifier: LGPL-3.0-or-later
/// Libraries of the system: where the package manager puts them, and nobody else should. A plugin
/// gets no others, since a reload renews the code of the plugin alone. The source also has dlopen()
/// and dlmopen() of jobs and hooks.
#pragma once

#include <string_view>

namespace mauve::plugin {

/// `path` is absolute. [any]
[[nodiscard]] bool is_of_the_system(std::string_view path);

}  // namespace mauve::plugin
