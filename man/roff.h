// SPDX-License-Identifier: LGPL-3.0-or-later
/// Text for man pages: the language of roff, and Markdown turned into it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mauve::man {

/// Text that stands for itself, also at the beginning of a line. One line.
[[nodiscard]] std::string plain(std::string_view text);
/// The same in bold or in italics.
[[nodiscard]] std::string bold(std::string_view text);
[[nodiscard]] std::string italic(std::string_view text);
/// Lines that are kept as they are.
[[nodiscard]] std::string verbatim(std::string_view lines);
/// `text` indented below `tag`; both are roff.
[[nodiscard]] std::string item(std::string_view tag, std::string_view text);

/// One line of Markdown: `code`, **bold**, [link](target).
[[nodiscard]] std::string inline_roff(std::string_view markdown);
/// Paragraphs, lists, tables and fenced code; headings become subsections.
[[nodiscard]] std::string roff(std::string_view markdown);
/// The cells of a line of a table, which begins with '|'; a bar inside of `code` parts none.
[[nodiscard]] std::vector<std::string> cells_of(std::string_view line);
/// The text below the heading `## NAME`, up to the next heading; empty when there is none.
[[nodiscard]] std::string section(std::string_view markdown, std::string_view name);

}  // namespace mauve::man
