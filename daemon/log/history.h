// SPDX-License-Identifier: LGPL-3.0-or-later
/// The last records, for `mauvectl logs`.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "log/event.h"

namespace mauve::logging {

/// The records that a reader wants.
struct Filter {
  Level level = Level::debug;  ///< this one and worse
  std::string component;       ///< empty: all
  std::optional<std::chrono::system_clock::time_point> since = {};
  std::string text = {};  ///< somewhere in its text, component or event; capitals count as small

  [[nodiscard]] bool accepts(const Record& record) const;
};

/// A bounded memory of records, and the followers that get each new one. [any]
class History {
 public:
  using Follower = std::function<void(const Record&)>;

  explicit History(std::size_t capacity) : capacity_(capacity) {}

  /// Keeps the record, drops the oldest one if full, and notifies the followers. [log]
  void add(const Record& record);

  /// The newest `count` records that pass, in the order of their times.
  [[nodiscard]] std::vector<Record> tail(std::size_t count, const Filter& filter) const;

  /// The records that are missing from the history.
  struct Losses {
    std::uint64_t lost = 0;  ///< events that never became records: too many were reported
    std::uint64_t gone = 0;  ///< records older than the oldest one that is kept
  };
  /// Since that time; `component`: of that one and of the daemon's own queue only.
  [[nodiscard]] Losses losses(std::chrono::system_clock::time_point since,
                              const std::string& component) const;

  /// The state with which follow() begins.
  struct Following {
    std::uint64_t id = 0;
    std::vector<Record> kept;  ///< as tail() gives them
  };

  /// Calls `follower` on the [log] thread for every later record that passes; it must not wait and
  /// must not write to the log. No record is missed or seen twice between `kept` and those.
  Following follow(std::size_t count, Filter filter, Follower follower);

  /// The follower gets no record that comes after the return; it may still get the one that [log]
  /// hands out at that moment.
  void unfollow(std::uint64_t id);

 private:
  struct Entry {
    Filter filter;
    Follower follower;
  };
  using Entries = std::vector<std::shared_ptr<const Entry>>;

  [[nodiscard]] std::vector<Record> tail_locked(std::size_t count, const Filter& filter) const
      MAUVE_REQUIRES(mutex_);

  const std::size_t capacity_;
  mutable Mutex mutex_;  ///< not held while a follower is called: they may be many
  std::deque<Record> records_ MAUVE_GUARDED_BY(mutex_);
  std::map<std::uint64_t, std::shared_ptr<const Entry>> followers_ MAUVE_GUARDED_BY(mutex_);
  std::uint64_t next_id_ MAUVE_GUARDED_BY(mutex_) = 1;
};

}  // namespace mauve::logging
