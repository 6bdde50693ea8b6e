// SPDX-License-Identifier: LGPL-3.0-or-later
#include <array>
#include <cstdio>
#include <string>

#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

Paint paint_of_level(const std::string& level) {
  if (level == "error" || level == "err" || level == "critical") return Paint::red;
  return level == "warn" || level == "warning" ? Paint::yellow : Paint::plain;
}

std::string wide(std::string text, std::size_t width) {
  const std::size_t used = columns(text);
  return used < width ? text.append(width - used, ' ') : text;
}

std::string seconds_of(const Json& params) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%12.6f", number(params, "t_ns") / 1e9);
  return text.data();
}

/// "new_data, 12.0 ms old".
std::string status_of(const Json& value) {
  const std::string status = word(value, "status");
  if (!value.is_object() || !value.contains("age_ns") || status == "current") return status;
  return status + ", " + nanoseconds_in_words(number(value, "age_ns")) + " old";
}

}  // namespace

std::string render_value(const Json& value, Look look) {
  const std::string address = painted(word(value, "address"), Paint::bold, look.colour);
  std::string status = status_of(value);
  if (value.is_object() && value.contains("kind")) {  // a port that does not read
    const std::string service = word(value, "service");
    status = status == "no_data" ? "leads to " + service : "leads to " + service + ", " + status;
  }
  const Json content = value.is_object() ? value.value("value", Json()) : Json();
  if (content.is_object() && !content.empty()) {
    std::string text = address + " (" + status + ")\n";
    const std::string block =
        render_object(content, {look.width > 22 ? look.width - 2 : 0, look.colour});
    for (std::size_t at = 0; at < block.size();) {
      const std::size_t end = block.find('\n', at);
      text += "  " + block.substr(at, end + 1 - at);
      at = end + 1;
    }
    return text;
  }
  const std::string tail = status == "current" || status.empty() ? "" : " (" + status + ")";
  const std::size_t around = columns(word(value, "address")) + 3 + columns(tail);
  const std::size_t room = look.width > around + 20 ? look.width - around : 0;
  return address + " = " + cut(compact(content), room) + tail + "\n";
}

std::string render_sample(const Json& params, Look look) {
  std::string text = seconds_of(params) + "  " + word(params, "address") + "  ";
  if (params.contains("count")) {
    return text +
           painted(word(params, "count") + " values dropped: this reader was too slow",
                   Paint::yellow, look.colour) +
           "\n";
  }
  if (word(params, "status") == "replaced") {
    return text +
           painted("replaced: what follows is of the resource that has its name now", Paint::yellow,
                   look.colour) +
           "\n";
  }
  text += wide(word(params, "status"), 8) + "  " + word(params, "value");
  if (word(params, "status") == "stale") {
    text += " (" + nanoseconds_in_words(number(params, "age_ns")) + " old)";
  }
  return cut(text, look.width) + "\n";
}

std::string render_record(const Json& record, Look look) {
  if (record.contains("count")) {
    return painted("(" + word(record, "count") + " records dropped: this reader was too slow)",
                   Paint::yellow, look.colour) +
           "\n";
  }
  const std::string level = word(record, "level");
  // On a terminal the time of day is enough; "2026-01-01T" stands before it.
  std::string time = word(record, "t");
  if (look.width > 0 && time.size() > 23) time = time.substr(11, 12);
  std::string text = time + "  " + wide(level, 5) + "  ";
  if (const auto component = word(record, "component"); !component.empty() && component != "-") {
    text += component + ": ";
  }
  text = wrapped(text + word(record, "text"), look.width, columns(time) + 9);
  const std::string paint = painted(level, paint_of_level(level), look.colour);
  return text.replace(time.size() + 2, level.size(), paint) + "\n";
}

}  // namespace mauve::ctl
