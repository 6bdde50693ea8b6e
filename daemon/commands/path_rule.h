// SPDX-License-Identifier: LGPL-3.0-or-later
/// Which files a request may make a component open or create.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mauve/property.h"

namespace mauve::daemon {

/// [factory] Refuses a path that lies in no place that the property declares (Limits::within), and
/// in none of the directories `more`; ".." and symbolic links are followed first. Any other value,
/// and the empty path, is accepted. A relative path begins at the working directory, which is the
/// folder of the architecture. Only for values of requests: the architecture file is as trusted as
/// plugins, and an admin who applies one may run code of his choice anyway.
[[nodiscard]] Status lies_within(const PropertyBase& property, const Value& value,
                                 const std::vector<std::string>& more);

/// The same for Edit::allows.
[[nodiscard]] std::function<Status(const PropertyBase&, const Value&)> path_rule(
    std::vector<std::string> more);

}  // namespace mauve::daemon
