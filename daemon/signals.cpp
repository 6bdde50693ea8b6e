// SPDX-License-Identifier: LGPL-3.0-or-later
#include "signals.h"

#include <signal.h>
#include <unistd.h>

#include <cstring>
#include <ctime>

#include "base/mutex.h"
#include "base/thread_role.h"

namespace mauve::daemon {

namespace {

constexpr std::chrono::milliseconds kGlance{20};

sigset_t ending_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  struct sigaction present {};
  if (sigaction(SIGHUP, nullptr, &present) == 0 && present.sa_handler != SIG_IGN) {
    sigaddset(&set, SIGHUP);
  }
  return set;
}

std::string name_of(int number) {
  const char* name = sigabbrev_np(number);
  return name == nullptr ? "signal " + std::to_string(number) : "SIG" + std::string(name);
}

}  // namespace

Signals::Signals() {
  const auto set = ending_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  signal(SIGPIPE, SIG_IGN);  // a closed terminal or log reader is no reason to drop a robot
  signal(SIGXFSZ, SIG_IGN);  // nor is a quota: the write fails and is reported
}

std::optional<std::string> Signals::wait(std::chrono::milliseconds time) const {
  const auto set = ending_signals();
  const std::timespec limit{time.count() / 1000, time.count() % 1000 * 1'000'000};
  const int number = sigtimedwait(&set, nullptr, &limit);
  return number > 0 ? std::optional(name_of(number)) : std::nullopt;
}

std::string Signals::wait() const {
  const auto set = ending_signals();
  int number = 0;
  while (sigwait(&set, &number) != 0) {
  }
  return name_of(number);
}

StartGuard::StartGuard(const Signals& signals, std::function<void()> crash_handler)
    : signals_(signals), crash_handler_(std::move(crash_handler)) {
  thread_ = std::thread([this] { run(); });
}

std::optional<std::string> StartGuard::finish() {
  {
    const MutexLock lock(mutex_);
    finished_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
  return signal_;
}

void StartGuard::run() {
  while (!signal_) {
    if (finished_within(std::chrono::milliseconds(0))) {
      return;
    }
    signal_ = signals_.wait(kGlance);
  }
  if (!finished_within(kPatience)) {
    crash_handler_();
    _exit(1);
  }
}

bool StartGuard::finished_within(std::chrono::milliseconds time) {
  MutexLock lock(mutex_);
  return wake_.wait_for(lock, time, [this]() MAUVE_REQUIRES(mutex_) { return finished_; });
}

Reaper::Reaper(const Signals& signals, std::chrono::milliseconds patience,
               std::function<void(const std::string& cause)> crash_handler)
    : signals_(signals), patience_(patience), crash_handler_(std::move(crash_handler)) {
  thread_ = std::thread([this] {
    begin_thread(ThreadRole::reaper);
    run();
  });
}

Reaper::~Reaper() {
  {
    const MutexLock lock(mutex_);
    finished_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Reaper::run() {
  const auto until = std::chrono::steady_clock::now() + patience_;
  std::string cause = "it takes too long";
  while (std::chrono::steady_clock::now() < until) {
    if (const auto second = signals_.wait(kGlance)) {
      cause = "second signal, " + *second;
      if (finished_within(kHurry)) {
        return;
      }
      break;
    }
    if (finished_within(std::chrono::milliseconds(0))) {
      return;
    }
  }
  crash_handler_(cause);
  _exit(1);
}

bool Reaper::finished_within(std::chrono::milliseconds time) {
  MutexLock lock(mutex_);
  return wake_.wait_for(lock, time, [this]() MAUVE_REQUIRES(mutex_) { return finished_; });
}

}  // namespace mauve::daemon
