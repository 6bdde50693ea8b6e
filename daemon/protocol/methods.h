// SPDX-License-Identifier: LGPL-3.0-or-later
/// The methods of the wire. methods.def is the table: a row describes a method entirely, and all
/// that describes or checks the protocol is made from the rows. Constant data; any thread may call.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/field.h"
#include "protocol/message.h"

namespace mauve::protocol {

/// Each role has the rights of those before it.
enum class Role : std::uint8_t {
  none,       ///< nothing: the connection is refused
  viewer,     ///< look
  operator_,  ///< change the running system with the code that is loaded
  admin,      ///< load code
};

/// "none", "viewer", "operator", "admin".
[[nodiscard]] std::string_view to_string(Role role);

/// The thread of mauved that serves a method, and when.
enum class Lane : std::uint8_t {
  any,      ///< at once on [io]: the method reads nothing of the model
  read,     ///< on [control], between the steps of a change
  later,    ///< begins on [control]; another thread makes the answer, which may take long
  aside,    ///< on [answer]: the answer takes long to write, and needs nothing of the model
  urgent,   ///< on [control], before everything that waits, also beside a change under way
  factory,  ///< on [factory]: the method is slow and reads nothing of the model
  change,   ///< on [control], one change at a time
};

/// "any", "read", ...
[[nodiscard]] std::string_view to_string(Lane lane);

/// How a method acts on the running system.
enum class Effect : std::uint8_t {
  reads,        ///< changes nothing
  out_of_band,  ///< changes nothing; served also when all connection slots are in use
  records,      ///< begins or ends a recording; the components run on as they were
  changes,      ///< changes the running system otherwise, as far as the lock permits
  adjusts,      ///< changes only counts, logs or locks of mauved; permitted under any lock
  ends,   ///< ends a probation, also when all slots are in use; an undo is judged by its lines
  stops,  ///< stops components; permitted under any lock, out of band, never limited
};

/// "reads", "out_of_band", ...
[[nodiscard]] std::string_view to_string(Effect effect);
/// One sentence about the effect, without its full stop.
[[nodiscard]] std::string_view text_of(Effect effect);
/// All effects, in the order above.
[[nodiscard]] std::span<const Effect> effects();

struct Method {
  std::string_view name;
  Role role = Role::admin;  ///< the lowest role that may call the method
  Lane lane = Lane::read;
  Effect effect = Effect::reads;
  std::string_view help = {};          ///< one sentence without its full stop
  std::span<const Field> params = {};  ///< without those that every mutation takes
  std::span<const Field> answer = {};  ///< without those that every mutation answers

  /// A mutation also takes every_mutation_takes(), leaves an audit line and is limited by rate.
  [[nodiscard]] constexpr bool mutation() const { return effect >= Effect::changes; }
  /// Waits for no change, and no limit of the rate holds it.
  [[nodiscard]] constexpr bool out_of_band() const {
    return effect == Effect::out_of_band || effect == Effect::stops;
  }
  /// A mutation that touches nothing that runs: permitted under any lock.
  [[nodiscard]] constexpr bool harmless() const { return effect == Effect::adjusts; }
  /// Also permitted on a connection beyond the limits.
  [[nodiscard]] constexpr bool when_full() const { return out_of_band() || effect == Effect::ends; }
};

/// All methods, in the order of methods.def.
[[nodiscard]] std::span<const Method> methods();
/// if_generation, reason and deadline_ms, which every mutation takes.
[[nodiscard]] std::span<const Field> every_mutation_takes();
/// The fields that the answer of every mutation may have besides its own.
[[nodiscard]] std::span<const Field> every_mutation_answers();
/// All parameters of a method, and all fields of its answer.
[[nodiscard]] std::vector<Field> all_params(const Method& method);
[[nodiscard]] std::vector<Field> all_answer_fields(const Method& method);

/// By name or alias ("status"); null when there is none.
[[nodiscard]] const Method* find_method(std::string_view name);

/// -32601 with the nearest name.
[[nodiscard]] Fault unknown_method(std::string_view name);

/// Checks presence, names, JSON types and choices of the arguments: -32602, nothing else is
/// checked. After this params[name] of a required argument can be read as its type without a check.
[[nodiscard]] std::optional<Fault> check_params(const Method& method, const Json& params);

}  // namespace mauve::protocol
