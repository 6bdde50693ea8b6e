// SPDX-License-Identifier: LGPL-3.0-or-later
#include "trace/probe.h"

#include "rt/futex.h"

namespace mauve::daemon {

namespace {

constexpr int kPriority = 99;
constexpr std::size_t kStack = 64 * 1024;

}  // namespace

Status Probe::start() {
  return thread_.start({"mauve-probe", kPriority, {cpu_}, kStack}, [this] { run(); });
}

Probe::~Probe() {
  quit_ = true;
  thread_.join();
}

void Probe::run() {
  const MonotonicClock clock;
  const std::atomic<std::uint32_t> never{0};
  for (Instant next = clock.now() + kPeriod; !quit_; next += kPeriod) {
    while (clock.now() < next) {
      rt::futex_wait_until(never, 0, next);
    }
    const Instant now = clock.now();
    if (now - next > kLate) {
      ring_.push(TraceKind::disturbed, now, 0, 0, now - next);
      next = now;
    }
  }
}

}  // namespace mauve::daemon
