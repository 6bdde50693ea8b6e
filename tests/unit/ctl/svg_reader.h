// SPDX-License-Identifier: LGPL-3.0-or-later
/// As much of a reader of SVG as tests of pictures need.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "picture/svg.h"

namespace mauve::ctl {

inline std::size_t count_in(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

inline double number_of(const std::string& element, const std::string& attribute,
                        double otherwise) {
  const auto at = element.find(" " + attribute + "=\"");
  return at == std::string::npos ? otherwise : std::stod(element.substr(at + attribute.size() + 3));
}

inline std::string unescaped(std::string text) {
  for (const auto& [entity, letter] : {std::pair<std::string, std::string>{"&lt;", "<"},
                                       {"&gt;", ">"},
                                       {"&quot;", "\""},
                                       {"&amp;", "&"}}) {
    for (auto at = text.find(entity); at != std::string::npos; at = text.find(entity, at + 1)) {
      text.replace(at, entity.size(), letter);
    }
  }
  return text;
}

/// The first text that leaves the picture; empty: none does.
inline std::string outside(const std::string& svg) {
  const double width = number_of(svg, "width", 0);
  const double height = number_of(svg, "height", 0);
  for (auto at = svg.find("<text "); at != std::string::npos; at = svg.find("<text ", at + 1)) {
    const auto begin = svg.find('>', at) + 1;
    const std::string element = svg.substr(at, begin - at);
    const std::string words = unescaped(svg.substr(begin, svg.find('<', begin) - begin));
    const double long_as = text_width(words, number_of(element, "font-size", 13));
    const bool middle = element.find("\"middle\"") != std::string::npos;
    const bool end = element.find("\"end\"") != std::string::npos;
    const double left = number_of(element, "x", 0) - (middle ? long_as / 2 : end ? long_as : 0);
    const double y = number_of(element, "y", 0);
    if (left < 0 || left + long_as > width || y < 0 || y > height) return element + words;
  }
  return {};
}

/// The first tag that is not closed in its order; empty: all are.
inline std::string unbalanced(const std::string& svg) {
  std::vector<std::string> open;
  for (auto at = svg.find('<'); at != std::string::npos; at = svg.find('<', at + 1)) {
    const auto end = svg.find('>', at);
    if (end == std::string::npos) return svg.substr(at, 20);
    if (svg[end - 1] == '/') continue;
    const std::string name = svg.substr(at + 1, svg.find_first_of(" >", at) - at - 1);
    if (!name.starts_with('/')) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name.substr(1)) {
      return name;
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : open.back();
}

}  // namespace mauve::ctl
