// SPDX-License-Identifier: LGPL-3.0-or-later
/// Every method of the wire in one table: its arguments, and what kind of request it is.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "protocol/message.h"

namespace mauve::protocol {

enum class JsonType { string, boolean, integer, object, array, strings };

struct Param {
  std::string_view name;
  JsonType type = JsonType::string;
  bool required = false;
};

struct Method {
  std::string_view name;
  std::string_view text;          ///< one sentence, for command.list
  std::span<const Param> params;  ///< without the three that every mutation takes
  bool mutation = false;          ///< changes the system: also if_generation, reason, deadline_ms
  bool out_of_band = false;       ///< served even while a long change is prepared
  bool harmless = false;          ///< a mutation that touches nothing that runs: under any lock
  bool when_full = false;         ///< also of a connection beyond the limits
};

[[nodiscard]] std::span<const Method> methods();

/// By name or alias ("status"); null when there is none.
[[nodiscard]] const Method* find_method(std::string_view name);

/// -32601 with the nearest name.
[[nodiscard]] Fault unknown_method(std::string_view name);

/// Checks presence, names and JSON types of the arguments: -32602, nothing else looked at.
/// After this params[name] of a required argument can be read as its type without a look.
[[nodiscard]] std::optional<Fault> check_params(const Method& method, const Json& params);

}  // namespace mauve::protocol
