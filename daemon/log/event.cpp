// SPDX-License-Identifier: LGPL-3.0-or-later
#include "log/event.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

#include <fmt/format.h>

#include "log/json_text.h"
#include "mauve/host/value.h"

namespace mauve::logging {

namespace {

constexpr std::array<std::string_view, 4> kLevels = {"debug", "info", "warn", "error"};
// The clock counts nanoseconds in 64 bits.
constexpr int kFirstYear = 1970;
constexpr int kLastYear = 2200;
constexpr std::string_view kMessageIdPrefix = "6d9c1f5a2b7e4c0f9a3d5e8b71f0";

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
  const bool fits_json = number == nullptr || std::isfinite(*number);
  return fits_json ? to_string(value) : json_string(to_string(value));
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

/// A switch: an event number that stands twice does not compile.
std::string_view to_string(Event event) {
  switch (event) {
#define MAUVE_EVENT(number, name, level, text, advice) \
  case Event::name:                                    \
    return #name;
#include "log/events.def"
#undef MAUVE_EVENT
  }
  return to_string(Event::core_message);
}

std::string message_id(Event event) {
  return fmt::format("{}{:04x}", kMessageIdPrefix, static_cast<unsigned>(event));
}

std::string to_string(const Field::Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    return *text;
  }
  if (const auto* number = std::get_if<double>(&value)) {
    if (const std::string_view word = word_of_number(*number); !word.empty()) {
      return std::string(word);
    }
    return fmt::format("{}", *number);
  }
  return fmt::format("{}", std::get<std::int64_t>(value));
}

Record make_record(Event event, Fields fields) {
  Record record;
  stamp(record);
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

std::int64_t monotonic_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void stamp(Record& record) {
  record.time = std::chrono::system_clock::now();
  record.monotonic_ns = monotonic_now();
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

namespace {

/// So many digits.
std::optional<int> digits(std::string_view& text, std::size_t count) {
  if (text.size() < count) {
    return std::nullopt;
  }
  int number = 0;
  for (const char c : text.substr(0, count)) {
    if (c < '0' || c > '9') {
      return std::nullopt;
    }
    number = number * 10 + (c - '0');
  }
  text.remove_prefix(count);
  return number;
}

bool take(std::string_view& text, char wanted) {
  const bool found = !text.empty() && text.front() == wanted;
  text.remove_prefix(found ? 1 : 0);
  return found;
}

/// "a-b-c" or "a:b:c": each within its bounds.
bool three(std::string_view& text, char between, std::array<std::pair<std::size_t, int>, 3> forms,
           std::array<int, 3>& numbers) {
  for (std::size_t i = 0; i < forms.size(); ++i) {
    if (i > 0 && !take(text, between)) {
      return false;
    }
    const auto number = digits(text, forms[i].first);
    if (!number || *number > forms[i].second) {
      return false;
    }
    numbers[i] = *number;
  }
  return true;
}

/// "Z", "+02:00" or nothing at all is left.
std::optional<std::chrono::minutes> offset_of(std::string_view text) {
  if (text == "Z" || text == "z") {
    return std::chrono::minutes(0);
  }
  const bool west = take(text, '-');
  if (!west && !take(text, '+')) {
    return std::nullopt;
  }
  const auto hours = digits(text, 2);
  const bool colon = take(text, ':');
  const auto minutes = digits(text, 2);
  if (!hours || !minutes || !colon || *hours > 23 || *minutes > 59 || !text.empty()) {
    return std::nullopt;
  }
  return std::chrono::minutes((west ? -1 : 1) * (*hours * 60 + *minutes));
}

}  // namespace

std::optional<std::chrono::system_clock::time_point> time_from(std::string_view text) {
  using namespace std::chrono;
  std::array<int, 3> date_parts{};
  std::array<int, 3> time{};
  if (!three(text, '-', {{{4, kLastYear}, {2, 12}, {2, 31}}}, date_parts) ||
      date_parts[0] < kFirstYear) {
    return std::nullopt;
  }
  const year_month_day date{year{date_parts[0]}, month{static_cast<unsigned>(date_parts[1])},
                            day{static_cast<unsigned>(date_parts[2])}};
  if (!date.ok()) {
    return std::nullopt;
  }
  microseconds within{0};
  minutes offset{0};
  if (!text.empty()) {
    if (!take(text, 'T') && !take(text, 't') && !take(text, ' ')) {
      return std::nullopt;
    }
    if (!three(text, ':', {{{2, 23}, {2, 59}, {2, 60}}}, time)) {
      return std::nullopt;
    }
    within = hours(time[0]) + minutes(time[1]) + seconds(time[2]);
    if (take(text, '.')) {
      int weight = 100'000;
      std::size_t read = 0;
      for (; !text.empty() && text.front() >= '0' && text.front() <= '9'; ++read, weight /= 10) {
        within += microseconds((text.front() - '0') * weight);
        text.remove_prefix(1);
      }
      if (read == 0) {
        return std::nullopt;
      }
    }
    const auto found = offset_of(text);
    if (!found) {
      return std::nullopt;
    }
    offset = *found;
  }
  return system_clock::time_point(sys_days(date)) + within - offset;
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
