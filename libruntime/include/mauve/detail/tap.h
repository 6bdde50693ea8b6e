// SPDX-License-Identifier: LGPL-3.0-or-later
/// Tap: a bounded copy of every value written to a resource, for `watch` and recording.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

#include <mauve/result.h>
#include <mauve/time.h>

namespace mauve {

struct DataType;
class ResourceLock;

/// One listener. Values that find it full are counted, the writer never waits.
class Tap {
 public:
  /// Room for `capacity` values of `data`.
  Tap(const DataType& data, std::size_t capacity);

  /// [rt], under the resource's lock: one writer at a time. Nothing happens when closed.
  void push(const void* value, Instant stamp);
  /// Takes the oldest value; false when empty. `value` stays valid for the call. One reader.
  bool pop(const std::function<void(const void* value, Instant stamp)>& visit);
  /// Values lost since the last call.
  [[nodiscard]] std::uint64_t take_lost() { return lost_.exchange(0, std::memory_order_relaxed); }
  [[nodiscard]] const DataType& data() const { return data_; }
  /// From now on the tap takes no value. [any]
  void close() { closed_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool closed() const { return closed_.load(std::memory_order_relaxed); }

 private:
  [[nodiscard]] std::byte* slot(std::uint64_t index) const;

  const DataType& data_;
  std::size_t capacity_;
  std::size_t stride_;
  std::unique_ptr<std::byte[]> memory_;
  std::atomic<std::uint64_t> head_{0};
  std::atomic<std::uint64_t> tail_{0};
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<bool> closed_{false};
};

/// The listeners of one resource.
class TapList {
 public:
  static constexpr std::size_t kMaxTaps = 8;

  /// Refused when all slots are claimed, or the lock cannot be acquired in time. [control]
  Status attach(std::shared_ptr<Tap> tap, ResourceLock& lock);
  /// Closes the tap and gives it up. When the lock cannot be acquired in time (a writer hangs), the
  /// list keeps the tap, so that the writer may still look at it. It keeps the tap until the next
  /// attach or detach, or its own end. [control]
  void detach(Tap& tap, ResourceLock& lock);
  /// No tap is attached. [any]
  [[nodiscard]] bool empty() const { return count_.load() == 0; }
  /// [rt], under the lock; one load when no tap is attached.
  void push(const void* value, Instant stamp) {
    if (count_.load(std::memory_order_relaxed) == 0) return;
    for (const std::shared_ptr<Tap>& tap : taps_) {
      if (tap != nullptr) tap->push(value, stamp);
    }
  }

 private:
  using Taps = std::array<std::shared_ptr<Tap>, kMaxTaps>;

  void release_closed(Taps& into);

  Taps taps_;  // changed under the lock only
  std::atomic<std::size_t> count_{0};
};

}  // namespace mauve
