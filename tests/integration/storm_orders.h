// SPDX-License-Identifier: LGPL-3.0-or-later
/// The orders of users in a storm, and what answers and the saved generations say about changes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "protocol/message.h"
#include "support/temp_dir.h"

namespace mauve::test {

/// The place of an event in the order of all events of the test.
using Moment = std::uint64_t;
inline constexpr Moment kNotYet = std::numeric_limits<Moment>::max();

/// `unknown`: mauved ended before its answer, or the answer says that it may be done.
enum class Outcome : std::uint8_t { open, done, refused, unknown };

/// A stop or a start of components by a user. No names: all components, also those that join later.
struct Order {
  bool starts = false;
  std::set<std::string> names = {};
  bool lasts = true;  ///< no rollback of its change brings back the stop that it ends
  Moment asked = 0;
  Moment answered = kNotYet;
  Outcome outcome = Outcome::open;

  [[nodiscard]] bool means(const std::string& component) const {
    return names.empty() || names.contains(component);
  }
};

/// The stops and starts of users. Two orders whose times overlap may have come in either order.
class UserOrders {
 public:
  std::size_t ask(Order order, Moment now) {
    order.asked = now;
    orders_.push_back(std::move(order));
    return first_ + orders_.size() - 1;
  }
  void answer(std::size_t number, Outcome outcome, Moment now) {
    if (number < first_) return;
    auto& order = orders_.at(number - first_);
    order.answered = now;
    order.outcome = outcome;
    forget();
  }
  /// A stop was answered before `from`, and no start can have followed it until `to`.
  [[nodiscard]] bool must_stand(const std::string& component, Moment from, Moment to) const {
    return std::ranges::any_of(orders_, [&](const Order& stop) {
      if (stop.starts || !stop.means(component) || stop.outcome != Outcome::done) return false;
      return stop.answered < from && !may_be_started(component, stop, to);
    });
  }
  /// A stop may be in force, since no start has followed it for certain.
  [[nodiscard]] bool may_stand(const std::string& component) const {
    return std::ranges::any_of(orders_, [&](const Order& stop) {
      if (stop.starts || !stop.means(component) || stop.outcome == Outcome::refused) return false;
      return !is_started(component, stop);
    });
  }

 private:
  [[nodiscard]] bool may_be_started(const std::string& component, const Order& stop,
                                    Moment to) const {
    return std::ranges::any_of(orders_, [&](const Order& start) {
      return start.starts && start.means(component) && start.outcome != Outcome::refused &&
             start.answered > stop.asked && start.asked < to;
    });
  }
  [[nodiscard]] bool is_started(const std::string& component, const Order& stop) const {
    return std::ranges::any_of(orders_, [&](const Order& start) {
      return start.starts && start.lasts && start.means(component) &&
             start.outcome == Outcome::done && start.asked > stop.answered;
    });
  }
  /// An order for all that has its answer makes those that were answered before it superfluous.
  void forget() {
    constexpr std::size_t kMany = 2000;
    if (orders_.size() < kMany) return;
    for (std::size_t i = orders_.size(); i-- > 0;) {
      const Order& all = orders_[i];
      if (!all.names.empty() || all.outcome != Outcome::done) continue;
      while (orders_.front().answered < all.asked) {
        orders_.pop_front();
        ++first_;
      }
      return;
    }
  }

  std::deque<Order> orders_;
  std::size_t first_ = 0;  ///< the number of the first one that is kept
};

/// A value that one request brings and no other one: it shows whose content runs.
struct Stamp {
  Outcome outcome = Outcome::open;
  Moment answered = kNotYet;
  std::uint64_t generation = 0;
  Moment undone = kNotYet;  ///< an undo of its change was answered
};

/// A change that was answered as applied.
struct Made {
  std::uint64_t generation = 0;
  std::string method;
  bool saved = false;
};

/// The place of a generation in the history.
struct Row {
  std::string command;
  std::string boot;
  std::string mark;
};

/// A saved generation, read while no mauved runs.
struct Saved {
  std::string mark;
  protocol::Json content;
};

inline std::map<std::uint64_t, Saved> read_generations(const std::filesystem::path& folder) {
  std::map<std::uint64_t, Saved> all;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    const auto text = TempDir::read(entry.path());
    const auto brace = text.find('{');
    const auto end = text.find('\n');
    if (brace >= end || end == std::string::npos) continue;
    const auto head = protocol::Json::parse(text.substr(brace, end - brace), nullptr, false);
    auto content = protocol::Json::parse(text.substr(end), nullptr, false);
    if (!head.is_object() || !content.is_object()) continue;
    all[std::stoull(entry.path().stem().string())] = {head.value("mark", ""), std::move(content)};
  }
  return all;
}

inline bool starts(const protocol::Json& architecture, const std::string& component) {
  return architecture["components"].value(component, protocol::Json::object()).value("start", true);
}

}  // namespace mauve::test
