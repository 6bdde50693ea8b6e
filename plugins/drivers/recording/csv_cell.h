// SPDX-License-Identifier: LGPL-3.0-or-later
/// Splits CSV into cells, and reads a cell as a value.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/host/value.h>

namespace drivers {

/// Takes one row of cells off the text; quoted cells may have commas, quotes and line ends in them.
/// `lines` is raised by the lines that were read. Empty: a quote is not closed. [factory]
[[nodiscard]] std::optional<std::vector<std::string>> take_row(std::string_view& text,
                                                               std::size_t& lines);

/// A number, true, false, or a list or object in JSON; any other text is a string ("nan"). Empty:
/// a list or object that is cut or too deep. [factory]
[[nodiscard]] std::optional<mauve::Value> value_of_cell(std::string_view cell);

}  // namespace drivers
