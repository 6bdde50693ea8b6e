// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/service_status.h"

#include <cstdlib>
#include <utility>

#include "mauve/host/architecture.h"
#include "notify.h"

namespace mauve::daemon {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kStatusEvery{2'000};
constexpr int kBeatsInAWatchdog = 4;

std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace

std::string state_line(const Running& running) {
  std::uint64_t missed = 0;
  std::uint64_t overruns = 0;
  std::size_t run = 0;
  const auto all = running.deployer.status();
  for (const auto& one : all) {
    missed += one.missed;
    overruns += one.overruns;
    run += one.state == ComponentState::running ? 1 : 0;
  }
  const bool on_probation = running.deployer.on_probation() || !running.places.empty();
  return running.architecture.name() + ": " + std::to_string(run) + " of " +
         counted(all.size(), "component") + (all.size() == 1 ? " runs" : " run") + ", generation " +
         std::to_string(running.generation) + (on_probation ? " on probation" : "") + ", " +
         std::to_string(missed) + " missed, " + std::to_string(overruns) + " overruns" +
         (running.deployer.realtime() ? "" : ", NOT real time");
}

std::string serve_until_signal(Running& running, Signals& signals, Heartbeat::Post in_io) {
  if (std::getenv("NOTIFY_SOCKET") == nullptr) {
    return signals.wait();
  }
  const auto watchdog = notify::watchdog();
  Heartbeat heartbeat(running, std::move(in_io));
  bool well = true;
  for (;;) {
    const bool watched = watchdog.count() > 0;
    const auto pause = std::chrono::ceil<milliseconds>(watchdog / kBeatsInAWatchdog);
    if (auto signal = signals.wait(watched ? std::min(pause, kStatusEvery) : kStatusEvery)) {
      return *signal;
    }
    if (well) {
      running.control.read([&running] { notify::status(state_line(running)); });
    }
    if (!watched) {
      continue;
    }
    const auto wrong = heartbeat.look();
    if (wrong.empty()) {
      notify::alive();
    } else {
      notify::status("no sign of life is sent to the watchdog: " + wrong);
    }
    if (std::exchange(well, wrong.empty()) && !wrong.empty()) {
      running.log.write(logging::Event::watchdog_silent, {{"text", wrong}});
    }
  }
}

}  // namespace mauve::daemon
