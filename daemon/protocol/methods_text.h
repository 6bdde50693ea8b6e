// SPDX-License-Identifier: LGPL-3.0-or-later
/// The table of methods as text for people. Pure functions, any thread.
#pragma once

#include <string>

#include "protocol/methods.h"

namespace mauve::protocol {

/// A chapter in Markdown: roles and effects, every method with its parameters and the fields of its
/// answer, then the records. Headings are of the third level. The manual and the page methods.md
/// are made from it.
[[nodiscard]] std::string methods_in_markdown();

/// The same of one method, without a heading, and without the records.
[[nodiscard]] std::string in_markdown(const Method& method);

}  // namespace mauve::protocol
