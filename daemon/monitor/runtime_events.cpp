// SPDX-License-Identifier: LGPL-3.0-or-later
#include "monitor/runtime_events.h"

#include "base/thread_role.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "changes/request_limit.h"
#include "monitor/late_summary.h"

namespace mauve::daemon {

namespace {

using logging::Event;
using logging::Level;

constexpr std::string_view kRequested = "requested";

Event event_named(std::string_view name) {
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

/// 1, 10, 100 and so on: reported seldom, however many there are.
bool is_power_of_ten(std::uint64_t count) {
  while (count >= 10 && count % 10 == 0) {
    count /= 10;
  }
  return count == 1;
}

logging::Record ignored_request(const RuntimeEvent& happening, std::uint64_t ignored) {
  return logging::make_record(Event::requests_ignored,
                              {{"component", happening.component},
                               {"transaction", happening.text},
                               {"count", static_cast<std::int64_t>(ignored)}});
}

/// The fields for programs, taken out of the sentence for people.
logging::Fields fields_of(const RuntimeEvent& happening) {
  const std::string& text = happening.text;
  std::int64_t count = 0;
  std::from_chars(text.data(), text.data() + text.size(), count);
  if (happening.event == "missed") {
    return {{"count", count}};
  }
  if (happening.event == "lost") {
    return {{"count", count}, {"source", happening.component}};
  }
  if (happening.event != "faulted") {
    return {};
  }
  constexpr std::string_view kInState = ", in state ";
  const auto colon = text.find(": ");
  logging::Fields fields = {{"cause", text.substr(0, colon)}};
  if (const auto state = text.rfind(kInState); state != std::string::npos) {
    fields.push_back({"state", text.substr(state + kInState.size())});
  }
  return fields;
}

using Take = std::function<void(logging::Record)>;

void take_all(const std::vector<RuntimeEvent>& all, const Take& take) {
  for (const auto& happening : all) {
    take(record_of(happening));
  }
}

/// The lateness of a component is reported before its stop.
void take_one(const RuntimeEvent& happening, LateSummary& late, const Take& take) {
  if (happening.event == "stopped" || happening.event == "faulted") {
    take_all(late.finish(happening.component, happening.time), take);
  }
  if (happening.event == "faulted") {
    late.failed(happening.time);
  }
  if (!LateSummary::concerns(happening) || late.pass(happening)) {
    take(record_of(happening));
  }
}

}  // namespace

logging::Record record_of(const RuntimeEvent& happening) {
  MAUVE_ON_THREAD(log);
  logging::Record record = logging::make_record(
      event_named(happening.event), {{"component", happening.component}, {"text", happening.text}});
  record.fields = fields_of(happening);
  record.text = (happening.event == kRequested ? "requests " : "") + happening.text;
  record.level = level_of(happening.level);
  record.time -= std::chrono::duration_cast<std::chrono::system_clock::duration>(
      std::chrono::nanoseconds(record.monotonic_ns - happening.time));
  record.monotonic_ns = happening.time;
  return record;
}

logging::Log::Source runtime_events_of(Deployer& deployer, Supervisor& supervisor) {
  auto limit = std::make_shared<RequestLimit>();
  auto late = std::make_shared<LateSummary>();
  return [&, limit, late](const Take& take) {
    take_all(late->due(deployer.clock().now()), take);
    deployer.drain([&](const RuntimeEvent& happening) {
      if (happening.event != kRequested) {
        return take_one(happening, *late, take);
      }
      if (limit->pass(happening.component, happening.time)) {
        take(record_of(happening));
        return supervisor.request(happening.component, happening.text);
      }
      if (const auto ignored = limit->ignored(happening.component); is_power_of_ten(ignored)) {
        take(ignored_request(happening, ignored));
      }
    });
    if (const auto together = late->missed_together(); together > 0) {
      take(logging::make_record(Event::missed_together,
                                {{"count", static_cast<std::int64_t>(together)}}));
    }
  };
}

}  // namespace mauve::daemon
