// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/crash_handler.h"

#include <sys/prctl.h>

#include "rt/thread/futex.h"

#include <mauve/host/clock.h>

namespace mauve::rt {
namespace {

constexpr Duration kMayTake{500ms};
constexpr int kCrashPriority = 96;  // above every component and the guard

std::atomic<std::uint32_t> bell{0};  // rung when the process dies, and when a speaker shall end
std::atomic<bool> dying{false};
std::atomic<bool> death_reported{false};  // `death` can be read
std::atomic<std::uint32_t> speakers{0};
std::atomic<std::uint32_t> silent{0};  // have spoken
Death death;

bool& i_speak() {
  [[gnu::tls_model("initial-exec")]] static thread_local bool speaking = false;
  return speaking;
}

}  // namespace

CrashHandler::~CrashHandler() {
  if (!thread_.running()) return;
  ends_.reset();
  speakers.fetch_sub(1);
  quit_.store(true);
  futex_bump(bell);
  thread_.join();
}

Status CrashHandler::start(std::function<void(const Death&)> speak) {
  speak_ = std::move(speak);
  const sigset_t before = EndHandlers::keep_away_from_this_thread();  // the new thread inherits it
  // An end does not wait until an ordinary thread gets a processor.
  const int priority = may_use_fifo(kCrashPriority) ? kCrashPriority : 0;
  Status started = thread_.start({"mauve-last", priority, {}, 64 * 1024}, [this] { wait(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (!started) return started;
  speakers.fetch_add(1);
  if constexpr (kGuardsFaults) faults_.emplace();
  ends_.emplace();
  return started;
}

void CrashHandler::wait() {
  const FaultStack stack;
  while (!death_reported.load()) {
    const std::uint32_t seen = bell.load();
    if (quit_.load()) return;
    if (!death_reported.load()) futex_wait_until(bell, seen, kForever);
  }
  i_speak() = true;
  speak_(death);
  futex_bump(silent);
}

bool run_crash_handler(const Fault& fault) {
  if (i_speak()) return false;  // the crash handler itself failed
  const Instant until = MonotonicClock().now() + kMayTake.count();
  if (!dying.exchange(true)) {
    death.fault = fault;
    prctl(PR_GET_NAME, death.thread.data());
    death_reported.store(true);
    futex_bump(bell);
  }
  while (MonotonicClock().now() < until) {
    const std::uint32_t seen = silent.load();
    if (seen >= speakers.load()) return speakers.load() > 0;
    futex_wait_until(silent, seen, until);
  }
  return false;
}

bool is_dying() { return dying.load(); }

}  // namespace mauve::rt
