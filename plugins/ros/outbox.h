// SPDX-License-Identifier: LGPL-3.0-or-later
/// From a real-time thread to the ROS thread: a bounded, wait-free queue.
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include <mauve/time.h>

namespace ros_bridge {

/// One writer and one reader at a time. A message that does not fit is refused: the reader is
/// behind, and the writer must not wait.
template <typename T>
class Outbox {
 public:
  /// Takes the memory. [factory]
  explicit Outbox(std::size_t capacity) : items_(capacity + 1) {}

  /// Lets `fill(T&)` write an item on top of some older one; false: full. [rt] wait-free
  template <typename F>
  bool put(mauve::Instant stamp, F&& fill) {
    const std::size_t at = head_.load(std::memory_order_relaxed);
    const std::size_t next = (at + 1) % items_.size();
    if (next == tail_.load(std::memory_order_acquire)) return false;
    fill(items_[at].value);
    items_[at].stamp = stamp;
    head_.store(next, std::memory_order_release);
    return true;
  }

  /// Shows the oldest item to `visit(stamp, const T&)` and drops it; false: empty. [ros]
  template <typename F>
  bool take(F&& visit) {
    const std::size_t at = tail_.load(std::memory_order_relaxed);
    if (at == head_.load(std::memory_order_acquire)) return false;
    const Dropped dropped{tail_, (at + 1) % items_.size()};
    visit(items_[at].stamp, static_cast<const T&>(items_[at].value));
    return true;
  }

 private:
  struct Item {
    mauve::Instant stamp = 0;
    T value{};
  };
  /// Also when the visitor throws: else that item would be the last one.
  struct Dropped {
    std::atomic<std::size_t>& tail;
    std::size_t next;
    ~Dropped() { tail.store(next, std::memory_order_release); }
  };

  std::vector<Item> items_;
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace ros_bridge
