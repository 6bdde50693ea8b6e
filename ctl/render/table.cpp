// SPDX-License-Identifier: LGPL-3.0-or-later
#include "render/table.h"

#include <algorithm>
#include <utility>

#include "base/terminal_text.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

constexpr std::size_t kLongCell = 60;  ///< without a width: longer cells do not widen the column
constexpr std::size_t kBelow = 4;      ///< indent of columns that stand below the first line

std::size_t longest_word(std::string_view text) {
  std::size_t longest = 0;
  while (!text.empty()) {
    const std::string_view one = text.substr(0, text.find(' ', 1));
    longest = std::max(longest, columns(one));
    text.remove_prefix(std::min(text.size(), one.size() + 1));
  }
  return longest;
}

std::string padded(const std::string& text, std::size_t width, bool to_the_right) {
  const std::size_t used = columns(text);
  const std::string space(width > used ? width - used : 0, ' ');
  return to_the_right ? space + text : text + space;
}

void strip_end(std::string& line) { line.erase(line.find_last_not_of(' ') + 1); }

}  // namespace

std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), starts_letter));
}

std::string harmless(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t obeyed = terminal_command(text);
    result += obeyed > 0 ? '?' : text.front();
    text.remove_prefix(std::max<std::size_t>(obeyed, 1));
  }
  return result;
}

Table::Widths Table::natural_widths(std::size_t widest_cell) const {
  Widths result;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    std::size_t widest = columns(columns_[i].title);
    for (const auto& row : rows_) {
      const std::size_t used = columns(row[i].text);
      if (widest_cell == 0 || used <= widest_cell) widest = std::max(widest, used);
    }
    result.push_back(widest);
  }
  return result;
}

/// No column is narrower than its longest word.
Table::Widths Table::least_widths(const Widths& natural) const {
  Widths result;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    std::size_t least = std::max(columns(columns_[i].title), spacing_.narrowest);
    for (const auto& row : rows_) least = std::max(least, longest_word(row[i].text));
    result.push_back(columns_[i].number ? natural[i] : std::min(natural[i], least));
  }
  return result;
}

std::size_t Table::total(const Widths& widths) const {
  std::size_t sum = 0;
  for (const std::size_t one : widths) sum += one + (one == 0 || sum == 0 ? 0 : spacing_.gap);
  return sum;
}

void Table::leave_out(Widths& widths, Widths& least, std::size_t width) const {
  while (total(least) > width) {
    std::size_t last = columns_.size();
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (widths[i] == 0 || columns_[i].rank == 0) continue;
      if (last == columns_.size() || columns_[i].rank > columns_[last].rank) last = i;
    }
    if (last == columns_.size()) return;
    widths[last] = least[last] = 0;
  }
}

Table::Widths Table::widths(std::size_t width) const {
  if (width == 0) return natural_widths(kLongCell);
  Widths result = natural_widths(0);
  Widths least = least_widths(result);
  leave_out(result, least, width);
  for (std::size_t sum = total(result); sum > width; --sum) {
    std::size_t widest = columns_.size();
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (result[i] <= least[i]) continue;
      if (widest == columns_.size() || result[i] > result[widest]) widest = i;
    }
    if (widest == columns_.size()) break;
    --result[widest];
  }
  return result;
}

std::vector<Table::Group> Table::groups(const Widths& widths, std::size_t width) const {
  std::vector<Group> result{{0, 0, 0, width > 0 && !spacing_.one_line}};
  std::size_t used = 0;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    if (widths[i] == 0) continue;
    const std::size_t more = widths[i] + (used == 0 ? 0 : spacing_.gap);
    if (width > 0 && !spacing_.one_line && used > 0 && result.back().indent + used + more > width) {
      result.push_back({i, i, kBelow, true});
      used = widths[i];
    } else {
      used += more;
    }
    result.back().end = i + 1;
  }
  return result;
}

std::string Table::line_of(const std::vector<Cell>& row, const Widths& widths, const Group& group,
                           bool colour) const {
  std::string lines;
  std::vector<std::string_view> rest;
  for (const Cell& cell : row) rest.emplace_back(cell.text);
  for (bool more = true; more;) {
    more = false;
    std::string line(group.indent, ' ');
    bool first = true;
    for (std::size_t i = group.first; i < group.end; ++i) {
      if (widths[i] == 0) continue;
      if (!std::exchange(first, false)) line.append(spacing_.gap, ' ');
      const std::string_view part = group.wraps ? first_words(rest[i], widths[i]) : rest[i];
      rest[i].remove_prefix(std::min(rest[i].size(), part.size() + 1));
      more = more || !rest[i].empty();
      const std::string cell = padded(std::string(part), widths[i], columns_[i].number);
      line += painted(cell, row[i].paint, colour);
    }
    strip_end(line);
    if (group.first == 0 || !line.empty()) lines += line + "\n";
  }
  return lines;
}

std::string Table::text(std::size_t width, bool colour) const {
  const Widths fitted = widths(width);
  const auto lines = groups(fitted, width);
  std::vector<Cell> titles;
  for (const Column& column : columns_) titles.push_back({column.title, Paint::bold});
  std::string result;
  const auto add_row = [&](const std::vector<Cell>& row) {
    for (const Group& group : lines) result += line_of(row, fitted, group, colour);
  };
  add_row(titles);
  for (const auto& row : rows_) add_row(row);
  return result;
}

}  // namespace mauve::ctl
