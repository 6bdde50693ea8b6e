// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/machine/machine_costs.h"

#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <list>

#include "rt/thread/futex.h"
#include "rt/thread/thread.h"

#include <mauve/host/clock.h>

namespace mauve::rt {
namespace {

constexpr int kWakes = 25;
constexpr Duration kSleep = 200us;
constexpr int kSwitches = 200;
constexpr int kExpiries = 20;
constexpr Duration kUntilExpiry = 50us;
constexpr int kWindows = 5;
/// A window is looked at in slices, with a pause after each.
constexpr int kSlices = 20;
constexpr Duration kSlice = MachineCosts::window / kSlices;
constexpr Duration kPause = 2ms;
/// Between two readings of the clock: shorter ones are the readings themselves.
constexpr Duration kHole = 500ns;
/// How much worse than in so short a time it may become.
constexpr int kMargin = 2;

Instant now() { return MonotonicClock().now(); }

/// The third largest sample, below which nearly all samples stay.
template <std::size_t N>
Duration nearly_largest(std::array<Duration, N> samples) {
  static_assert(N > 2);
  std::nth_element(samples.begin(), samples.begin() + 2, samples.end(), std::greater<>());
  return samples[2];
}

/// Others run meanwhile.
void pause() {
  const std::atomic<std::uint32_t> nobody{0};
  const Instant end = now() + kPause.count();
  while (now() < end) futex_wait_until(nobody, 0, end);
}

Duration measure_wake() {
  std::array<Duration, kWakes> late{};
  const std::atomic<std::uint32_t> nobody{0};
  for (Duration& sample : late) {
    const Instant due = now() + kSleep.count();
    while (now() < due) futex_wait_until(nobody, 0, due);
    sample = Duration{now() - due};
  }
  return nearly_largest(late);
}

/// With a margin, and for people to read.
Duration with_margin(Duration measured) {
  constexpr Duration kDigit = 100ns;
  return (kMargin * measured + kDigit - 1ns) / kDigit * kDigit;
}

/// Time that passed between readings of the clock until `end`, beyond the time of a reading.
Duration holes_until(Instant end) {
  Duration sum{0};
  for (Instant last = now(); last < end;) {
    const Instant next = now();
    if (Duration{next - last} > kHole) sum += Duration{next - last};
    last = next;
  }
  return sum;
}

/// The time of a timer interrupt: timers for which no thread waits expire on this CPU.
Duration measure_interrupt() {
  const int timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC);
  if (timer < 0) return Duration{0};
  std::array<Duration, kExpiries> samples{};
  for (Duration& sample : samples) {
    itimerspec once{};
    once.it_value.tv_nsec = kUntilExpiry.count();
    timerfd_settime(timer, 0, &once, nullptr);
    sample = holes_until(now() + 2 * kUntilExpiry.count());
    pause();
  }
  close(timer);
  // The median: the kernel's own tick is in some, and is counted apart.
  std::nth_element(samples.begin(), samples.begin() + kExpiries / 2, samples.end());
  return samples[kExpiries / 2];
}

/// The median: the tick of the kernel is in every window, the time that a host takes is in some.
Duration measure_kernel() {
  std::array<Duration, kWindows> samples{};
  for (Duration& sample : samples) {
    for (int i = 0; i < kSlices; ++i) {
      sample += holes_until(now() + kSlice.count());
      pause();
    }
  }
  std::nth_element(samples.begin(), samples.begin() + kWindows / 2, samples.end());
  return samples[kWindows / 2];
}

/// Two threads on one CPU that pass the turn to each other.
struct PingPong {
  std::atomic<std::uint32_t> turn{0};

  void play(std::uint32_t side) {
    for (int i = 0; i < kSwitches; ++i) {
      for (;;) {
        const std::uint32_t seen = turn.load();
        if (seen % 2 == side) break;
        futex_wait_until(turn, seen, now() + Duration{1s}.count());
      }
      futex_bump(turn);
    }
  }
};

struct Measuring {
  MachineCosts costs;
  PingPong game;
  Thread first;
  Thread second;

  Status start(int cpu, int priority) {
    // The second waits for its turn; the first starts the game after all else is measured.
    Status started = second.start({"mauve-measure", priority, {cpu}}, [this] { game.play(1); });
    if (!started) return started;
    return first.start({"mauve-measure", priority, {cpu}}, [this] { measure(); });
  }
  void measure() {
    costs.wake = with_margin(measure_wake());
    costs.interrupt = with_margin(measure_interrupt());
    costs.kernel = with_margin(measure_kernel());
    const Instant begin = now();
    game.play(0);
    costs.activation = with_margin(Duration{now() - begin} / kSwitches);
  }
};

}  // namespace

std::optional<MachineCosts> measure_machine(const std::vector<int>& cpus, int priority) {
  std::list<Measuring> all;
  for (const int cpu : cpus) {
    if (!all.emplace_back().start(cpu, priority)) {
      // A thread that waits for a turn that never comes is given it.
      if (all.back().second.running()) all.back().game.play(0);
      return std::nullopt;
    }
  }
  MachineCosts worst{0ns, 0ns, 0ns, 0ns};
  for (Measuring& one : all) {
    one.first.join();
    one.second.join();
    worst.wake = std::max(worst.wake, one.costs.wake);
    worst.activation = std::max(worst.activation, one.costs.activation);
    worst.interrupt = std::max(worst.interrupt, one.costs.interrupt);
    worst.kernel = std::max(worst.kernel, one.costs.kernel);
  }
  return worst;
}

}  // namespace mauve::rt
