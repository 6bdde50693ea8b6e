// SPDX-License-Identifier: LGPL-3.0-or-later
#include "storm_oracle.h"

#include <gtest/gtest.h>

#include <iterator>

namespace mauve::test {
void StormOracle::check_status(const Json& components, Moment from, Moment to) {
  const std::lock_guard lock(mutex_);
  for (const auto& row : components) {
    const std::string name = row.value("name", "");
    if (!orders_.must_stand(name, from, to)) continue;
    ++stood_;
    if (row.value("state", "") != "stopped" || !row.contains("stopped_by")) {
      violate_(name + " is under the stop of a user, and a status that was asked for after event " +
               std::to_string(from) + " says: " + row.dump());
    }
  }
}

void StormOracle::check_content(const Json& architecture, Moment from, bool after_restart) {
  const std::lock_guard lock(mutex_);
  for (const auto& [name, component] : architecture["components"].items()) {
    const auto value =
        component.value("properties", Json::object()).value("shell.size", std::int64_t{0});
    const auto found = stamps_.find(value);
    if (found == stamps_.end()) continue;
    const Stamp& stamp = found->second;
    if (stamp.outcome == Outcome::refused && stamp.answered < from) {
      violate_(name + " has the value " + std::to_string(value) + " of a refused change");
    }
    if (after_restart && stamp.undone < from) {
      violate_(name + " has the value " + std::to_string(value) + " of generation " +
               std::to_string(stamp.generation) + ", which was undone");
    }
  }
}

void StormOracle::check_history(const Json& items) {
  const std::lock_guard lock(mutex_);
  for (const auto& item : items) {
    const auto number = item.value("generation", std::uint64_t{0});
    const Row row{item.value("command", ""), item.value("boot", ""), item.value("mark", "")};
    const auto [there, fresh] = rows_.emplace(number, row);
    if (there->second.command.empty()) there->second.command = row.command;  // answered meanwhile
    if (there->second.command != row.command || there->second.boot != row.boot) {
      violate_("generation " + std::to_string(number) + " was made by " + there->second.command +
               " and is now by " + row.command);
    }
    if (there->second.mark == "rolled_back" && row.mark != "rolled_back") {
      violate_("generation " + std::to_string(number) + " was rolled back and is now " + row.mark);
    }
    there->second = row;
  }
  for (const auto& [number, made] : made_) {
    const auto row = rows_.find(number);
    // Of a change whose saving a kill cut off, the author is not known.
    if (row == rows_.end() || row->second.command.empty()) continue;
    if (row->second.command == made.method) continue;
    violate_("generation " + std::to_string(number) + " was answered as made by " + made.method +
             ", and the history says by " + row->second.command);
  }
}

void StormOracle::forget_lost_stops(const Json& items) {
  const std::lock_guard lock(mutex_);
  std::map<std::uint64_t, std::string> commands;
  for (const auto& item : items) {
    commands[item.value("generation", std::uint64_t{0})] = item.value("command", "");
  }
  const auto lost = [&](const auto& one) {
    const auto kept = commands.find(one.first);
    const bool its = kept != commands.end() && kept->second == one.second.method;
    return one.second.stops && !its;
  };
  missing_["stops"] += static_cast<int>(std::erase_if(made_, lost));
}

void StormOracle::check_saved(const Json& items) {
  constexpr std::size_t kFar = 90;
  const std::lock_guard lock(mutex_);
  std::set<std::uint64_t> there;
  for (const auto& item : items) there.insert(item.value("generation", std::uint64_t{0}));
  auto oldest = there.rbegin();
  if (there.size() > kFar) std::advance(oldest, kFar);
  const std::uint64_t from = there.size() > kFar ? *oldest : 0;
  for (auto it = made_.lower_bound(from); it != made_.end(); ++it) {
    const Made& made = it->second;
    if (made.saved && !there.contains(made.generation)) {
      ++missing_[made.method];
      if (!made.stops && !made.passed) {
        violate_("generation " + std::to_string(made.generation) + " of " + made.method +
                 " was answered as saved and is not in the history");
      }
    }
  }
  made_.erase(made_.begin(), made_.lower_bound(from));
}

void StormOracle::violate_(const std::string& text) {
  ++violations_;
  std::string last;
  for (const auto& event : events_) last += "\n  " + event;
  ADD_FAILURE() << "seed " << seed_ << ": " << text << "\nthe last events:" << last;
}

}  // namespace mauve::test
