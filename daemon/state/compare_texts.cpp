// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/compare_texts.h"

#include <map>
#include <utility>

namespace mauve::daemon {

namespace {

using protocol::Json;

/// The values of a file by their paths.
using Leaves = std::map<std::string, Json>;

void add_leaves(const std::string& path, const Json& at, Leaves& leaves) {
  if (!at.is_object() || at.empty()) {
    leaves[path] = at;
    return;
  }
  for (const auto& [key, value] : at.items()) {
    add_leaves(path.empty() ? key : path + "." + key, value, leaves);
  }
}

Leaves leaves_of(const std::string& text) {
  Leaves leaves;
  constexpr bool kThrows = false;
  constexpr bool kTakesComments = true;  // the first line of a saved generation is one
  add_leaves({}, Json::parse(text, nullptr, kThrows, kTakesComments), leaves);
  return leaves;
}

Json line(const char* op, const std::string& address, Json before, Json after) {
  return {{"op", op},
          {"kind", "file"},
          {"address", address},
          {"old", std::move(before)},
          {"new", std::move(after)}};
}

}  // namespace

Json compare_texts(const std::string& before, const std::string& after) {
  const Leaves old = leaves_of(before);
  const Leaves now = leaves_of(after);
  Json lines = Json::array();
  for (const auto& [path, value] : old) {
    const auto there = now.find(path);
    if (there == now.end()) {
      lines.push_back(line("remove", path, value, nullptr));
    } else if (there->second != value) {
      lines.push_back(line("change", path, value, there->second));
    }
  }
  for (const auto& [path, value] : now) {
    if (!old.contains(path)) {
      lines.push_back(line("add", path, nullptr, value));
    }
  }
  return lines;
}

}  // namespace mauve::daemon
