// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/deploy/crash_handler.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <thread>
#include <utility>

#include <unistd.h>

#include "base/mutex.h"
#include "exec/system/events.h"
#include "exec/task/safe_values.h"
#include "rt/thread/fence.h"

#include <mauve/detail/job.h>

namespace mauve::exec {
namespace {

/// For all safe values, and for the components that act on them.
constexpr Duration kMayTake = 200ms;
/// For one resource: its holder may be the thread that failed.
constexpr Duration kForOne = 20ms;

/// One line on standard error, without memory from anywhere.
template <typename... Arguments>
void say(const char* format, Arguments... arguments) {
  std::array<char, 256> line{};
  const int length = std::snprintf(line.data(), line.size(), format, arguments...);
  const auto end = std::min<std::size_t>(static_cast<std::size_t>(length), line.size() - 1);
  for (std::size_t i = 0; i + 1 < end; ++i) {  // no text of a core forges a line
    if (static_cast<unsigned char>(line[i]) < 0x20 || line[i] == 0x7F) line[i] = '?';
  }
  if (length > 0 && write(STDERR_FILENO, line.data(), end) < 0) return;
}

/// Null: it is leaving, and has stopped.
bool may_be_made_safe(const ComponentBase* component) {
  return component != nullptr && has_safe_values(*component->bundle());
}

/// A component that writes safe values writes nothing else any more; its core is not called.
unsigned make_safe(System& system, Instant until) {
  unsigned safe = 0;
  for (Deployed& deployed : system.deployed) {
    if (may_be_made_safe(deployed.component)) deployed.task->watch().fence();
  }
  rt::fence_all_threads();
  for (Deployed& deployed : system.deployed) {
    if (system.runner->now() > until) break;
    if (!may_be_made_safe(deployed.component)) continue;
    write_safe_values(*deployed.component->bundle(), true);
    ++safe;
  }
  return safe;
}

/// A driver still acts on the values that it reads, so all others get one more whole job.
void let_others_act(const System& system, Instant until) {
  std::array<std::pair<const Counters*, std::uint64_t>, 64> others{};
  std::size_t count = 0;
  for (const Deployed& deployed : system.deployed) {
    const Counters& counters = deployed.task->counters();
    const bool acts = deployed.state() == ComponentState::running &&
                      !may_be_made_safe(deployed.component) &&
                      system.t0 + counters.next_release.load() < until;
    if (acts && count < others.size()) others[count++] = {&counters, counters.releases.load()};
  }
  const auto acted = [&] {
    return std::all_of(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(count),
                       [](const auto& one) { return one.first->releases > one.second + 1; });
  };
  while (!acted() && system.runner->now() < until) std::this_thread::sleep_for(1ms);
}

void report_event(const char* component, const rt::Event& event, double at) {
  const auto a = static_cast<long long>(event.a.integer);
  const auto b = static_cast<long long>(event.b.integer);
  switch (event.kind) {
    case rt::EventKind::overrun:
    case rt::EventKind::long_overrun:
      return say("mauve: %.6f s after T0: a job of %s ended %lld ns late, overrun %lld\n", at,
                 component, a, b);
    case rt::EventKind::missed:
      return say("mauve: %.6f s after T0: %s missed %lld releases, %lld in all\n", at, component, a,
                 b);
    case rt::EventKind::log:
      return say("mauve: %.6f s after T0: %s says: %s\n", at, component, event.literal);
    default:
      return say("mauve: %.6f s after T0: %s: %s %s\n", at, component, name_of(event.kind).data(),
                 event.text.data());
  }
}

/// Writes the events up to `end` that no thread has read yet to standard error. The later ones are
/// consequences of the end: jobs wait for it.
void report_events(System& system, Instant end) {
  rt::Event event;
  for (Deployed& deployed : system.deployed) {
    while (deployed.task->report().events().pop(event)) {
      if (event.time > end) continue;
      report_event(deployed.task->name().c_str(), event, to_seconds(event.time - system.t0));
    }
  }
}

void speak(System& system, const rt::Death& death) MAUVE_NOT_ANALYSED {
  const Instant began = system.runner->now();
  const Instant until = began + kMayTake.count();
  this_job().lock_bound = kForOne;
  // The thread that holds the list may be the one that failed: then nothing waits for it.
  bool held = system.members.try_lock();
  for (int i = 1; i < 20 && !held; ++i) {
    std::this_thread::sleep_for(1ms);
    held = system.members.try_lock();
  }
  const unsigned safe = make_safe(system, until);
  std::array<char, 64> what{};
  rt::describe(death.fault, what.data(), what.size());
  say("mauve: %s in thread %s: the safe values of %u components are written, the process ends\n",
      what.data(), death.thread.data(), safe);
  let_others_act(system, until);
  if (held) {
    report_events(system, began);
    system.members.unlock();
  }
}

}  // namespace

Status prepare_crash_handler(System& system) {
  system.crash_handler = std::make_unique<rt::CrashHandler>();
  return system.crash_handler->start([&system](const rt::Death& death) { speak(system, death); });
}

}  // namespace mauve::exec
