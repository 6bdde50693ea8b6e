// SPDX-License-Identifier: LGPL-3.0-or-later
/// From the ROS thread to real-time threads: the newest value, wait-free.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include <mauve/time.h>

namespace ros_bridge {

/// One writer and one reader at a time, on three slots: each has one of its own, the third is
/// exchanged between them.
template <typename T>
class Inbox {
 public:
  /// Takes the memory. [factory]
  Inbox() : slots_(std::make_unique<std::array<Slot, 3>>()) {}

  /// Lets `fill(T&)` write on top of some older value, and shows it when that returned true.
  /// `stamp` must grow. A value that the reader never saw is replaced: then `replaced` is true.
  /// [ros]
  template <typename F>
  bool put(mauve::Instant stamp, F&& fill, bool& replaced) {
    Slot& slot = (*slots_)[back_];
    if (!fill(slot.value)) return false;
    slot.stamp = stamp;
    const std::uint8_t before = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel);
    replaced = (before & kFresh) != 0;
    back_ = before & kSlot;
    return true;
  }

  /// The newest value; null: there never was one. Stays as it is until the next call. [rt]
  /// wait-free
  const T* newest(mauve::Instant& stamp) {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kSlot;
      any_ = true;
    }
    if (!any_) return nullptr;
    stamp = (*slots_)[front_].stamp;
    return &(*slots_)[front_].value;
  }

 private:
  static constexpr std::uint8_t kSlot = 3;
  static constexpr std::uint8_t kFresh = 4;  // not seen by the reader yet

  struct Slot {
    mauve::Instant stamp = 0;
    T value{};
  };
  std::unique_ptr<std::array<Slot, 3>> slots_;
  std::uint8_t back_ = 0;  // the writer's
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t front_ = 2;  // the reader's
  bool any_ = false;
};

}  // namespace ros_bridge
