// SPDX-License-Identifier: LGPL-3.0-or-later
#include "happenings.h"

#include <algorithm>
#include <array>
#include <utility>

namespace mauve::daemon {

namespace {

using logging::Event;
using logging::Level;

constexpr std::string_view kRequested = "requested";

Event event_of(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Event>, 9> kEvents = {{
      {"started", Event::component_started},
      {"stopped", Event::component_stopped},
      {"swapped", Event::core_swapped},
      {"aborted", Event::change_given_back},
      {"overrun", Event::overrun},
      {"missed", Event::missed},
      {"faulted", Event::component_faulted},
      {"lost", Event::events_lost},
      {kRequested, Event::transaction_requested},
  }};
  const auto* found = std::find_if(kEvents.begin(), kEvents.end(),
                                   [&](const auto& row) { return row.first == name; });
  return found == kEvents.end() ? Event::core_message : found->second;
}

Level level_of(LogLevel level) {
  switch (level) {
    case LogLevel::debug:
      return Level::debug;
    case LogLevel::info:
      return Level::info;
    case LogLevel::warning:
      return Level::warn;
    case LogLevel::error:
      break;
  }
  return Level::error;
}

}  // namespace

logging::Record record_of(const Happening& happening) {
  logging::Record record = logging::make_record(
      event_of(happening.event), {{"component", happening.component}, {"text", happening.text}});
  record.fields.clear();
  record.text = (happening.event == kRequested ? "requests " : "") + happening.text;
  record.level = level_of(happening.level);
  record.time -= std::chrono::duration_cast<std::chrono::system_clock::duration>(
      std::chrono::nanoseconds(record.monotonic_ns - happening.time));
  record.monotonic_ns = happening.time;
  return record;
}

logging::Log::Source happenings_of(Deployer& deployer, Supervisor& supervisor) {
  return [&](const std::function<void(logging::Record)>& take) {
    deployer.drain([&](const Happening& happening) {
      take(record_of(happening));
      if (happening.event == kRequested) {
        supervisor.request(happening.component, happening.text);
      }
    });
  };
}

}  // namespace mauve::daemon
