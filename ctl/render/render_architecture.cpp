// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "base/terminal_text.h"
#include "render/render.h"

namespace mauve::ctl {
namespace {

using OrderedJson = nlohmann::ordered_json;

// The order of the examples: type, members, connections, task.
constexpr std::array<std::string_view, 48> kOrder{
    "$schema",       "schema",    "name",         "plugins",       "resources",   "components",
    "transactions",  "rules",     "when",         "for",           "until",       "do",
    "disconnect",    "connect",   "swap",         "set",           "to",          "type",
    "data",          "interface", "core",         "fallback_core", "fsm",         "start",
    "properties",    "ports",     "lock_budget",  "task",          "may_request", "priority",
    "cpus",          "offset",    "deadline",     "budget",        "stack",       "on_overrun",
    "overrun_limit", "on_fault",  "watchdog",     "restart",       "per",         "back_off",
    "max_age",       "state",     "when_unknown", "cool_down",     "per_hour",    "lost"};

std::size_t rank(const std::string& key) {
  const auto found = std::find(kOrder.begin(), kOrder.end(), key);
  return static_cast<std::size_t>(found - kOrder.begin());
}

/// Names of the user's own keep the order a to z; only the words of the schema are moved.
OrderedJson in_order(const Json& value) {
  if (value.is_array()) {
    OrderedJson result = OrderedJson::array();
    for (const Json& item : value) result.push_back(in_order(item));
    return result;
  }
  if (!value.is_object()) return value;
  std::vector<std::string> keys;
  for (const auto& [key, content] : value.items()) keys.push_back(key);
  std::stable_sort(keys.begin(), keys.end(),
                   [](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
  OrderedJson result = OrderedJson::object();
  for (const auto& key : keys) result[key] = in_order(value[key]);
  return result;
}

constexpr std::size_t kLongestLine = 100;

std::string text_of(const OrderedJson& value) {
  return json_for_terminals(value.dump(-1, ' ', false, OrderedJson::error_handler_t::replace));
}

/// { "x": 3.2, "y": 0.4 }, [1, 2]
std::string in_one_line(const OrderedJson& value) {
  if (!value.is_structured() || value.empty()) return text_of(value);
  std::string result = value.is_object() ? "{ " : "[";
  bool first = true;
  for (const auto& [key, content] : value.items()) {
    if (!std::exchange(first, false)) result += ", ";
    if (value.is_object()) result += text_of(OrderedJson(key)) + ": ";
    result += in_one_line(content);
  }
  return result + (value.is_object() ? " }" : "]");
}

/// A value that fits stands in one line, as a person would write it; the outer objects never do.
std::string in_lines(const OrderedJson& value, std::size_t begin, std::size_t depth) {
  const std::string line = in_one_line(value);
  const bool may_be_one = value.empty() || !value.is_object() || depth > 1;
  if (!value.is_structured() || (may_be_one && begin + line.size() < kLongestLine)) return line;
  const std::string space(depth * 2 + 2, ' ');
  std::string result = value.is_object() ? "{" : "[";
  const char* separator = "\n";
  for (const auto& [key, content] : value.items()) {
    const std::string name = value.is_object() ? text_of(OrderedJson(key)) + ": " : "";
    result += separator + space + name + in_lines(content, space.size() + name.size(), depth + 1);
    separator = ",\n";
  }
  return result + "\n" + std::string(depth * 2, ' ') + (value.is_object() ? "}" : "]");
}

}  // namespace

std::string render_architecture(const Json& architecture) {
  return in_lines(in_order(architecture), 0, 0) + "\n";
}

std::string architecture_line(const Json& architecture) {
  return text_of(in_order(architecture)) + "\n";
}

}  // namespace mauve::ctl
