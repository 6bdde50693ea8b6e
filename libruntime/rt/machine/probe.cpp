// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/machine/probe.h"

#include <utility>

#include "rt/process/pulse.h"
#include "rt/thread/futex.h"

#include <mauve/host/clock.h>

namespace mauve::rt {
namespace {

constexpr int kProbePriority = 99;
constexpr std::size_t kStack = 64 * 1024;

}  // namespace

Probe::Probe(int cpu, Duration period, Report report)
    : cpu_(cpu), period_(period), report_(std::move(report)) {}

Probe::~Probe() {
  quit_ = true;
  thread_.join();
}

Status Probe::start() {
  return thread_.start({"mauve-probe", kProbePriority, {cpu_}, kStack}, [this] { run(); });
}

/// Instants that passed while it was held up are left out.
void Probe::run() {
  const MonotonicClock clock;
  const std::atomic<std::uint32_t> never{0};
  Pulse pulse("probe");
  for (Instant due = clock.now() + period_.count(); !quit_; due += period_.count()) {
    pulse.turn();
    while (clock.now() < due) futex_wait_until(never, 0, due);
    const Instant ran = clock.now();
    report_(due, ran);
    if (ran - due > period_.count()) due = ran;
  }
}

}  // namespace mauve::rt
