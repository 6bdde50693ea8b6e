// SPDX-License-Identifier: LGPL-3.0-or-later
/// TraceRing: the last records of one thread. Its writer never waits and never looks at readers;
/// the oldest records are overwritten. A reader copies records first, then drops those that may
/// have been overwritten meanwhile, and counts them.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "rt/process/cache.h"
#include "rt/time/ticks.h"

#include <mauve/host/clock.h>
#include <mauve/trace.h>

namespace mauve::rt {

/// As it stands in a ring.
struct TraceEntry {
  Instant time = 0;
  TraceKind kind = TraceKind::lost;
  std::uint32_t name = 0;   ///< 24 bits
  std::uint32_t small = 0;  ///< a count
  std::int64_t value = 0;
};

/// One writer, one reader.
class TraceRing {
 public:
  static constexpr std::size_t kCapacity = 1024;

  /// `simulated`: the clock of a simulation; null: the time is that of the machine.
  explicit TraceRing(const Clock* simulated = nullptr) : simulated_(simulated) {}

  /// [rt]
  [[nodiscard]] Instant now() const {
    return simulated_ == nullptr ? fast_now() : simulated_->now();
  }
  /// The same, from a reading of the machine's clock that the caller has already; 0: it has none.
  [[nodiscard]] Instant now(Instant is_direct) const {
    return simulated_ == nullptr && is_direct != 0 ? is_direct : now();
  }

  [[nodiscard]] bool simulated() const { return simulated_ != nullptr; }

  /// [rt] Time never goes back: a record is not earlier than the one before.
  void push(TraceKind kind, Instant time, std::uint32_t name, std::uint64_t small,
            std::int64_t value) {
    last_ = std::max(last_, time);
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    Slot& slot = slots_[head % kCapacity];
    constexpr std::uint64_t kLargest = std::numeric_limits<std::uint32_t>::max();
    const std::uint64_t what = static_cast<std::uint64_t>(kind) << 56U |
                               static_cast<std::uint64_t>(name & kNameMask) << 32U |
                               std::min(small, kLargest);
    // Released each: a reader of a new word in an old record sees the head that has moved.
    slot.time.store(last_, std::memory_order_release);
    slot.what.store(what, std::memory_order_release);
    slot.value.store(value, std::memory_order_release);
    head_.store(head + 1, std::memory_order_release);
  }

  /// [rt] Touches the cache lines of the slot of the next push.
  void touch() const {
    rt::touch(&slots_[head_.load(std::memory_order_relaxed) % kCapacity], sizeof(Slot));
  }

  /// [reader] Visits the new records in order; `visit(lost)` first when records were overwritten.
  template <typename Visit, typename Lost>
  void drain(Visit&& visit, Lost&& lost) {
    std::array<TraceEntry, kAtOnce> copied;
    const std::uint64_t end = head_.load(std::memory_order_acquire);
    while (tail_ < end) {
      const std::uint64_t first = std::max(tail_, oldest(end));
      const std::size_t count = std::min<std::size_t>(kAtOnce, end - first);
      for (std::size_t i = 0; i < count; ++i) copied[i] = read(first + i);
      const std::uint64_t sound = oldest(head_.load(std::memory_order_acquire));
      const std::uint64_t from = std::clamp(sound, first, first + count);
      if (from > tail_) lost(from - tail_);
      for (std::uint64_t i = from; i < first + count; ++i) visit(copied[i - first]);
      tail_ = first + count;
    }
  }

 private:
  struct Slot {
    std::atomic<Instant> time{0};
    std::atomic<std::uint64_t> what{0};
    std::atomic<std::int64_t> value{0};
  };
  static constexpr std::uint32_t kNameMask = 0xffffff;
  static constexpr std::size_t kAtOnce = 64;

  /// The first that is certainly whole when so many were written: the next may be half written
  /// over the oldest.
  static std::uint64_t oldest(std::uint64_t head) {
    return head < kCapacity ? 0 : head - kCapacity + 1;
  }
  [[nodiscard]] TraceEntry read(std::uint64_t index) const {
    const Slot& slot = slots_[index % kCapacity];
    TraceEntry entry;
    entry.time = slot.time.load(std::memory_order_acquire);
    const std::uint64_t what = slot.what.load(std::memory_order_acquire);
    entry.kind = static_cast<TraceKind>(what >> 56U);
    entry.name = static_cast<std::uint32_t>(what >> 32U) & kNameMask;
    entry.small = static_cast<std::uint32_t>(what);
    entry.value = slot.value.load(std::memory_order_acquire);
    return entry;
  }

  const Clock* const simulated_;
  std::array<Slot, kCapacity> slots_{};
  alignas(64) std::atomic<std::uint64_t> head_{0};
  Instant last_ = 0;                    // of the writer
  alignas(64) std::uint64_t tail_ = 0;  // of the reader
};

}  // namespace mauve::rt
