// SPDX-License-Identifier: LGPL-3.0-or-later
/// Raw: what the runtime is compared with, written as plainly as it can be.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <pthread.h>

#include "rt/thread/thread.h"

#include <mauve/time.h>

namespace bench {

using mauve::Duration;
using mauve::Instant;

/// Instants noted by one thread; memory is touched beforehand, what does not fit is dropped.
class Instants {
 public:
  explicit Instants(std::size_t capacity) : times_(capacity) {}
  void add(Instant instant) {
    const std::size_t count = count_.load(std::memory_order_relaxed);
    if (count == times_.size()) return;
    times_[count] = instant;
    count_.store(count + 1, std::memory_order_release);
  }
  /// Room for so many, before it is used.
  void make_room(std::size_t capacity) { times_.resize(capacity); }
  void clear() { count_.store(0, std::memory_order_release); }
  [[nodiscard]] std::size_t size() const { return count_.load(std::memory_order_acquire); }
  [[nodiscard]] Instant operator[](std::size_t i) const { return times_[i]; }

 private:
  std::vector<Instant> times_;
  std::atomic<std::size_t> count_{0};
};

/// A periodic thread that waits on a futex for absolute instants and calls `body` with the time it
/// read then.
class RawLoop {
 public:
  RawLoop(int cpu, int priority, Instant first, Duration period, std::function<void(Instant)> body);
  ~RawLoop();

 private:
  void run(Instant due, Duration period);

  std::function<void(Instant)> body_;
  std::atomic<bool> quit_{false};
  mauve::rt::Thread thread_;
};

/// CPUs. Each cache line that the coordinator wrote on another CPU must come from there.
struct Places {
  int component;
  int coordinator;
};

/// The floor of a swap: one slot checked, one pointer exchanged, one given back, between two clock
/// readings of a 1 kHz thread. ns of each.
[[nodiscard]] std::vector<double> raw_exchanges(Places places, int priority, int count);

/// memcpy under a priority-inheritance mutex.
class RawPiMutex {
 public:
  explicit RawPiMutex(std::size_t size);
  ~RawPiMutex() { pthread_mutex_destroy(&mutex_); }
  RawPiMutex(const RawPiMutex&) = delete;
  RawPiMutex& operator=(const RawPiMutex&) = delete;
  void write(const void* data);
  void read(void* into);

 private:
  pthread_mutex_t mutex_;
  std::vector<std::byte> value_;
};

/// One writer, one reader: three slots and one atomic word with the index of the middle one.
class RawTripleBuffer {
 public:
  explicit RawTripleBuffer(std::size_t size);
  void write(const void* data);
  void read(void* into);

 private:
  static constexpr std::uint8_t kFresh = 4;

  std::size_t size_;
  std::array<std::vector<std::byte>, 3> slots_;
  std::uint8_t back_ = 0;
  alignas(64) std::atomic<std::uint8_t> middle_{1};
  alignas(64) std::uint8_t front_ = 2;
};

}  // namespace bench
