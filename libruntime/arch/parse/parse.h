// SPDX-License-Identifier: LGPL-3.0-or-later
/// From the text of an architecture file to its Spec.
#pragma once

#include <optional>
#include <string_view>

#include "arch/parse/spec.h"

namespace mauve::arch {

/// Reads a whole architecture file. Everything wrong with its form goes to `problems`: syntax,
/// unknown keys (with the nearest known one), wrong kinds of values, names, ranges, and features
/// that this version does not support. The result is set when the text is JSON and its root an
/// object. The Spec then holds all that could be read, so that check() can go on and all errors
/// come out together. Never throws. [any]
[[nodiscard]] std::optional<Spec> parse(std::string_view text, Problems& problems);

}  // namespace mauve::arch
