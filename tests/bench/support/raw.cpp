// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/support/raw.h"

#include <cstring>
#include <memory>
#include <thread>
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

std::vector<double> raw_exchanges(Places places, int priority, int count) {
  constexpr Duration kPeriod{1'000'000};
  std::atomic<int*> pending{nullptr};
  std::atomic<int*> retired{nullptr};
  std::vector<double> pauses;
  auto current = std::make_unique<int>(0);
  std::atomic<Instant> pause{0};
  const OnCpu here(places.coordinator, 0);
  const RawLoop loop(places.component, fifo_or_none(priority), now() + kPeriod.count(), kPeriod,
                     [&](Instant) {
                       int* next = pending.load(std::memory_order_acquire);
                       if (next == nullptr) return;
                       const Instant begin = now();
                       pending.store(nullptr, std::memory_order_relaxed);
                       int* old = current.release();
                       current.reset(next);
                       *next += 1;
                       pause.store(now() - begin, std::memory_order_relaxed);
                       retired.store(old, std::memory_order_release);
                     });
  for (int i = 0; i < count; ++i) {
    pending.store(new int(i), std::memory_order_release);
    int* old = nullptr;
    while ((old = retired.exchange(nullptr, std::memory_order_acquire)) == nullptr) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    delete old;
    pauses.push_back(static_cast<double>(pause.load(std::memory_order_relaxed)));
  }
  return pauses;
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
