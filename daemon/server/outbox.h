// SPDX-License-Identifier: LGPL-3.0-or-later
/// Notifications on their way to one client: bounded, and never a reason to wait.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "base/mutex.h"
#include "protocol/framing.h"
#include "protocol/message.h"

namespace mauve::server {

/// Producers push from any thread; the session takes lines out on [io]. When it is full, new
/// notifications are dropped, and the loss is reported at the point where it happened:
/// {"method":"dropped","params":{"sub","address","count"}}.
class Outbox {
 public:
  /// `ready` is called, from the pushing thread, when lines wait in the queue; it must not wait.
  Outbox(std::size_t max_bytes, std::size_t max_subscriptions, std::function<void()> ready);

  /// [any] The number of a new subscription, or nothing when the client has too many.
  [[nodiscard]] std::optional<std::uint64_t> open();
  /// [any] Ends a subscription and forgets its lines; false when there is no such one.
  bool close(std::uint64_t sub);
  /// [any] Nothing is accepted any more: the client is gone.
  void shut();
  [[nodiscard]] bool is_shut() const;

  /// [any but rt] Queues {"method","params":{"sub",...}}. `address` names the source in a `dropped`
  /// notification, empty for none. False when the subscription has ended: stop producing.
  bool push(std::uint64_t sub, const std::string& address, std::string_view method,
            const protocol::NotificationText& params);

  /// [any but rt] Informs the client that `count` values were lost before they came here.
  void lose(std::uint64_t sub, const std::string& address, std::uint64_t count);

  /// [io] The next line with its end, or nothing.
  [[nodiscard]] std::optional<std::string> take();

  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::size_t subscriptions() const;
  /// Notifications dropped so far.
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  using Source = std::pair<std::uint64_t, std::string>;

  struct Item {
    std::uint64_t sub;
    std::string line;
  };

  void queue(std::uint64_t sub, std::string line) MAUVE_REQUIRES(mutex_);
  void announce(std::map<Source, std::uint64_t>::iterator lost) MAUVE_REQUIRES(mutex_);

  const std::size_t max_bytes_;
  const std::size_t max_subscriptions_;
  const std::function<void()> ready_;
  mutable Mutex mutex_;
  std::deque<Item> items_ MAUVE_GUARDED_BY(mutex_);
  std::map<Source, std::uint64_t> lost_ MAUVE_GUARDED_BY(mutex_);  ///< not announced yet
  std::set<std::uint64_t> open_ MAUVE_GUARDED_BY(mutex_);
  std::size_t bytes_ MAUVE_GUARDED_BY(mutex_) = 0;
  std::uint64_t dropped_ MAUVE_GUARDED_BY(mutex_) = 0;
  std::uint64_t next_ MAUVE_GUARDED_BY(mutex_) = 1;
  bool notified_ MAUVE_GUARDED_BY(mutex_) = false;  ///< ready_ was called; no line was read since
  bool shut_ MAUVE_GUARDED_BY(mutex_) = false;
};

}  // namespace mauve::server
