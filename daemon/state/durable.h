// SPDX-License-Identifier: LGPL-3.0-or-later
/// Files that survive a power cut: after it a file has its old content, or its new content. All
/// functions wait for the disk; none is for [control] or [io].
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "mauve/result.h"
#include "rt/process/descriptor.h"

namespace mauve::daemon {

/// The refusal of a step that failed just now, with the reason of errno: "cannot make: ...".
[[nodiscard]] Error state_not_written(const std::filesystem::path& what, const std::string& doing);

/// Writes the content at the present place of an open file.
[[nodiscard]] Status write_all(int descriptor, std::string_view content,
                               const std::filesystem::path& file);

/// Makes the directory where it is missing, for this user and his group; its parent must be there.
[[nodiscard]] Status make_directory(const std::filesystem::path& directory);

/// The directory, locked for as long as the result lives. Refused (conflict): another process
/// holds it.
[[nodiscard]] Result<rt::Descriptor> hold_directory(const std::filesystem::path& directory);

/// Gives a file new content: all of it or, when this is refused, none.
[[nodiscard]] Status replace_file(const std::filesystem::path& file, std::string_view content);

/// Adds a line, or several, which are on the disk afterwards. Makes the file where it is missing.
/// A line that was cut off before stays alone on its line.
[[nodiscard]] Status append_lines(const std::filesystem::path& file, std::string_view lines);

}  // namespace mauve::daemon
