// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/way_back.h"

#include <algorithm>

namespace mauve::daemon {

namespace {

using Json = protocol::Json;

bool is_of_same(const Json& a, const Json& b) {
  return a["kind"] == b["kind"] && a["address"] == b["address"];
}

/// A later change of the same address: only the value at the end counts.
void add_later(const Json& line, Json& all) {
  const auto earlier =
      std::ranges::find_if(all, [&](const Json& one) { return is_of_same(one, line); });
  if (earlier == all.end()) {
    all.push_back(line);
  } else {
    (*earlier)["new"] = line["new"];
  }
}

const char* op_of(const Json& before, const Json& after) {
  if (before.is_null()) {
    return "add";
  }
  return after.is_null() ? "remove" : "change";
}

}  // namespace

void WayBackLines::remember(std::uint64_t generation, const Json& lines) {
  if (lines.is_array() && !lines.empty()) {
    lines_[generation] = lines;
  }
  if (lines_.size() > kMost) {
    lines_.erase(lines_.begin());
  }
}

Json WayBackLines::back_from(const std::vector<std::uint64_t>& changes) const {
  Json made = Json::array();
  for (const auto generation : changes) {
    if (const auto found = lines_.find(generation); found != lines_.end()) {
      std::ranges::for_each(found->second, [&](const Json& line) { add_later(line, made); });
    }
  }
  Json back = Json::array();
  for (const auto& line : made) {
    if (line["old"] != line["new"]) {
      back.push_back({{"op", op_of(line["new"], line["old"])},
                      {"kind", line["kind"]},
                      {"address", line["address"]},
                      {"old", line["new"]},
                      {"new", line["old"]}});
    }
  }
  return back;
}

void WayBackLines::forget(const std::vector<std::uint64_t>& changes) {
  for (const auto generation : changes) {
    lines_.erase(generation);
  }
}

}  // namespace mauve::daemon
