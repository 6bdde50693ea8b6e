// SPDX-License-Identifier: LGPL-3.0-or-later
#include "render/render.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "render/render_field.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

Paint paint_of_state(const std::string& state) {
  if (state == "running") return Paint::green;
  if (state == "faulted" || state == "recovering") return Paint::red;
  return state == "stopped" || state == "stale" ? Paint::yellow : Paint::plain;
}

Cell count_cell(const Json& component, std::string_view key) {
  std::string text = word(component, key);
  const bool bad = text != "0" && text != "-" && !text.empty();
  return {std::move(text), bad ? Paint::yellow : Paint::plain};
}

bool all_numbers(const Json& items, const std::string& key) {
  return std::all_of(items.begin(), items.end(), [&](const Json& item) {
    return !item.contains(key) || item[key].is_number() || item[key].is_null();
  });
}

bool is_list_of_objects(const Json& value) {
  return value.is_array() && !value.empty() &&
         std::all_of(value.begin(), value.end(), [](const Json& one) { return one.is_object(); });
}

std::string in_capitals(std::string text) {
  for (char& letter : text) {
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
    if (letter == '_') letter = ' ';
  }
  return text;
}

bool says_something(const Json& items, const std::string& key) {
  return std::any_of(items.begin(), items.end(), [&](const Json& item) {
    const std::string text = word(item, key);
    return !text.empty() && text != "-" && text != "[]";
  });
}

std::string table_of(const Json& items, Look look) {
  auto keys = keys_in_order(items);
  std::erase_if(keys, [&](const std::string& key) { return !says_something(items, key); });
  std::vector<Column> columns;
  for (const auto& key : keys) {
    columns.push_back({in_capitals(field_title(key)), all_numbers(items, key)});
  }
  Table table(std::move(columns));
  for (const Json& item : items) {
    std::vector<Cell> row;
    for (const auto& key : keys) {
      std::string text = item.contains(key) ? field_content(item, key) : std::string{};
      const bool state = key == "state" || key == "status";
      const Paint paint = state ? paint_of_state(text) : Paint::plain;
      row.push_back({std::move(text), paint});
    }
    table.add(std::move(row));
  }
  return table.text(look.width, look.colour);
}

/// A property as people read it: its default only where it differs, the range in one word.
Json short_property(Json property) {
  if (property.contains("default") && property.contains("value") &&
      property["default"] == property["value"]) {
    property.erase("default");
  }
  const std::string low = word(property, "min");
  const std::string high = word(property, "max");
  const bool open_below = low.empty() || low == "-";
  const bool open_above = high.empty() || high == "-";
  if (!open_below && !open_above) property["range"] = low + " to " + high;
  if (!open_below && open_above) property["range"] = "from " + low;
  if (open_below && !open_above) property["range"] = "up to " + high;
  for (const char* key : {"min", "max", "type"}) property.erase(key);
  return property;
}

/// The ports without a count that is 0.
Json short_ports(Json ports) {
  for (Json& port : ports) {
    if (number(port, "implausible") == 0) port.erase("implausible");
  }
  return ports;
}

std::string block_of(const std::string& key, const Json& value, Look look) {
  if (key == "machine" && value.is_object()) {
    return "initial  " + word(value, "initial") + "\n" + table_of(machine_rows(value), look);
  }
  if (value.is_object()) return render_object(value, look);
  if (key == "fields") return table_of(field_rows(value), look);
  if (key == "ports") return table_of(short_ports(value), look);
  if (key != "properties") return table_of(value, look);
  Json rows = Json::array();
  for (const Json& property : value) rows.push_back(short_property(property));
  return table_of(rows, look);
}

std::string indented(const std::string& text, std::size_t depth) {
  const std::string space(depth, ' ');
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
    result += space + text.substr(at, end + 1 - at);
    at = end + 1;
  }
  return result;
}

/// The first such word in red.
std::string painted_word(std::string text, const std::string& found, Look look) {
  const auto at = text.find(found);
  if (at != std::string::npos)
    text.replace(at, found.size(), painted(found, Paint::red, look.colour));
  return text;
}

Look narrower(Look look, std::size_t by) {
  if (look.width > by + 20) look.width -= by;
  return look;
}

std::string titled(const std::string& key, const std::string& block, Look look) {
  return painted(harmless(key), Paint::bold, look.colour) + "\n" + indented(block, 2);
}

/// The troubles of the system that no row of a component shows.
std::string troubles(const Json& status, Look look) {
  std::string text;
  const auto add = [&](const std::string& line) {
    text += painted(wrapped(line, look.width, 2), Paint::red, look.colour) + "\n";
  };
  const Json& poisoned = member(status, "poisoned");
  for (const Json& name : poisoned.is_array() ? poisoned : Json::array()) {
    add(harmless(compact(name)) +
        ": is poisoned: a call was aborted in it, and it refuses its users until it has a new "
        "core");
  }
  const Json& left = member(status, "abandoned_threads");
  for (const Json& one : left.is_array() ? left : Json::array()) {
    const std::string hook = word(one, "hook");
    add("abandoned thread: " + (hook.empty() ? "user code" : hook) + " since " +
        word(one, "since"));
  }
  const Json& guardian = member(status, "guardian");
  if (guardian.is_object() && member(guardian, "present") == false) {
    std::string outputs;
    for (const Json& name : list_in(guardian, "outputs")) {
      outputs += (outputs.empty() ? "" : ", ") + harmless(compact(name));
    }
    add(outputs + ": no guardian holds it for " + seconds_in_words(number(guardian, "absent_s")) +
        ", so it stays as it is should mauved be killed: " + word(guardian, "why"));
  }
  return text;
}

/// ", log level debug for 9 min still, log level of control warn": those that are not the default.
std::string log_levels(const Json& status) {
  const Json& levels = member(status, "log_levels");
  std::string text;
  for (const Json& one : levels.is_array() ? levels : Json::array()) {
    const std::string component = word(one, "component");
    text +=
        ", log level " + (component.empty() ? "" : "of " + component + " ") + word(one, "level");
    if (number(one, "left_s") > 0)
      text += " for " + seconds_in_words(number(one, "left_s")) + " still";
  }
  return text;
}

}  // namespace

std::string render_heading(const Json& status) {
  const Json& components = list_in(status, "components");
  const auto running = std::count_if(components.begin(), components.end(), [](const Json& one) {
    return word(one, "state") == "running";
  });
  std::string text = word(status, "architecture") + ": " + std::to_string(running) + " of " +
                     counted(components.size(), "component") + " running, generation " +
                     word(status, "generation");
  if (status.contains("uptime_s")) text += ", up " + seconds_in_words(number(status, "uptime_s"));
  const Json& realtime = member(status, "realtime");
  if (realtime.is_boolean()) text += realtime == true ? ", real time" : ", NOT real time";
  if (realtime.is_string()) text += ", real time: " + compact(realtime);
  if (member(status, "saved") == false) text += ", NOT saved";
  if (status.contains("disk_silent_s")) {
    text += ", the DISK has not answered for " + seconds_in_words(number(status, "disk_silent_s"));
  }
  if (!list_in(status, "probations").empty()) text += ", on probation";
  if (const auto lock = word(status, "lock"); !lock.empty() && lock != "none") {
    text += ", " + lock + " locked";
  }
  return text + log_levels(status);
}

std::string render_status(const Json& status, Look look) {
  const Json& components = member(status, "components");
  Table table({{"NAME"},
               {"STATE"},
               {"FSM", false, 2},
               {"CORE", false, 4},
               {"PRIO", true, 5},
               {"RELEASES", true, 6},
               {"MISSED", true, 1},
               {"OVERRUNS", true, 3}});
  for (const Json& one : components) {
    const std::string state = word(one, "state");
    table.add({{word(one, "name")},
               {state, paint_of_state(state)},
               {word(one, "fsm_state")},
               {word(one, "core")},
               {word(one, "priority")},
               {word(one, "releases")},
               count_cell(one, "missed"),
               count_cell(one, "overruns")});
  }
  std::string text = wrapped(render_heading(status), look.width, 2) + "\n";
  if (!components.empty()) text += table.text(look.width, look.colour);
  for (const Json& one : components) {
    if (const auto fault = word(one, "fault"); !fault.empty()) {
      const auto hint = word(one, "hint");
      std::string stands = hint.empty() ? "" : "; it does not run: " + hint;
      if (const auto how = recovery_in_words(member(one, "recovery")); !how.empty()) {
        stands = "; it does not run, and " + how;
      }
      text += painted(wrapped(word(one, "name") + ": " + fault + stands, look.width, 2), Paint::red,
                      look.colour) +
              "\n";
    }
    if (const double late = number(one, "late_ns"); late > 0) {
      const std::string said = ": its job should have ended " + nanoseconds_in_words(late) + " ago";
      text += painted(word(one, "name") + said, Paint::red, look.colour) + "\n";
    }
  }
  return text + troubles(status, look) + render_pending(status, look);
}

std::string render_list(const Json& result, Look look) {
  const Json& items = member(result, "items");
  if (!items.is_array() || items.empty()) return "none\n";
  if (is_list_of_objects(items)) return table_of(items, look);
  std::string text;
  for (const Json& item : items) text += compact(item) + "\n";
  return text;
}

namespace {

/// The text in lines to the right of a column of titles.
std::string beside(const std::string& text, std::size_t titles, Look look) {
  const std::string lines = wrapped(text, look.width > titles ? look.width - titles : 0, 0) + "\n";
  std::string result;
  for (const std::string_view line : lines_of(lines)) {
    if (!result.empty()) result.append(titles, ' ');
    result.append(line).append("\n");
  }
  return result;
}

}  // namespace

std::string render_object(const Json& object, Look look) {
  if (!object.is_object()) return compact(object) + "\n";
  auto keys = keys_in_order(object);
  std::erase_if(keys,
                [&](const auto& key) { return object[key].empty() && !object[key].is_null(); });
  std::erase_if(keys, [&](const auto& key) { return object[key] == ""; });
  const auto is_block = [&](const std::string& key) {
    return (object[key].is_object() && !object[key].empty()) || is_list_of_objects(object[key]);
  };
  std::size_t widest = 0;
  for (const auto& key : keys) {
    if (!is_block(key)) widest = std::max(widest, columns(field_title(key)));
  }
  std::string lines;
  std::string blocks;
  for (const auto& key : keys) {
    const Json& value = object[key];
    if (is_block(key)) {
      blocks += titled(key, block_of(key, value, narrower(look, 2)), look);
      continue;
    }
    const std::string title = field_title(key);
    const std::string space(widest - columns(title) + 2, ' ');
    lines += harmless(title) + space + beside(field_content(object, key), widest + 2, look);
  }
  return lines + blocks;
}

std::string render_quarantine(const Json& list, Look look) {
  const Json& cores = member(list, "cores");
  if (cores.empty()) return "no core is in quarantine\n";
  std::string text;
  for (const Json& one : cores) {
    text += wrapped(word(one, "core") + ": it " + word(one, "reason"), look.width, 2) + "\n";
  }
  return text;
}

std::string render_errors(std::string_view file, const Json& result, Look look) {
  const Json& errors = member(result, "errors");
  if (errors.empty()) return std::string(file) + ": no errors\n" + note_lines(result, look);
  std::string text;
  for (const Json& error : errors) {
    const auto at = word(error, "at");
    const std::string line = std::string(file) + ":" + word(error, "line") + ":" +
                             word(error, "column") + ": error: " + (at.empty() ? "" : at + ": ") +
                             word(error, "message");
    const auto id = word(error, "id");
    text += painted_word(wrapped(id.empty() ? line : line + " [" + id + "]", look.width, 2),
                         "error:", look) +
            "\n";
    if (const auto hint = word(error, "hint"); !hint.empty()) {
      text += wrapped("  hint: " + hint, look.width, 4) + "\n";
    }
  }
  return text + counted(errors.size(), "error") + "\n";
}

}  // namespace mauve::ctl
