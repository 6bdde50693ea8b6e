// SPDX-License-Identifier: LGPL-3.0-or-later
/// Rows and columns of text for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "screen.h"

namespace mauve::ctl {

/// Of UTF-8: the first byte of a letter.
[[nodiscard]] constexpr bool starts_letter(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}

/// Columns on a terminal: code points, which is exact for the texts that mauve prints.
[[nodiscard]] std::size_t columns(std::string_view text);

/// The text, its middle replaced by "…" where it is wider than the width.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t width);

/// The text without what could steer a terminal: control characters, line separators and marks of
/// direction become '?'.
[[nodiscard]] std::string harmless(std::string_view text);

struct Cell {
  std::string text;
  Paint paint = Paint::plain;
};

struct Column {
  std::string title;
  bool number = false;  ///< to the right
  int rank = 0;         ///< where not all fit, the highest is left out first; 0: always shown
};

/// In columns of the terminal.
struct Spacing {
  std::size_t gap = 2;
  std::size_t narrowest = 8;  ///< no text is made narrower
};

class Table {
 public:
  explicit Table(std::vector<Column> columns, Spacing spacing = {})
      : columns_(std::move(columns)), spacing_(spacing) {}

  /// As many cells as columns.
  void add(std::vector<Cell> row) { rows_.push_back(std::move(row)); }

  /// The titles, then the rows, each ended by a newline. With a width, columns with a rank are left
  /// out and the widest text columns made narrower until a row fits.
  [[nodiscard]] std::string text(std::size_t width, bool colour) const;

 private:
  [[nodiscard]] std::vector<std::size_t> natural_widths() const;
  void leave_out(std::vector<std::size_t>& widths, std::size_t width) const;
  [[nodiscard]] std::vector<std::size_t> widths(std::size_t width) const;

  std::vector<Column> columns_;
  Spacing spacing_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace mauve::ctl
