// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "render.h"

namespace mauve::ctl {
namespace {

using OrderedJson = nlohmann::ordered_json;

// The order of the examples: what it is, what is inside, how it is wired, how it runs.
constexpr std::array<std::string_view, 24> kOrder{
    "$schema", "schema", "name",       "plugins",   "resources", "components",
    "rules",   "type",   "data",       "interface", "core",      "fallback_core",
    "fsm",     "start",  "properties", "ports",     "task",      "priority",
    "cpus",    "offset", "deadline",   "budget",    "stack",     "on_overrun"};

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

}  // namespace

std::string render_architecture(const Json& architecture) {
  constexpr auto kReplace = OrderedJson::error_handler_t::replace;
  return in_order(architecture).dump(2, ' ', false, kReplace) + "\n";
}

std::string architecture_line(const Json& architecture) {
  constexpr auto kReplace = OrderedJson::error_handler_t::replace;
  return in_order(architecture).dump(-1, ' ', false, kReplace) + "\n";
}

}  // namespace mauve::ctl
