// SPDX-License-Identifier: LGPL-3.0-or-later
#include "signals.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cstring>
#include <ctime>

#include "base/mutex.h"
#include "base/thread_role.h"

namespace mauve::daemon {

namespace {

constexpr std::chrono::milliseconds kGlance{20};

bool is_ignored(int number) {
  struct sigaction present {};
  return sigaction(number, nullptr, &present) == 0 && present.sa_handler == SIG_IGN;
}

std::string name_of(int number) {
  const char* name = sigabbrev_np(number);
  return name == nullptr ? "signal " + std::to_string(number) : "SIG" + std::string(name);
}

/// A terminal whose end SIGHUP would report.
bool has_terminal() {
  const int terminal = open("/dev/tty", O_RDONLY | O_NOCTTY | O_CLOEXEC);
  if (terminal >= 0) {
    close(terminal);
  }
  return terminal >= 0;
}

}  // namespace

Signals::Signals(bool has_log_file) {
  sigemptyset(&ends_);
  sigaddset(&ends_, SIGTERM);
  if (has_log_file || !has_terminal()) {
    signal(SIGHUP, SIG_IGN);
  }
  for (const int number : {SIGINT, SIGHUP}) {
    if (!is_ignored(number)) {
      sigaddset(&ends_, number);
    }
  }
  pthread_sigmask(SIG_BLOCK, &ends_, nullptr);
  signal(SIGPIPE, SIG_IGN);  // a closed terminal or log reader is no reason to drop a robot
  signal(SIGXFSZ, SIG_IGN);  // nor is a quota: the write fails and is reported
}

std::optional<std::string> Signals::wait(std::chrono::milliseconds time) const {
  const std::timespec limit{time.count() / 1000, time.count() % 1000 * 1'000'000};
  const int number = sigtimedwait(&ends_, nullptr, &limit);
  return number > 0 ? std::optional(name_of(number)) : std::nullopt;
}

std::string Signals::wait() const {
  int number = 0;
  while (sigwait(&ends_, &number) != 0) {
  }
  return name_of(number);
}

Reaper::Reaper(const Signals& signals, std::function<void(const std::string& cause)> crash_handler)
    : signals_(signals), crash_handler_(std::move(crash_handler)) {
  thread_ = std::thread([this] {
    begin_thread(ThreadRole::reaper);
    run();
  });
}

Reaper::~Reaper() {
  enter(Phase::over);
  thread_.join();
}

std::optional<std::string> Reaper::start_is_over() {
  enter(Phase::running);
  MutexLock lock(mutex_);
  while (watched_) {
    wake_.wait(lock);
  }
  return signal_;
}

void Reaper::end_begins(std::chrono::milliseconds patience) {
  patience_ = patience;
  enter(Phase::ending);
}

void Reaper::run() {
  watch_start();
  {
    const MutexLock lock(mutex_);
    watched_ = false;
  }
  wake_.notify_all();
  while (!leaves(Phase::running, std::chrono::hours(1))) {
  }
  watch_end();
}

void Reaper::watch_start() {
  while (!signal_ && !leaves(Phase::starting, std::chrono::milliseconds(0))) {
    signal_ = signals_.wait(kGlance);
  }
  if (!leaves(Phase::starting, kPatience)) {
    reap("a signal came while a hook hangs");
  }
}

void Reaper::watch_end() {
  const auto until = std::chrono::steady_clock::now() + patience_;
  while (!leaves(Phase::ending, std::chrono::milliseconds(0))) {
    if (std::chrono::steady_clock::now() >= until) {
      reap("it takes too long");
    }
    const auto second = signals_.wait(kGlance);
    if (second && !leaves(Phase::ending, kHurry)) {
      reap("second signal, " + *second);
    }
  }
}

void Reaper::enter(Phase phase) {
  {
    const MutexLock lock(mutex_);
    phase_ = phase;
  }
  wake_.notify_all();
}

bool Reaper::leaves(Phase phase, std::chrono::milliseconds time) {
  MutexLock lock(mutex_);
  return wake_.wait_for(lock, time, [&]() MAUVE_REQUIRES(mutex_) { return phase_ != phase; });
}

void Reaper::reap(const std::string& cause) {
  crash_handler_(cause);
  _exit(1);
}

}  // namespace mauve::daemon
