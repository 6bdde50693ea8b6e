// SPDX-License-Identifier: LGPL-3.0-or-later
/// From fixed records of real-time threads to text. [log]
#include <algorithm>
#include <array>
#include <cstdio>

#include "base/duration.h"
#include "base/mutex.h"
#include "exec/system/events.h"
#include "model/job/log_text.h"

#include <mauve/host/component.h>
#include <mauve/host/value.h>

namespace mauve::exec {

std::string_view name_of(rt::EventKind kind) {
  switch (kind) {
    case rt::EventKind::log:
      return "log";
    case rt::EventKind::started:
      return "started";
    case rt::EventKind::stopped:
      return "stopped";
    case rt::EventKind::swapped:
      return "swapped";
    case rt::EventKind::aborted:
      return "aborted";
    case rt::EventKind::overrun:
    case rt::EventKind::long_overrun:
      return "overrun";
    case rt::EventKind::missed:
      return "missed";
    case rt::EventKind::faulted:
      return "faulted";
  }
  return "unknown";
}

namespace {

/// Three digits and a unit, for people: "3.01 ms".
std::string rounded(std::int64_t nanoseconds) {
  constexpr std::array<std::pair<double, const char*>, 4> kUnits{
      {{1e9, "s"}, {1e6, "ms"}, {1e3, "us"}, {1, "ns"}}};
  const auto value = static_cast<double>(nanoseconds);
  for (const auto& [size, unit] : kUnits) {
    if (value < size && size > 1) continue;
    char text[40];
    std::snprintf(text, sizeof text, "%.3g %s", value / size, unit);
    return text;
  }
  return {};
}

/// The state in which it failed, as a clause.
std::string in_state(const rt::Event& event) {
  if (event.literal == nullptr) return {};
  return ", in state " + std::string(event.literal, static_cast<std::size_t>(event.b.integer));
}

std::string text_of(const rt::Event& event) {
  const auto time = [](const LogArgument& a) { return rounded(a.integer); };
  const auto count = [](const LogArgument& a) { return std::to_string(a.integer); };
  switch (event.kind) {
    case rt::EventKind::log:
      return fill_in(event.literal, event.a, event.b);
    case rt::EventKind::started:
      return "first release at T0 + " + format_duration(Duration{event.a.integer});
    case rt::EventKind::stopped:
      return "stopped at T0 + " + format_duration(std::chrono::round<std::chrono::milliseconds>(
                                      Duration{event.a.integer}));
    case rt::EventKind::swapped:
      return "new elements in force, pause " + time(event.a) + ", " + count(event.b) +
             " bytes handed over";
    case rt::EventKind::aborted:
      return "a change missed its instant and was given back";
    case rt::EventKind::overrun:
    case rt::EventKind::long_overrun:
      return "job ended " + time(event.a) + " late, overrun " + count(event.b);
    case rt::EventKind::missed:
      return count(event.a) + (event.a.integer == 1 ? " release missed, " : " releases missed, ") +
             count(event.b) + " in all";
    case rt::EventKind::faulted:
      return std::string(to_string(static_cast<Cause>(event.a.integer))) + ": " +
             event.text.data() + in_state(event);
  }
  return {};
}

void drain_one(Deployed& deployed, std::vector<RuntimeEvent>& all) {
  rt::Event event;
  while (deployed.task->report().events().pop(event)) {
    all.push_back({event.time, event.level, deployed.component->name(),
                   std::string(name_of(event.kind)), text_of(event),
                   event.kind == rt::EventKind::long_overrun});
  }
  rt::Request request;
  while (deployed.task->report().requests().pop(request)) {
    all.push_back({request.time, LogLevel::info, deployed.component->name(), "requested",
                   std::string(request.name())});
  }
  const std::uint64_t lost = deployed.task->report().events().lost();
  const std::uint64_t news = lost - std::exchange(deployed.lost_events, lost);
  if (news == 0) return;
  all.push_back({all.empty() ? 0 : all.back().time, LogLevel::warning, deployed.component->name(),
                 "lost", std::to_string(news) + " events lost: the ring was full"});
}

}  // namespace

void keep_last_events(System& system, Deployed& deployed) {
  const MutexLock lock(system.members);
  drain_one(deployed, system.last_events);
}

std::size_t drain_events(System& system, const std::function<void(const RuntimeEvent&)>& visit) {
  std::vector<RuntimeEvent> all;
  {
    const MutexLock lock(system.members);
    all.swap(system.last_events);
    for (Deployed& deployed : system.deployed) {
      if (deployed.task != nullptr) drain_one(deployed, all);
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const RuntimeEvent& a, const RuntimeEvent& b) { return a.time < b.time; });
  for (const RuntimeEvent& happening : all) visit(happening);
  return all.size();
}

}  // namespace mauve::exec
