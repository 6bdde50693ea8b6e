// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/heartbeat.h"

#include <string>
#include <utility>
#include <vector>

#include "base/duration.h"
#include "base/mutex.h"
#include "base/thread_role.h"
#include "rt/process/pulse.h"

namespace mauve::daemon {

namespace {

constexpr Duration kBeyondTheBound = 1s;

/// "[guard] has not turned for 6s, so the work of this thread is not done"
std::string in_words(const std::vector<rt::Pulse::Silent>& silent) {
  std::string text;
  for (const auto& one : silent) {
    text += (text.empty() ? "[" : ", [") + one.name + "] has not turned for " +
            format_duration(std::chrono::floor<std::chrono::seconds>(one.lasted));
  }
  return text.empty() ? text : text + ", so the work of this thread is not done";
}

}  // namespace

std::string overdue(const Running& running) {
  MAUVE_ON_THREAD(control);
  const Duration now{running.deployer.clock().now() - running.deployer.t0()};
  std::string names;
  for (const auto& one : running.deployer.status()) {
    const bool bounded = one.state == ComponentState::running && one.watchdog > Duration{0};
    if (bounded && now - one.next_release > one.watchdog + kBeyondTheBound) {
      names += (names.empty() ? "" : ", ") + one.name;
    }
  }
  return names;
}

Heartbeat::Heartbeat(Running& running, Post in_io) : running_(running), in_io_(std::move(in_io)) {}

std::string Heartbeat::look() {
  const auto now = std::chrono::steady_clock::now();
  const auto silent = rt::Pulse::look(now - std::exchange(looked_, now));
  std::string wrong;
  if (!answers_->control) {
    wrong = "[control] does not answer";
  } else if (!answers_->io) {
    wrong = "[io] does not answer";
  } else if (!silent.empty()) {
    wrong = in_words(silent);
  } else {
    const MutexLock lock(answers_->mutex);
    wrong = answers_->late.empty() ? "" : "releases are not made by " + answers_->late;
  }
  ask();
  return wrong;
}

/// One question at a time: a thread that has not answered is not asked again.
void Heartbeat::ask() {
  if (answers_->control.exchange(false)) {
    running_.control.urgent([&running = running_, answers = answers_] {
      auto late = overdue(running);
      const MutexLock lock(answers->mutex);
      answers->late = std::move(late);
      answers->control = true;
    });
  }
  if (answers_->io.exchange(false)) {
    in_io_([answers = answers_] { answers->io = true; });
  }
}

}  // namespace mauve::daemon
