// SPDX-License-Identifier: LGPL-3.0-or-later
/// Value to JSON and back, for the wire and for files.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "mauve/host/value.h"
#include "mauve/result.h"

namespace mauve::arch {

/// The same tree; members of objects keep their order. A number that JSON cannot hold
/// becomes the string "nan", "inf" or "-inf"; null means that there is no value. [any]
[[nodiscard]] nlohmann::ordered_json to_ordered_json(const Value& value);

/// The same for the wire, whose objects have no order.
[[nodiscard]] nlohmann::json to_json(const Value& value);

/// Refused: an integer beyond 64 bits signed. `at` of the error is empty. [any]
[[nodiscard]] Result<Value> from_json(const nlohmann::json& json);

/// Readable text, indented by two, that parse_json() reads back.
[[nodiscard]] std::string to_json_text(const Value& value);

}  // namespace mauve::arch
