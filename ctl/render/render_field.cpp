// SPDX-License-Identifier: LGPL-3.0-or-later
#include "render/render_field.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "base/size.h"
#include "mtrace/trace.h"
#include "render/table.h"

namespace mauve::ctl {
namespace {

constexpr std::array<std::string_view, 3> kInstants{"next_release_ns", "t_ns", "fired_ns"};
constexpr std::array<std::string_view, 5> kLimits{"deadline", "budget", "watchdog", "lock_budget",
                                                  "max_age"};

bool is_one_of(const auto& names, std::string_view key) {
  return std::find(names.begin(), names.end(), key) != names.end();
}

bool is_size(std::string_view key) { return key == "stack" || key.ends_with("_bytes"); }

/// "double", "array of 3 double", "array of at most 8 structures".
std::string kind_in_words(const Json& kind) {
  if (kind.is_array()) return "structure";
  if (!kind.is_object()) return harmless(compact(kind));
  const std::string item = kind_in_words(member(kind, "array"));
  const bool bounded = kind.contains("capacity");
  return std::string(bounded ? "array of at most " : "array of ") +
         word(kind, bounded ? "capacity" : "size") + " " + item + (item == "structure" ? "s" : "");
}

void add_field_rows(const std::string& path, const Json& fields, Json& rows);

void add_fields_within(const std::string& path, const Json& kind, Json& rows) {
  if (kind.is_object()) add_fields_within(path + "[]", member(kind, "array"), rows);
  if (kind.is_array()) add_field_rows(path + ".", kind, rows);
}

void add_field_rows(const std::string& path, const Json& fields, Json& rows) {
  for (const Json& field : fields) {
    const std::string name = path + word(field, "name");
    const Json& kind = member(field, "kind");
    rows.push_back({{"name", name},
                    {"type", kind_in_words(kind)},
                    {"unit", word(field, "unit")},
                    {"text", word(field, "text")}});
    add_fields_within(name, kind, rows);
  }
}

}  // namespace

std::string field_title(const std::string& key) {
  return key.ends_with("_ns") && key.size() > 3 ? key.substr(0, key.size() - 3) : key;
}

std::string field_content(const Json& object, const std::string& key) {
  const Json& value = member(object, key);
  if (is_one_of(kLimits, key) && (value == "0s" || value == "0ns")) return "none";
  if (key == "safe_value" && value.is_boolean()) return value == true ? "declared" : "none";
  if (!value.is_number()) return word(object, key);
  if (is_one_of(kInstants, key)) {
    return mtrace::instant_in_words(static_cast<std::int64_t>(number(object, key)));
  }
  if (key.ends_with("_ns")) return nanoseconds_in_words(number(object, key));
  return is_size(key) ? format_size(whole_number(object, key)) : word(object, key);
}

Json machine_rows(const Json& machine) {
  Json rows = Json::array();
  for (const Json& state : list_in(machine, "states")) {
    Json row = state;
    const Json& transitions = list_in(state, "transitions");
    std::string next;
    for (std::size_t i = 0; i < transitions.size(); ++i) {
      const std::string mark = mark_of_transition(transitions, i);
      join(next, mark + (mark.empty() ? "" : " ") + word(transitions[i], "to"));
    }
    row.erase("transitions");
    row["next"] = next;
    rows.push_back(std::move(row));
  }
  return rows;
}

Json field_rows(const Json& fields) {
  Json rows = Json::array();
  add_field_rows("", fields, rows);
  return rows;
}

}  // namespace mauve::ctl
