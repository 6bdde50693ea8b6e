// SPDX-License-Identifier: LGPL-3.0-or-later
/// Answers of the daemon as texts for people. Pure: a value in, a text out, newline at its end.
#pragma once

#include <string>
#include <string_view>

#include "cli/screen.h"
#include "protocol/message.h"

namespace mauve::protocol {
struct Method;
}  // namespace mauve::protocol

namespace mauve::ctl {

using protocol::Fault;
using protocol::Json;

/// How wide, and with colours or not.
struct Look {
  std::size_t width = 0;
  bool colour = false;
};

/// "rover: 6 of 6 components running, generation 12, up 5 min 2 s, real time".
[[nodiscard]] std::string render_heading(const Json& status);
[[nodiscard]] std::string render_status(const Json& status, Look look);
/// A line for each thing of status.get that is not settled yet; empty: all is.
[[nodiscard]] std::string render_pending(const Json& status, Look look);

/// The "items" of any list, one row each; nested things stand as compact JSON.
[[nodiscard]] std::string render_list(const Json& result, Look look);

/// Everything about one object, indented.
[[nodiscard]] std::string render_object(const Json& object, Look look);

/// {"address","value","status"}: one line, structures below it.
[[nodiscard]] std::string render_value(const Json& value, Look look);

/// The same as exactly one line, for watching.
[[nodiscard]] std::string render_sample(const Json& params, Look look);

[[nodiscard]] std::string render_record(const Json& record, Look look);

/// The differences that a change made, a line each: "~ control.core.gain: 0.6 -> 0.8".
[[nodiscard]] std::string change_lines(const Json& result, Look look);
/// "swapped control: pause 38 ns, 0 releases missed (generation 42)".
[[nodiscard]] std::string render_receipt(std::string_view done, const Json& receipt, Look look);
/// The consequences of a change, one a line: properties that are gone, states that are dropped,
/// notes and warnings. An answer and a dry run print the same ones.
[[nodiscard]] std::string remark_lines(const Json& receipt, Look look);
/// Of these the notes only, "note: ...".
[[nodiscard]] std::string note_lines(const Json& receipt, Look look);
[[nodiscard]] std::string render_quarantine(const Json& list, Look look);

/// "loaded extra (generation 43)", with the fate of the old code, and warnings.
[[nodiscard]] std::string render_plugin(std::string_view done, const Json& result, Look look);

/// The loaded plugins, and the types that each brings.
[[nodiscard]] std::string render_plugins(const Json& result, Look look);

/// The cores that fit a component, one row each, by the names that swap-core takes.
[[nodiscard]] std::string render_plugins_for(const Json& result, Look look);

/// The saved generations, one row each.
[[nodiscard]] std::string render_history(const Json& result, Look look);
/// Response times, one row a component, then the proofs that are missing.
[[nodiscard]] std::string render_analysis(const Json& result, Look look);
/// The times that jobs took, one row a component; for one component with its states, all
/// statistics.
[[nodiscard]] std::string render_statistics(const Json& result, Look look);
/// One component with its states; `now_ns` since T0.
[[nodiscard]] std::string render_details(const Json& one, double now_ns, Look look);
/// Why a component failed, the reaction of the system, and the next step.
[[nodiscard]] std::string render_why(const Json& why, Look look);
/// The conditions and the effects of the rules, one row each; render_rule() has all facts about the
/// first.
[[nodiscard]] std::string render_rules(const Json& result, Look look);
[[nodiscard]] std::string render_rule(const Json& result, Look look);

/// "FILE:3:5: error: control.core.gain: must be positive", with hints.
[[nodiscard]] std::string render_errors(std::string_view file, const Json& result, Look look);

/// "~ control.core.gain: 0.2 -> 0.3", one a line, below the names of both sides. Nothing differs:
/// one sentence.
[[nodiscard]] std::string render_diff(std::string_view file, const Json& result, Look look);
/// The same for two saved generations.
[[nodiscard]] std::string render_compared(std::uint64_t from, std::uint64_t to, const Json& result,
                                          Look look);
/// The same lines, then the receipt.
[[nodiscard]] std::string render_applied(std::string_view file, const Json& result, Look look);
/// The same lines, then the state that each component would hand over.
[[nodiscard]] std::string render_plan(std::string_view file, const Json& result, Look look);

/// An architecture file, keys in the order in which people write them.
[[nodiscard]] std::string render_architecture(const Json& architecture);
/// The same order in one line.
[[nodiscard]] std::string architecture_line(const Json& architecture);

/// "error: ..." with the four parts. `command` is that of the user, may be empty.
[[nodiscard]] std::string render_fault(std::string_view command, const Fault& fault, Look look);

/// {"error":{"code","name","message","state","where","hint","exit","generation"}}.
[[nodiscard]] Json fault_json(const Fault& fault);

/// The methods of the protocol, one row each; and everything about one.
[[nodiscard]] std::string render_methods(Look look);
[[nodiscard]] std::string render_method(const protocol::Method& method, Look look);
/// An answer as the row of its method describes it: a table for each list of records, numbers with
/// their units.
[[nodiscard]] std::string render_answer(const protocol::Method& method, const Json& answer,
                                        Look look);

}  // namespace mauve::ctl
