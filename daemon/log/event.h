// SPDX-License-Identifier: LGPL-3.0-or-later
/// Events: everything mauved reports, listed in events.def and nowhere else.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace mauve::logging {

enum class Level : std::uint8_t { debug, info, warn, error };

/// "debug", "info", "warn", "error".
[[nodiscard]] std::string_view to_string(Level level);
[[nodiscard]] std::optional<Level> level_from(std::string_view name);

/// The names of events.def.
enum class Event : std::uint16_t {
#define MAUVE_EVENT(number, name, level, text, advice) name = number,
#include "log/events.def"
#undef MAUVE_EVENT
};

/// One row of events.def.
struct EventInfo {
  Event event;
  std::string_view name;
  Level level;
  std::string_view text;
  std::string_view advice;
};

/// [any] All events, in the order of the file.
[[nodiscard]] const std::vector<EventInfo>& all_events();
/// [any] The row of an event of events.def.
[[nodiscard]] const EventInfo& info(Event event);
/// [any] "component_faulted" and so on.
[[nodiscard]] std::string_view to_string(Event event);
/// [any] The 32 hex digits by which journald knows this kind of event.
[[nodiscard]] std::string message_id(Event event);

/// One named value of an event.
struct Field {
  using Value = std::variant<std::int64_t, double, std::string>;

  std::string name;
  Value value;
};
using Fields = std::vector<Field>;

[[nodiscard]] std::string to_string(const Field::Value& value);

/// One thing that happened, as kept, shown and written to every destination.
struct Record {
  std::uint64_t seq = 0;                       ///< 1, 2, 3...: a gap is a loss
  std::chrono::system_clock::time_point time;  ///< wall clock
  std::int64_t monotonic_ns = 0;               ///< CLOCK_MONOTONIC
  Event event = Event::core_message;
  Level level = Level::info;
  std::string component;  ///< empty when about the daemon itself
  std::string text;       ///< one sentence
  Fields fields;
};

/// [any] A record of an event with its text made from the fields; the field "component" becomes
/// Record::component. `seq` is given by the log.
[[nodiscard]] Record make_record(Event event, Fields fields);

/// [any] CLOCK_MONOTONIC, in ns.
[[nodiscard]] std::int64_t monotonic_now();
/// [any] Its time is now.
void stamp(Record& record);

/// [any] "2024-05-01T12:00:00.123456Z".
[[nodiscard]] std::string utc(std::chrono::system_clock::time_point time);

/// [any] The instant that such a text names. The text may have no fraction, an offset in place of
/// Z, or the day alone. Nothing is returned for any other text, and for years outside of 1970 to
/// 2200.
[[nodiscard]] std::optional<std::chrono::system_clock::time_point> time_from(std::string_view text);

/// [any] The record as one line of JSON, without the line end. Always valid UTF-8.
[[nodiscard]] std::string to_json_line(const Record& record);

}  // namespace mauve::logging
