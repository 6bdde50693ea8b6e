// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/recovery/rollback_lines.h"

#include <algorithm>
#include <utility>

namespace mauve::daemon {

namespace {

using Json = protocol::Json;

bool is_of_same(const Json& a, const Json& b) {
  return a["kind"] == b["kind"] && a["address"] == b["address"];
}

/// Only the value at the end counts. Of a change to which no rollback belongs (a start or a stop)
/// only addresses count that an earlier one changed.
void add_later(const Json& line, bool rolls_back, Json& all) {
  const auto earlier =
      std::ranges::find_if(all, [&](const Json& one) { return is_of_same(one, line); });
  if (earlier != all.end()) {
    (*earlier)["new"] = line["new"];
  } else if (rolls_back) {
    all.push_back(line);
  }
}

const char* op_of(const Json& before, const Json& after) {
  if (before.is_null()) {
    return "add";
  }
  return after.is_null() ? "remove" : "change";
}

}  // namespace

void RollbackLines::remember(std::uint64_t generation, const Json& lines) {
  if (lines.is_array() && !lines.empty()) {
    lines_[generation] = lines;
  }
  if (lines_.size() > kMost) {
    dropped_ = lines_.begin()->first;
    lines_.erase(lines_.begin());
  }
}

void RollbackLines::expect(const std::shared_ptr<const Ongoing>& change, Json lines) {
  std::erase_if(expected_, [](const Expected& one) { return one.change.expired(); });
  if (lines.is_array() && !lines.empty()) {
    expected_.push_back({change, std::move(lines)});
  }
}

std::map<std::uint64_t, Json> RollbackLines::all() const {
  auto lines = lines_;
  for (const auto& one : expected_) {
    if (const auto change = one.change.lock(); change != nullptr && change->made() != 0) {
      lines.emplace(change->made(), one.lines);
    }
  }
  return lines;
}

bool RollbackLines::knows(const std::vector<std::uint64_t>& changes) const {
  return std::ranges::none_of(changes, [&](auto generation) { return generation <= dropped_; });
}

Json RollbackLines::back_from(const std::vector<std::uint64_t>& changes) const {
  Json made = Json::array();
  for (const auto& [generation, lines] : all()) {
    const bool rolls_back = std::ranges::find(changes, generation) != changes.end();
    for (const auto& line : lines) {
      add_later(line, rolls_back, made);
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

void RollbackLines::forget(const std::vector<std::uint64_t>& changes) {
  for (const auto generation : changes) {
    lines_.erase(generation);
  }
}

}  // namespace mauve::daemon
