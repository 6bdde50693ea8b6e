// SPDX-License-Identifier: LGPL-3.0-or-later
/// Small texts that the renderers share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/message.h"

namespace mauve::ctl {

using protocol::Json;

/// A member as a reader sees it: texts bare, null as "-", structures compact, absent as "".
[[nodiscard]] std::string word(const Json& object, std::string_view key);

/// A member, or null.
[[nodiscard]] const Json& member(const Json& object, std::string_view key);

/// A member that is a list; an empty one for anything else.
[[nodiscard]] const Json& list_in(const Json& object, const char* key);

/// A member that is a text; an empty one for anything else.
[[nodiscard]] std::string text_in(const Json& object, std::string_view key);

/// A value in one line: {latitude: 43.1, mode: 3}, [1, 2], bare text; numbers with ten digits.
[[nodiscard]] std::string compact(const Json& value);

/// "2026-01-31T12:00:00.123456Z" is "2026-01-31 12:00:00Z".
[[nodiscard]] std::string time_in_words(std::string time);
/// The name of the user `uid` on this machine; the number of one that it does not know.
[[nodiscard]] std::string user_in_words(const Json& one);

/// "generations 3 to 5 (control, mission)" of {"generations","components"}.
[[nodiscard]] std::string changes_in_words(const Json& one);

/// "a" and "b" become "a, b".
void join(std::string& all, std::string_view next, std::string_view between = ", ");

/// Without their ends.
[[nodiscard]] std::vector<std::string_view> lines_of(std::string_view text);

/// At most so many columns, with "…" at the end of a text that was cut; 0: as it is.
[[nodiscard]] std::string cut(std::string_view text, std::size_t width);

/// The beginning of a text, up to a blank: as many words as fit, and at least one.
[[nodiscard]] std::string_view first_words(std::string_view text, std::size_t width);

/// Lines of at most so many columns, broken at spaces; lines after the first begin with `indent`
/// spaces. 0: as it is.
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t width, std::size_t indent);

/// "38 ns", "1.2 us", "3.4 ms", "5 s".
[[nodiscard]] std::string nanoseconds_in_words(double nanoseconds);
/// "it restarts with a fresh core in 80.0 ms, 2 restarts left"; empty: nothing recovers.
[[nodiscard]] std::string recovery_in_words(const Json& recovery);

/// "3 d 2 h", "5 min 12 s", "7 s".
[[nodiscard]] std::string seconds_in_words(double seconds);

/// "1 release", "2 releases".
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view noun);

/// A count as written, or nothing.
[[nodiscard]] std::optional<std::uint64_t> count_of(std::string_view text);

/// When this one of the transitions of a state is followed: "[has_goal]" with the name of its
/// guard,
/// "[2]" with its place where the guard has none, "[else]"; empty: always.
[[nodiscard]] std::string mark_of_transition(const Json& transitions, std::size_t index);

/// The keys of an object, or of all objects in an array: the keys that people look for first, then
/// a to z.
[[nodiscard]] std::vector<std::string> keys_in_order(const Json& value);

/// A number of nanoseconds, counts and so on: 0 where the member is absent or of another type.
[[nodiscard]] double number(const Json& object, std::string_view key);
[[nodiscard]] std::uint64_t whole_number(const Json& object, std::string_view key);

/// The counts of the kernel for the thread of a component; "" where none are given. A job of
/// real-time code waits once, for its next release, and touches no new memory.
[[nodiscard]] std::string kernel_in_words(const Json& kernel);

}  // namespace mauve::ctl
