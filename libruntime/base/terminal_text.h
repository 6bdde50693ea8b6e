// SPDX-License-Identifier: LGPL-3.0-or-later
/// Texts of others, which may be long, and may hold characters that a terminal obeys.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mauve {

/// The length of the UTF-8 sequence at the beginning of `text` if a terminal obeys it. 0: the
/// terminal shows it. A terminal obeys control characters (C0, DEL, C1), line and paragraph
/// separators, and marks that reorder the text behind them. [any]
[[nodiscard]] std::size_t terminal_command(std::string_view text);

/// The same JSON, in which DEL, C1 controls, separators and marks are written as "\u202e". JSON has
/// no control characters of C0 within strings. [any]
[[nodiscard]] std::string json_for_terminals(std::string json);

/// The text itself, or the beginning of a long one and its length: a message of one sentence does
/// not repeat 900 kB. [any but rt]
[[nodiscard]] std::string beginning_of(std::string_view text);

}  // namespace mauve
