// SPDX-License-Identifier: LGPL-3.0-or-later
/// Two architecture files compared by their text alone, without any plugin.
#pragma once

#include <string>

#include "protocol/framing.h"

namespace mauve::daemon {

/// [{"op","kind","address","old","new"}], as config.compare gives them: `kind` is "file", and
/// `address` is the path in the file, such as "components.first.properties.core.gain". A value that
/// only one file states is an addition or a removal, also where the plugin has a default for it.
/// Lists are compared as a whole. Both texts are JSON objects. [any]
[[nodiscard]] protocol::Json compare_texts(const std::string& before, const std::string& after);

}  // namespace mauve::daemon
