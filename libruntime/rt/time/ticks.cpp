// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/time/ticks.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include <mauve/host/clock.h>

#include "base/mutex.h"

namespace mauve::rt {
namespace {

constexpr Instant kFirstTie = 100'000'000;
constexpr Instant kBetweenTies = 500'000'000;
constexpr Instant kHoldsFor = 10'000'000'000;
/// A counter that is so far from the clock after at most some seconds is none to go by.
constexpr Instant kTooFar = 1'000'000;

__extension__ using Wide = unsigned __int128;

std::uint64_t ticks() {
#if defined(__x86_64__)
  return __builtin_ia32_rdtsc();
#else
  return 0;
#endif
}

/// Linux takes the counter for its own clock only where it is constant and the same on all CPUs.
bool is_to_be_trusted() {
#if defined(__x86_64__)
  std::ifstream file("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  std::string source;
  return file >> source && source == "tsc";
#else
  return false;
#endif
}

/// At `ticks` it was `time`. Every word is released and acquired: a reader of a word of a later tie
/// sees the number of the tie before it too.
struct Tie {
  std::atomic<std::uint64_t> ticks{0};
  std::atomic<Instant> time{0};
  std::atomic<std::uint64_t> rate{0};   // ns a tick, times 2^32; 0: there is none
  std::atomic<std::uint64_t> holds{0};  // ticks
};

/// A tie is overwritten when three newer ones are there.
constexpr std::uint64_t kTies = 4;
std::array<Tie, kTies> ties;
std::atomic<std::uint64_t> newest{0};

struct Sample {
  std::uint64_t ticks = 0;
  Instant time = 0;
};

/// The reading with the least between the two clocks.
Sample sample() {
  const MonotonicClock clock;
  Sample best;
  std::uint64_t shortest = ~0ULL;
  for (int i = 0; i < 8; ++i) {
    const std::uint64_t before = ticks();
    const Instant time = clock.now();
    const std::uint64_t between = ticks() - before;
    if (between >= shortest) continue;
    shortest = between;
    best = {before + between / 2, time};
  }
  return best;
}

void publish(const Sample& at, std::uint64_t rate) {
  const std::uint64_t number = newest.load(std::memory_order_relaxed) + 1;
  Tie& tie = ties[number % kTies];
  const std::uint64_t holds =
      rate == 0 ? 0 : static_cast<std::uint64_t>((static_cast<Wide>(kHoldsFor) << 32U) / rate);
  tie.ticks.store(at.ticks, std::memory_order_release);
  tie.time.store(at.time, std::memory_order_release);
  tie.rate.store(rate, std::memory_order_release);
  tie.holds.store(holds, std::memory_order_release);
  newest.store(number, std::memory_order_release);
}

/// The time by the newest tie; 0: that does not hold now.
Instant tied_now() {
  const std::uint64_t number = newest.load(std::memory_order_acquire);
  const Tie& tie = ties[number % kTies];
  const std::uint64_t from = tie.ticks.load(std::memory_order_acquire);
  const Instant time = tie.time.load(std::memory_order_acquire);
  const std::uint64_t rate = tie.rate.load(std::memory_order_acquire);
  const std::uint64_t holds = tie.holds.load(std::memory_order_acquire);
  const bool whole = newest.load(std::memory_order_relaxed) - number < kTies - 1;
  const std::uint64_t passed = ticks() - from;
  if (rate == 0 || !whole || passed > holds) return 0;
  return time + static_cast<Instant>((static_cast<Wide>(passed) * rate) >> 32U);
}

}  // namespace

Instant fast_now() {
  const Instant now = tied_now();
  return now != 0 ? now : MonotonicClock().now();
}

bool ticks_are_tied() { return tied_now() != 0; }

void tie_ticks() {
  static Mutex mutex;
  static bool trusted = is_to_be_trusted();
  static Sample last{};
  const MutexLock lock(mutex);
  if (!trusted) return;
  const Sample now = sample();
  const Instant passed = now.time - last.time;
  const bool first = last.time == 0;
  const bool tied = newest.load(std::memory_order_relaxed) != 0;
  if (!first && passed < (tied ? kBetweenTies : kFirstTie)) return;
  if (!first) {
    const Instant predicted = tied_now();
    trusted = predicted == 0 || std::abs(predicted - MonotonicClock().now()) < kTooFar;
    const std::uint64_t rate =
        static_cast<std::uint64_t>((static_cast<Wide>(passed) << 32U) / (now.ticks - last.ticks));
    publish(now, trusted ? rate : 0);
  }
  last = now;
}

}  // namespace mauve::rt
