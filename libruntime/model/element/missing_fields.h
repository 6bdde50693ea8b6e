// SPDX-License-Identifier: LGPL-3.0-or-later
/// The fields that a value leaves out. [any], not on a real-time thread.
#pragma once

#include <string>

#include <mauve/result.h>
#include <mauve/type.h>

namespace mauve {

/// For a value that replaces nothing, such as one that a client writes to a service: refused unless
/// it names all fields of its type. `hint` says how a whole value is found.
[[nodiscard]] Status names_all_fields(const std::string& at, const DataType& type,
                                      const Value& given, const std::string& hint);

/// For a new value of a property: fields that it leaves out stay as they are. An item of an array
/// takes the place of no other, so it names all its fields, or the value is refused.
[[nodiscard]] Status items_name_all_fields(const std::string& at, const DataType& type,
                                           const Value& given);

}  // namespace mauve
