// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/event.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

#include <fmt/format.h>

#include "log/json_text.h"

namespace mauve::logging {

namespace {

constexpr std::array<std::string_view, 4> kLevels = {"debug", "info", "warn", "error"};
constexpr std::string_view kMessageIdPrefix = "6d9c1f5a2b7e4c0f9a3d5e8b71f0";

std::int64_t monotonic_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

const Field* find(const Fields& fields, std::string_view name) {
  const auto it =
      std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; });
  return it == fields.end() ? nullptr : &*it;
}

/// A placeholder without a field stays as it is: a log line must never fail.
std::string expand(std::string_view text, const Fields& fields) {
  std::string out;
  while (!text.empty()) {
    const auto open = text.find('{');
    const auto close = text.find('}', open);
    if (open == std::string_view::npos || close == std::string_view::npos) {
      break;
    }
    out += text.substr(0, open);
    const auto* field = find(fields, text.substr(open + 1, close - open - 1));
    out += field != nullptr ? to_string(field->value) : text.substr(open, close - open + 1);
    text.remove_prefix(close + 1);
  }
  out += text;
  out.erase(out.find_last_not_of(' ') + 1);  // the last field may be empty
  return out;
}

std::string json_value(const Field::Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    return json_string(*text);
  }
  const auto* number = std::get_if<double>(&value);
  return number != nullptr && !std::isfinite(*number) ? "null" : to_string(value);
}

}  // namespace

std::string_view to_string(Level level) { return kLevels.at(static_cast<std::size_t>(level)); }

std::optional<Level> level_from(std::string_view name) {
  const auto it = std::find(kLevels.begin(), kLevels.end(), name);
  if (it == kLevels.end()) {
    return std::nullopt;
  }
  return static_cast<Level>(it - kLevels.begin());
}

const std::vector<EventInfo>& all_events() {
  static const std::vector<EventInfo> events = {
#define MAUVE_EVENT(number, name, level, text, advice) \
  {Event::name, #name, Level::level, text, advice},
#include "log/events.def"
#undef MAUVE_EVENT
  };
  return events;
}

const EventInfo& info(Event event) {
  const auto& events = all_events();
  const auto it = std::find_if(events.begin(), events.end(),
                               [&](const EventInfo& row) { return row.event == event; });
  return it == events.end() ? info(Event::core_message) : *it;
}

std::string_view to_string(Event event) { return info(event).name; }

std::string message_id(Event event) {
  return fmt::format("{}{:04x}", kMessageIdPrefix, static_cast<unsigned>(event));
}

std::string to_string(const Field::Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    return *text;
  }
  if (const auto* number = std::get_if<double>(&value)) {
    return fmt::format("{}", *number);
  }
  return fmt::format("{}", std::get<std::int64_t>(value));
}

Record make_record(Event event, Fields fields) {
  Record record;
  record.time = std::chrono::system_clock::now();
  record.monotonic_ns = monotonic_now();
  record.event = event;
  record.level = info(event).level;
  record.text = expand(info(event).text, fields);
  if (const auto* component = find(fields, "component")) {
    record.component = to_string(component->value);
    std::erase_if(fields, [](const Field& field) { return field.name == "component"; });
  }
  record.fields = std::move(fields);
  return record;
}

std::string utc(std::chrono::system_clock::time_point time) {
  const auto us =
      std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
  const auto seconds = static_cast<std::time_t>(us / 1'000'000);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 32> day{};
  const auto size = std::strftime(day.data(), day.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  return fmt::format("{}.{:06}Z", std::string_view(day.data(), size), us % 1'000'000);
}

std::string to_json_line(const Record& record) {
  std::string fields;
  for (const auto& field : record.fields) {
    fields += fmt::format("{}{}:{}", fields.empty() ? "" : ",", json_string(field.name),
                          json_value(field.value));
  }
  return fmt::format(
      R"({{"seq":{},"time":"{}","t_mono_ns":{},"level":"{}","event":"{}","component":{},"text":{},)"
      R"("fields":{{{}}}}})",
      record.seq, utc(record.time), record.monotonic_ns, to_string(record.level),
      to_string(record.event), json_string(record.component), json_string(record.text), fields);
}

}  // namespace mauve::logging
