// SPDX-License-Identifier: LGPL-3.0-or-later
/// Rows and columns of text for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "cli/screen.h"

namespace mauve::ctl {

/// Of UTF-8: the first byte of a letter.
[[nodiscard]] constexpr bool starts_letter(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}

/// Columns on a terminal: code points, which is exact for the texts that mauve prints.
[[nodiscard]] std::size_t columns(std::string_view text);

/// The text without characters that could steer a terminal: control characters, line separators and
/// marks of direction become '?'.
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
  std::size_t narrowest = 8;  ///< no cell with several words is made narrower
  bool one_line = false;      ///< a row is one line, cut where it does not fit
};

class Table {
 public:
  explicit Table(std::vector<Column> columns, Spacing spacing = {})
      : columns_(std::move(columns)), spacing_(spacing) {}

  /// As many cells as columns.
  void add(std::vector<Cell> row) { rows_.push_back(std::move(row)); }

  /// The titles, then the rows, each ended by a newline. No word is cut. If there is a width,
  /// columns with a rank are left out, and cells with several words take several lines. Columns
  /// that still do not fit stand on indented lines below the first. Without a width a cell that is
  /// much longer than a name does not widen its column.
  [[nodiscard]] std::string text(std::size_t width, bool colour) const;

 private:
  using Widths = std::vector<std::size_t>;  ///< of each column; zero: the column is not shown
  struct Group {                            ///< the columns that stand on one line
    std::size_t first;
    std::size_t end;
    std::size_t indent;
    bool wraps;
  };

  [[nodiscard]] Widths natural_widths(std::size_t widest_cell) const;
  [[nodiscard]] Widths least_widths(const Widths& natural) const;
  void leave_out(Widths& widths, Widths& least, std::size_t width) const;
  [[nodiscard]] std::size_t total(const Widths& widths) const;
  [[nodiscard]] Widths widths(std::size_t width) const;
  [[nodiscard]] std::vector<Group> groups(const Widths& widths, std::size_t width) const;
  [[nodiscard]] std::string line_of(const std::vector<Cell>& row, const Widths& widths,
                                    const Group& group, bool colour) const;

  std::vector<Column> columns_;
  Spacing spacing_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace mauve::ctl
