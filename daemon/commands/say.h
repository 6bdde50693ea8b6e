// SPDX-License-Identifier: LGPL-3.0-or-later
/// The parts of an answer beside its receipt.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "arch/compare/diff.h"
#include "commands/command.h"

namespace mauve::daemon {

/// [any] Adds `lines` to the result, where there are any and none stand there yet.
void say_lines(const std::vector<arch::Line>& lines, Json& result);

/// [control] A change on probation, which is under way, makes these differences. A rollback of it
/// can be shown before its answer is.
void expect_lines(Running& running, const std::shared_ptr<const Ongoing>& change,
                  const std::vector<arch::Line>& lines);
/// [control] It has ended, also partly, and made this generation; 0: none.
void remember_lines(Running& running, std::uint64_t made, const std::vector<arch::Line>& lines);

/// [any] Appends to the notes of the result.
void say_notes(const std::vector<std::string>& notes, Json& result);

/// [any] A note where the first of the lines of a reload, that of the plugin, shows one build only.
/// Such a reload is of use: it gives a poisoned resource a new core, and starts states fresh.
void say_same_build(const std::vector<arch::Line>& lines, Json& result);

/// [any] Whether all members wait for each other, as it was prepared.
void say_sync(std::optional<Result<PreparedChange>>& prepared, Json& result);

/// [control] The rules of the probation, and when it ends if its jobs end it before its time does.
void say_probation(const Running& running, const Probation& probation,
                   std::optional<Result<PreparedChange>>& prepared, Json& result);

/// [any] Whether components on ordinary threads missed releases during the change: the machine may
/// be the cause.
void say_missed(bool realtime, Json& result);

enum class Asked : std::uint8_t { in_force, dry_run };

/// [control] The changed components that do not run, and will not by themselves. To be reported,
/// since the rest of the receipt reads as if all was well. In a dry run, those that the change
/// would leave as they are.
void say_who_stands(Running& running, const Change& change, Asked asked, Json& result);

/// Notes on components that a file or a saved generation (`source`) starts. A user may have stopped
/// them for a reason.
[[nodiscard]] std::vector<std::string> notes_on_starts(const std::vector<arch::Line>& lines,
                                                       const std::string& source, bool dry_run);

}  // namespace mauve::daemon
