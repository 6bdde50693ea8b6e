// SPDX-License-Identifier: LGPL-3.0-or-later
/// One task attribute of a component by its name: "budget" of "control.task.budget".
#pragma once

#include <string>
#include <string_view>

#include "arch/parse/spec.h"
#include "mauve/host/component.h"

namespace mauve::arch {

/// Writes the attributes that the file gives; the others stay. [any]
void write_attributes(const TaskSpec& spec, TaskAttributes& task);

/// Reads `json`, the text of one JSON value, by the rules of the architecture file; null takes the
/// attribute back to its usual value. `at` is the address of the task, "control.task". [any]
[[nodiscard]] Status set_attribute(TaskAttributes& task, const std::string& at,
                                   const std::string& name, const std::string& json);

/// The value as the architecture file writes it; null for an attribute that the file leaves out.
/// [any]
[[nodiscard]] Result<Value> attribute_of(const TaskAttributes& task, const std::string& at,
                                         std::string_view name);

}  // namespace mauve::arch
