// SPDX-License-Identifier: LGPL-3.0-or-later
/// The parts of man pages that come from the program's own tables, so that a new command, option,
/// method or key is in its page by itself. All roff.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <mauve/result.h>

namespace mauve::man {

/// Of mauvectl: each command with its arguments and its example.
[[nodiscard]] std::string commands();
[[nodiscard]] std::string global_options();
[[nodiscard]] std::string exit_codes();
[[nodiscard]] std::string examples();
/// Of mauved.
[[nodiscard]] std::string daemon_options();
/// Of the wire: every method with its parameters and its answer, then the records of answers.
[[nodiscard]] std::string methods();
/// Every object of the schema of architecture files (JSON), with its keys.
[[nodiscard]] std::string keys(std::string_view schema);

/// A page from its template: lines that begin with '@' stand for one of the above, for a section of
/// a Markdown file, or for a file: see README.md. Files are named from `sources`.
[[nodiscard]] Result<std::string> page(std::string_view text, const std::filesystem::path& sources);

}  // namespace mauve::man
