// SPDX-License-Identifier: LGPL-3.0-or-later
/// The changes on probation, as the answers describe them: which of them a change joins, which one
/// it ends, and where an undo rolls back to.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "protocol/message.h"

namespace mauve::test {

/// A change on probation, with those that it joined.
struct OpenChange {
  std::uint64_t before = 0;  ///< the generation that it rolls back to
  std::uint64_t newest = 0;
  std::map<std::string, protocol::Json> components;  ///< as they were; null: there was none
  /// Those that were stopped or started by request since they were changed last.
  std::set<std::string> ordered = {};

  /// A component that was stopped or started between the two changes is as it was before this one.
  void join(const OpenChange& earlier) {
    before = std::min(before, earlier.before);
    for (auto [component, content] : earlier.components) {
      const bool was_ordered = earlier.ordered.contains(component);
      const auto later = components.find(component);
      if (later == components.end() && was_ordered) ordered.insert(component);
      if (later != components.end() && was_ordered) content = with_start_of(content, later->second);
      components[component] = content;
    }
  }

  static protocol::Json with_start_of(protocol::Json content, const protocol::Json& other) {
    if (content.is_null()) return content;
    content.erase("start");
    if (other.is_object() && other.contains("start")) content["start"] = other["start"];
    return content;
  }
};

class OpenChanges {
 public:
  using Json = protocol::Json;

  [[nodiscard]] bool empty() const { return open_.empty(); }
  void clear() { open_.clear(); }
  /// The oldest generation that holds a change on probation.
  [[nodiscard]] std::uint64_t first_after(std::uint64_t newest) const {
    for (const auto& one : open_) newest = std::min(newest, one.before + 1);
    return newest;
  }
  /// Something was stopped or started.
  void order() {
    for (auto& one : open_) {
      for (const auto& [component, content] : one.components) one.ordered.insert(component);
    }
  }
  /// The notes of its answer state which probations a change joins, and which it ends. One that has
  /// no probation of its own (not `has_probation`) is on probation when it joins another.
  void add(OpenChange fresh, const Json& notes, bool has_probation) {
    bool joins = false;
    std::erase_if(open_, [&](const OpenChange& earlier) {
      const auto note = reported_about(notes, earlier.newest);
      if (note.find(" joins ") == std::string::npos) return !note.empty();
      joins = true;
      fresh.join(earlier);
      return true;
    });
    if (joins || has_probation) open_.push_back(std::move(fresh));
  }
  /// Takes the newest change back; components that were stopped or started since then stay so.
  /// Returns the generation that it rolls back to.
  std::uint64_t undo(Json& system) {
    const OpenChange newest = std::move(open_.back());
    open_.pop_back();
    auto& components = system["components"];
    for (const auto& [component, before] : newest.components) {
      const Json now = components.value(component, Json::object());
      components.erase(component);
      if (before.is_null()) continue;
      components[component] =
          newest.ordered.contains(component) ? OpenChange::with_start_of(before, now) : before;
    }
    return newest.before;
  }

 private:
  static std::string reported_about(const Json& notes, std::uint64_t generation) {
    const auto last = std::to_string(generation) + " (";
    for (const auto& one : notes) {
      const auto note = one.get<std::string>();
      const bool names = note.find("generation " + last) != std::string::npos ||
                         note.find(" to " + last) != std::string::npos;
      if (names) return note;
    }
    return {};
  }

  std::vector<OpenChange> open_;  ///< the newest last
};

}  // namespace mauve::test
