// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/deadline.h"

#include <csignal>

#include <unistd.h>

#ifndef sigev_notify_thread_id
#define sigev_notify_thread_id _sigev_un._tid
#endif

namespace mauve::rt {
namespace {

constexpr long kSecond = 1'000'000'000;
/// The thread may run code that must not be interrupted, so the signal is sent again after this
/// time.
constexpr long kReportAgain = 1'000'000;

}  // namespace

Deadline::Deadline(Duration most) {
  if constexpr (!kGuardsFaults) return;
  // The signal comes when the time is over, so the words that its handler reads may be set now.
  watched_.busy_since.store(1);
  watched_.interrupt.store(1);
  sigevent event{};
  event.sigev_notify = SIGEV_THREAD_ID;
  event.sigev_signo = kInterrupt;
  event.sigev_notify_thread_id = gettid();
  if (timer_create(CLOCK_MONOTONIC, &event, &timer_) != 0) return;
  armed_ = true;
  itimerspec times{};
  times.it_value = {most.count() / kSecond, most.count() % kSecond};
  times.it_interval = {0, kReportAgain};
  timer_settime(timer_, 0, &times, nullptr);
}

Deadline::~Deadline() {
  if (armed_) timer_delete(timer_);
}

}  // namespace mauve::rt
