// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/support/raw.h"

#include <cstring>
#include <utility>

#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "bench/support/machine.h"

namespace bench {

RawLoop::RawLoop(int cpu, int priority, Instant first, Duration period,
                 std::function<void(Instant)> body)
    : body_(std::move(body)) {
  static_cast<void>(
      thread_.start({"bench-raw", priority, {cpu}}, [this, first, period] { run(first, period); }));
}

RawLoop::~RawLoop() {
  quit_.store(true);
  thread_.join();
}

void RawLoop::run(Instant due, Duration period) {
  const std::uint32_t word = 0;
  for (; !quit_.load(std::memory_order_relaxed); due += period.count()) {
    const timespec until{static_cast<time_t>(due / 1'000'000'000),
                         static_cast<long>(due % 1'000'000'000)};
    syscall(SYS_futex, &word, FUTEX_WAIT_BITSET_PRIVATE, 0, &until, nullptr,
            FUTEX_BITSET_MATCH_ANY);
    body_(now());
  }
}

RawPiMutex::RawPiMutex(std::size_t size) : value_(size) {
  pthread_mutexattr_t attributes;
  pthread_mutexattr_init(&attributes);
  pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
  pthread_mutex_init(&mutex_, &attributes);
  pthread_mutexattr_destroy(&attributes);
}

void RawPiMutex::write(const void* data) {
  pthread_mutex_lock(&mutex_);
  std::memcpy(value_.data(), data, value_.size());
  pthread_mutex_unlock(&mutex_);
}

void RawPiMutex::read(void* into) {
  pthread_mutex_lock(&mutex_);
  std::memcpy(into, value_.data(), value_.size());
  pthread_mutex_unlock(&mutex_);
}

RawTripleBuffer::RawTripleBuffer(std::size_t size) : size_(size) {
  for (auto& slot : slots_) slot.resize(size);
}

void RawTripleBuffer::write(const void* data) {
  std::memcpy(slots_[back_].data(), data, size_);
  const auto fresh = static_cast<std::uint8_t>(back_ | kFresh);
  back_ = middle_.exchange(fresh, std::memory_order_acq_rel) & 3U;
}

void RawTripleBuffer::read(void* into) {
  if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & 3U;
  }
  std::memcpy(into, slots_[front_].data(), size_);
}

}  // namespace bench
