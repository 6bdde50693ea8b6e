// SPDX-License-Identifier: LGPL-3.0-or-later
/// EventRing: the events that a real-time thread reports to the [log] thread. Wait-free, never
/// blocks; a full ring counts the events that it loses.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include <mauve/log.h>
#include <mauve/time.h>

namespace mauve::rt {

enum class EventKind : std::uint8_t {
  log,           ///< a message of a core: `literal` with arguments a and b
  started,       ///< a: release, ns since T0
  stopped,       ///< a: ns since T0
  swapped,       ///< a: pause in ns, b: bytes handed over
  aborted,       ///< a change that missed its instant was given back untouched
  overrun,       ///< a: how late in ns, b: overruns so far
  long_overrun,  ///< the same; the job took longer than its budget or its wait
  missed,        ///< a: releases that will never run, b: missed so far
  faulted,       ///< a: the cause, text: the exception, or the like
};

/// Fixed size; `literal` points into a library that stays loaded while its events are undrained.
struct Event {
  Instant time = 0;
  EventKind kind = EventKind::log;
  LogLevel level = LogLevel::info;
  const char* literal = nullptr;
  LogArgument a;
  LogArgument b;
  std::array<char, 40> text{};
};

/// One producer (the component's thread), one consumer ([log]).
class EventRing {
 public:
  static constexpr std::size_t kCapacity = 128;

  /// [rt]
  void push(const Event& event) {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == kCapacity) {
      lost_.store(lost_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return;
    }
    events_[head % kCapacity] = event;
    head_.store(head + 1, std::memory_order_release);
  }
  /// [log] False when empty.
  bool pop(Event& event) {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    event = events_[tail % kCapacity];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }
  /// Events that found the ring full, since the start.
  [[nodiscard]] std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  std::array<Event, kCapacity> events_{};
  alignas(64) std::atomic<std::uint64_t> head_{0};
  alignas(64) std::atomic<std::uint64_t> tail_{0};
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace mauve::rt
