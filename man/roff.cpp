// SPDX-License-Identifier: LGPL-3.0-or-later
#include "roff.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>
#include <vector>

#include "render/words.h"

namespace mauve::man {
namespace {

constexpr std::pair<std::string_view, std::string_view> kSpellings[] = {
    {"\\", "\\e"}, {"-", "\\-"}, {"…", "..."}, {"→", "\\(->"}, {"µ", "u"},
    {"×", "x"},    {"–", "\\-"}, {"≤", "<="},  {"≥", ">="},    {"'", "\\(aq"}};

constexpr std::size_t kLongWord = 30;

std::size_t length_of(unsigned char first) {
  if (first < 0x80) return 1;
  if (first < 0xE0) return 2;
  return first < 0xF0 ? 3 : 4;
}

/// A character that roff knows by its number only.
std::string numbered(std::string_view bytes) {
  if (bytes.size() < 2) return "?";
  unsigned code = static_cast<unsigned char>(bytes[0]) & (0xFFU >> (bytes.size() + 1));
  for (const char byte : bytes.substr(1)) {
    code = code << 6U | (static_cast<unsigned char>(byte) & 0x3FU);
  }
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "\\[u%04X]", code);
  return text.data();
}

std::string escaped(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const auto known =
        std::find_if(std::begin(kSpellings), std::end(kSpellings),
                     [&](const auto& spelling) { return text.starts_with(spelling.first); });
    std::size_t size = std::min(length_of(static_cast<unsigned char>(text[0])), text.size());
    if (known != std::end(kSpellings)) {
      size = known->first.size();
      result += known->second;
    } else {
      const bool ascii = static_cast<unsigned char>(text[0]) < 0x80;
      result += ascii ? text.substr(0, 1) : numbered(text.substr(0, size));
    }
    text.remove_prefix(size);
  }
  return result;
}

/// A full stop in front of a line would be a request.
std::string guarded(std::string line) {
  if (line.starts_with('.')) line.insert(0, "\\&");
  return line;
}

using ctl::lines_of;

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

class Converter {
 public:
  std::string convert(std::string_view markdown) {
    for (const std::string_view line : lines_of(markdown)) take(line);
    end_block();
    return std::move(result_);
  }

 private:
  void take(std::string_view line) {
    if (line.starts_with("```")) return fence();
    if (fenced_) {
      code_ += std::string(line) + "\n";
    } else if (trimmed(line).empty()) {
      end_block();
    } else if (line.starts_with('#')) {
      end_block();
      result_ += ".SS " + plain(trimmed(line.substr(line.find_first_not_of('#')))) + "\n";
    } else if (line.starts_with('|')) {
      end_text();
      rows_.push_back(cells_of(line));
    } else if (line.starts_with("- ")) {
      end_block();
      listed_ = true;
      text_ = trimmed(line.substr(2));
    } else {
      text_ += (text_.empty() ? "" : " ") + std::string(trimmed(line));
    }
  }

  void fence() {
    if (!fenced_) end_block();
    if (fenced_) result_ += verbatim(std::exchange(code_, {}));
    fenced_ = !fenced_;
  }

  void end_block() {
    end_text();
    if (rows_.empty()) return;
    const auto rows = std::exchange(rows_, {});
    // Wide tables hold several narrow ones side by side, each of two columns.
    for (std::size_t row = 2; row < rows.size(); ++row) {
      const bool pairs = rows[0].size() > 3;
      const std::size_t step = pairs ? 2 : rows[row].size();
      for (std::size_t at = 0; at < rows[row].size(); at += step) add_row(rows[row], at, step);
    }
  }

  void add_row(const std::vector<std::string>& cells, std::size_t at, std::size_t count) {
    if (cells[at].empty()) return;
    std::string text;
    for (std::size_t i = at + 1; i < std::min(at + count, cells.size()); ++i) {
      if (!cells[i].empty()) text += (text.empty() ? "" : "; ") + cells[i];
    }
    result_ += item(inline_roff(cells[at]), inline_roff(text));
  }

  void end_text() {
    if (text_.empty()) return;
    const std::string text = inline_roff(std::exchange(text_, {}));
    result_ +=
        std::exchange(listed_, false) ? ".IP \\(bu 2\n" + text + "\n" : ".PP\n" + text + "\n";
  }

  std::string result_;
  std::string text_;
  std::string code_;
  std::vector<std::vector<std::string>> rows_;
  bool fenced_ = false;
  bool listed_ = false;
};

}  // namespace

std::string plain(std::string_view text) { return guarded(escaped(text)); }

std::string bold(std::string_view text) {
  std::string result = "\\fB";
  for (std::size_t at = 0; at < text.size();) {
    // Where a long word may be broken into lines.
    const std::size_t end = text.size() > kLongWord ? text.find_first_of(",/|", at) : text.size();
    const std::size_t next = std::min(end == std::string_view::npos ? end : end + 1, text.size());
    result += escaped(text.substr(at, next - at)) + (next < text.size() ? "\\:" : "");
    at = next;
  }
  return result + "\\fP";
}

std::string italic(std::string_view text) { return "\\fI" + escaped(text) + "\\fP"; }

std::string verbatim(std::string_view lines) {
  std::string result = ".PP\n.nf\n.RS 4\n";
  for (const std::string_view line : lines_of(lines)) result += plain(line) + "\n";
  return result + ".RE\n.fi\n";
}

std::string item(std::string_view tag, std::string_view text) {
  const std::string below = text.empty() ? "" : guarded(std::string(text)) + "\n";
  return ".TP\n" + guarded(std::string(tag)) + "\n" + below;
}

std::string inline_roff(std::string_view markdown) {
  std::string result;
  const auto delimited = [&](std::string_view mark) -> std::string_view {
    if (!markdown.starts_with(mark)) return {};
    const auto end = markdown.find(mark, mark.size());
    if (end == std::string_view::npos) return {};
    return markdown.substr(mark.size(), end - mark.size());
  };
  while (!markdown.empty()) {
    const auto link = markdown.find("](");
    if (const auto code = delimited("`"); !code.empty()) {
      result += bold(code);
      markdown.remove_prefix(code.size() + 2);
    } else if (const auto strong = delimited("**"); !strong.empty()) {
      result += inline_roff(strong);
      markdown.remove_prefix(strong.size() + 4);
    } else if (markdown.starts_with('[') && link < markdown.find(']') + 1) {
      result += inline_roff(markdown.substr(1, link - 1));
      markdown.remove_prefix(std::min(markdown.find(')', link), markdown.size() - 1) + 1);
    } else {
      const std::size_t next = std::min(markdown.find_first_of("`*[", 1), markdown.size());
      result += escaped(markdown.substr(0, next));
      markdown.remove_prefix(next);
    }
  }
  return guarded(result);
}

std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells;
  std::string cell;
  bool code = false;
  for (const char c : trimmed(line).substr(1)) {
    code = c == '`' ? !code : code;
    if (c != '|' || code) {
      cell += c;
      continue;
    }
    cells.emplace_back(trimmed(cell));
    cell.clear();
  }
  return cells;
}

std::string roff(std::string_view markdown) { return Converter().convert(markdown); }

std::string section(std::string_view markdown, std::string_view name) {
  const std::string heading = "## " + std::string(name);
  std::string result;
  bool inside = false;
  for (const std::string_view line : lines_of(markdown)) {
    if (line.starts_with("## ")) {
      inside = line == heading;
    } else if (inside) {
      result += std::string(line) + "\n";
    }
  }
  return result;
}

}  // namespace mauve::man
