// SPDX-License-Identifier: LGPL-3.0-or-later
#include "table.h"

#include <algorithm>

#include "base/terminal_text.h"

namespace mauve::ctl {
namespace {

std::string_view first_columns(std::string_view text, std::size_t count) {
  std::size_t seen = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (starts_letter(text[at]) && seen++ == count) return text.substr(0, at);
  }
  return text;
}

std::string_view last_columns(std::string_view text, std::size_t count) {
  if (count == 0) return {};
  for (std::size_t at = text.size(); at-- > 0;) {
    if (starts_letter(text[at]) && --count == 0) return text.substr(at);
  }
  return text;
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

std::string shortened(std::string_view text, std::size_t width) {
  if (columns(text) <= width) return std::string(text);
  if (width == 0) return {};
  const std::size_t tail = (width - 1) / 2;
  std::string result(first_columns(text, width - 1 - tail));
  return result.append("…").append(last_columns(text, tail));
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

std::vector<std::size_t> Table::natural_widths() const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    std::size_t widest = columns(columns_[i].title);
    for (const auto& row : rows_) widest = std::max(widest, columns(row[i].text));
    result.push_back(widest);
  }
  return result;
}

/// Width zero: the column is not shown. What is always shown should be readable: it counts for
/// twice the narrowest.
void Table::leave_out(std::vector<std::size_t>& widths, std::size_t width) const {
  while (true) {
    std::size_t narrowest = 0;
    std::size_t last = columns_.size();
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (widths[i] == 0) continue;
      const std::size_t text = spacing_.narrowest * (columns_[i].rank == 0 ? 2 : 1);
      const std::size_t least = columns_[i].number ? widths[i] : std::min(widths[i], text);
      narrowest += least + (narrowest == 0 ? 0 : spacing_.gap);
      const bool later = last == columns_.size() || columns_[i].rank > columns_[last].rank;
      if (columns_[i].rank > 0 && later) last = i;
    }
    if (narrowest <= width || last == columns_.size()) return;
    widths[last] = 0;
  }
}

std::vector<std::size_t> Table::widths(std::size_t width) const {
  std::vector<std::size_t> result = natural_widths();
  if (width == 0 || result.empty()) return result;
  leave_out(result, width);
  std::size_t total = 0;
  for (const std::size_t one : result) total += one + (one == 0 || total == 0 ? 0 : spacing_.gap);
  while (total > width) {
    std::size_t widest = columns_.size();
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (columns_[i].number || result[i] <= spacing_.narrowest) continue;
      if (widest == columns_.size() || result[i] > result[widest]) widest = i;
    }
    if (widest == columns_.size()) break;
    --result[widest];
    --total;
  }
  return result;
}

std::string Table::text(std::size_t width, bool colour) const {
  const auto fitted = widths(width);
  std::string result;
  const auto add_line = [&](auto&& cell) {
    std::string line;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (fitted[i] == 0) continue;
      if (!line.empty()) line.append(spacing_.gap, ' ');
      const auto [text, paint] = cell(i);
      const std::string fitting = padded(shortened(text, fitted[i]), fitted[i], columns_[i].number);
      line += painted(fitting, paint, colour);
    }
    strip_end(line);
    result += line + "\n";
  };
  add_line([&](std::size_t i) { return Cell{columns_[i].title, Paint::bold}; });
  for (const auto& row : rows_) add_line([&](std::size_t i) { return row[i]; });
  return result;
}

}  // namespace mauve::ctl
