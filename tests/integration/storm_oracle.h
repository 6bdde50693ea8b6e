// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rules of a storm, from the answers of mauved alone: which components must stand, which may
/// stand, which generation was confirmed, and which values must never run again.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "storm_orders.h"

namespace mauve::test {

class StormOracle {
 public:
  using Json = protocol::Json;

  explicit StormOracle(std::uint64_t seed) : seed_(seed) {}

  // Events of the storm.

  /// Its place in the order of all events.
  Moment note(const std::string& text) {
    const std::lock_guard lock(mutex_);
    return note_(text);
  }
  /// The place of a read request, which is no event of the storm.
  Moment tick() {
    const std::lock_guard lock(mutex_);
    return ++now_;
  }
  std::size_t ask(Order order, const std::string& text) {
    const std::lock_guard lock(mutex_);
    return orders_.ask(std::move(order), note_("asked    " + text));
  }
  void answer(std::size_t order, Outcome outcome, const std::string& text) {
    const std::lock_guard lock(mutex_);
    orders_.answer(order, outcome, note_(text));
  }
  /// A request that may stop components, beside the orders of users, has its answer or none.
  void moved() {
    const std::lock_guard lock(mutex_);
    moved_ = ++now_;
  }
  void stamped(std::int64_t value) {
    const std::lock_guard lock(mutex_);
    stamps_[value];
  }
  void stamp_answered(std::int64_t value, Outcome outcome, std::uint64_t generation) {
    const std::lock_guard lock(mutex_);
    auto& stamp = stamps_[value];
    stamp = {outcome, ++now_, generation};
  }
  /// The words of an answer about a generation.
  struct Made {
    std::uint64_t generation = 0;
    std::string method;
    bool saved = false;
    bool stops = false;   ///< it only stops, and is saved itself before its generation is
    bool passed = false;  ///< the answer says that a later generation was saved in its place
  };
  void made(const Made& one) {
    const std::lock_guard lock(mutex_);
    const auto [there, fresh] = made_.emplace(one.generation, one);
    if (fresh) return;
    violate_("generation " + std::to_string(one.generation) + " is answered as made by " +
             one.method + " and by " + there->second.method);
  }
  void confirmed(std::uint64_t generation) {
    const std::lock_guard lock(mutex_);
    confirmed_ = std::max(confirmed_, generation);
  }
  void undone(const Json& generations) {
    const std::lock_guard lock(mutex_);
    ++now_;
    for (auto& [value, stamp] : stamps_) {
      const bool its =
          std::find(generations.begin(), generations.end(), stamp.generation) != generations.end();
      if (its && stamp.generation != 0 && stamp.undone == kNotYet) stamp.undone = now_;
    }
  }

  // Checks.

  /// A component whose stop was answered does not run in a status that was asked for after it.
  void check_status(const Json& components, Moment from, Moment to);
  /// No value of a refused change runs, and after a restart none of a change that was undone.
  void check_content(const Json& architecture, Moment from, bool after_restart);
  /// The history tells the same about each generation as its answer, and never anything else later.
  void check_history(const Json& items);
  /// After an end. A stop is answered when it is saved itself, before its generation is: a crash
  /// may have freed the number.
  void forget_lost_stops(const Json& items);
  /// A generation that was answered as saved is in the history, as far as that reaches back.
  void check_saved(const Json& items);
  void violate(const std::string& text) {
    const std::lock_guard lock(mutex_);
    violate_(text);
  }

  // Knowledge about the present.

  [[nodiscard]] bool may_stand(const std::string& component) const {
    const std::lock_guard lock(mutex_);
    return orders_.may_stand(component);
  }
  [[nodiscard]] bool must_stand(const std::string& component) const {
    const std::lock_guard lock(mutex_);
    return orders_.must_stand(component, kNotYet, kNotYet);
  }
  /// Such a request was under way at this moment or later. Asked when no mauved runs.
  [[nodiscard]] bool moved_since(Moment from) const {
    const std::lock_guard lock(mutex_);
    return moved_ > from;
  }
  /// The newest generation that an answer calls confirmed.
  [[nodiscard]] std::uint64_t confirmed() const {
    const std::lock_guard lock(mutex_);
    return confirmed_;
  }
  [[nodiscard]] int violations() const { return violations_; }
  [[nodiscard]] std::uint64_t stood() const {
    const std::lock_guard lock(mutex_);
    return stood_;
  }
  [[nodiscard]] std::map<std::string, int> missing() const {
    const std::lock_guard lock(mutex_);
    return missing_;
  }

 private:
  static constexpr std::size_t kReported = 40;
  static constexpr std::size_t kLongest = 240;  ///< characters of an event

  Moment note_(const std::string& text) {
    events_.push_back(std::to_string(++now_) + " " + text.substr(0, kLongest));
    if (events_.size() > kReported) events_.pop_front();
    return now_;
  }
  void violate_(const std::string& text);

  const std::uint64_t seed_;
  mutable std::mutex mutex_;  ///< guards the members below
  Moment now_ = 0;
  Moment moved_ = 0;
  std::deque<std::string> events_;
  UserOrders orders_;
  std::map<std::int64_t, Stamp> stamps_;
  std::map<std::uint64_t, Made> made_;  ///< that the history may still have
  std::map<std::uint64_t, Row> rows_;
  std::map<std::string, int> missing_;  ///< generations that were not in the history, by method
  std::uint64_t confirmed_ = 0;
  std::uint64_t stood_ = 0;  ///< rows of a status under a stop
  std::atomic<int> violations_{0};
};

}  // namespace mauve::test
