// SPDX-License-Identifier: LGPL-3.0-or-later
/// Answering requests; changes are saved and audited before.
#pragma once

#include <optional>
#include <string>

#include "commands/command.h"

namespace mauve::daemon {

/// [any] The answer, or the refusal with the generation in force. `state` is the state of the
/// system after a refusal. A mutation leaves its audit line in the log and in the state directory.
/// The answer of an applied mutation comes from [control] only, and contains whether the change was
/// saved too.
void answer(Running& running, const Call& call, Result<Json> result,
            const std::string& state = "unchanged");

/// [any] A refusal with more details than an Error has. A mutation leaves its audit line.
void answer_fault(Running& running, const Call& call, Fault fault);

/// [any] Refuses the text of a request: `subject` ("the file has") and the number of its errors.
void refuse_text(Running& running, const Call& call, const std::string& subject,
                 const std::string& hint, Json errors);

/// [control] Refused: everything is locked (lock.h), the generation is not the one that the caller
/// saw (`if_generation`), or the deadline of the request has passed (`deadline_ms`). Nothing has
/// happened yet. A change asks twice, before it is prepared and right before it takes effect; after
/// the second time its deadline no longer drops it.
[[nodiscard]] Status check_conditions(const Running& running, const Call& call);

/// [any] How long after its arrival a request may take effect; none: as long as it takes.
[[nodiscard]] std::optional<std::chrono::milliseconds> deadline_in(const Json& params);
[[nodiscard]] Error deadline_passed(const Call& call);

/// [control] Refused: the user of the call waits for too many long answers already, each of which
/// takes memory. For a command that uses Control::write_out().
[[nodiscard]] Status check_long_answers(const Running& running, const Call& call);

/// A receipt as on the wire.
[[nodiscard]] Json to_json(const Receipt& receipt);

/// [any] An optional argument whose JSON type was checked.
[[nodiscard]] std::string text_or(const Json& params, const char* name, std::string otherwise = {});
[[nodiscard]] std::size_t number_or(const Json& params, const char* name, std::size_t otherwise);
[[nodiscard]] bool flag(const Json& params, const char* name);
[[nodiscard]] std::vector<std::string> texts(const Json& params, const char* name);

}  // namespace mauve::daemon
