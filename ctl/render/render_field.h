// SPDX-License-Identifier: LGPL-3.0-or-later
/// Members of an answer with units instead of raw numbers. Pure.
#pragma once

#include <string>

#include "render/words.h"

namespace mauve::ctl {

/// The key as a title: "wait" for "wait_ns", because the content has its unit.
[[nodiscard]] std::string field_title(const std::string& key);

/// The content in words: durations, instants and sizes with their units, else as word() has it.
/// "none" stands for a task's limit that is not set, and for a port without a safe value.
[[nodiscard]] std::string field_content(const Json& object, const std::string& key);

/// The states of object.get's "machine", each with "next": "[1] doze, [else] run".
[[nodiscard]] Json machine_rows(const Json& machine);

/// object.get's "fields", one row for each: those of a structure with their path, "goal.x", and
/// those of the items of an array as "points[].x".
[[nodiscard]] Json field_rows(const Json& fields);

}  // namespace mauve::ctl
