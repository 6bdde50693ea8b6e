// SPDX-License-Identifier: LGPL-3.0-or-later
/// The keys of a JSON schema as text.
#pragma once

#include <string>
#include <string_view>

namespace mauve::man {

/// A subsection for each object with its keys, then one for each kind of text. Understands the part
/// of the language that etc/architecture.schema.json uses. Empty for a text that is not a schema.
[[nodiscard]] std::string schema_keys(std::string_view schema);

}  // namespace mauve::man
