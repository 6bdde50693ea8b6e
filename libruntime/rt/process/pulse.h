// SPDX-License-Identifier: LGPL-3.0-or-later
/// Pulse: whether a thread of mauved still turns in its loop. The watchdog of the service manager
/// gets no sign of life while one does not (daemon/monitor/heartbeat.h). There is one list for the
/// program and for libmauve, so its code is in this layer: libmauve alone has it.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "mauve/time.h"

namespace mauve::rt {

/// Each thread of mauve that lives long has one, unless the watchdog asks it directly, and calls
/// turn() at each turn of its loop. A thread that waits for work turns all the same, each kTurn.
class Pulse {
 public:
  /// A thread that has nothing to do waits for so long at most.
  static constexpr Duration kTurn = std::chrono::seconds(1);
  /// The longest time between two turns, on a slow machine too.
  static constexpr Duration kBound = std::chrono::seconds(5);
  /// Another observer has the bound of the work that begins now: it may take long.
  static constexpr Duration kBoundedElsewhere = Duration::max();

  struct Silent {
    std::string name;
    Duration lasted;
  };

  /// `name`: as in docs/concepts/threads.md, without brackets. [any but rt]
  explicit Pulse(std::string name);
  ~Pulse();
  Pulse(const Pulse&) = delete;
  Pulse& operator=(const Pulse&) = delete;

  /// The thread turns now, and does so again within `bound`. [any]
  void turn(Duration bound = kBound) {
    turns_.fetch_add(1, std::memory_order_relaxed);
    bound_.store(bound.count(), std::memory_order_release);  // last: a new bound is of a new turn
  }

  /// The threads that have not turned within their bounds, by the time of the observer: `passed`
  /// since the look before, of which a look counts kMostOfALook. So a process that stood still as
  /// a whole blames no thread. One observer a process. [any but rt]
  [[nodiscard]] static std::vector<Silent> look(Duration passed);

  static constexpr Duration kMostOfALook = std::chrono::seconds(2);

 private:
  struct All;
  static All& all();

  const std::string name_;
  std::atomic<std::uint64_t> turns_{0};
  std::atomic<Duration::rep> bound_{kBound.count()};
  std::uint64_t seen_ = 0;  ///< [observer]
  Duration silent_{0};      ///< [observer]
};

}  // namespace mauve::rt
