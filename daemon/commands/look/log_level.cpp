// SPDX-License-Identifier: LGPL-3.0-or-later
/// log.level and log.set_level: the lowest level that is logged, for a time if one is given.
#include <algorithm>
#include <chrono>
#include <optional>

#include "base/duration.h"
#include "commands/answer.h"
#include "commands/look/log_json.h"
#include "commands/model.h"

namespace mauve::daemon {

namespace {

using std::chrono::steady_clock;

constexpr const char* kUsual = "default";
constexpr Duration kLongestLevel = std::chrono::hours(24);

/// The level that the request asks for; no level stands for the usual one.
struct Wanted {
  std::optional<logging::Level> level;
  std::string component;
  std::optional<Duration> length;
  std::string length_said;
};

Result<Wanted> wanted_from(const Running& running, const Json& params) {
  Wanted wanted;
  const auto name = text_or(params, "level");
  wanted.level = logging::level_from(name);
  if (!wanted.level && name != kUsual) {
    return refuse({Errc::invalid_value, "not_a_choice"}, "level",
                  "'" + name.substr(0, 64) + "' is no level",
                  "debug, info, warn, error or default");
  }
  wanted.component = text_or(params, "component");
  if (!wanted.component.empty()) {
    if (const auto component = find_component(running, wanted.component); !component) {
      return component.error();
    }
  }
  if (const auto text = text_or(params, "for"); !text.empty()) {
    const auto length = parse_duration(text);
    if (!length || *length <= Duration{0} || *length > kLongestLevel || !wanted.level) {
      return refuse({Errc::invalid_value, "not_a_time"}, "for",
                    "'" + text.substr(0, 64) + "' is no time for this",
                    "such as 10min, at most 24h; default has none");
    }
    wanted.length = *length;
    wanted.length_said = text;
  }
  return wanted;
}

}  // namespace

Json log_levels_json(const Running& running) {
  const auto now = steady_clock::now();
  Json rows = Json::array();
  for (const auto& one : running.log.levels().list()) {
    Json left = nullptr;
    if (one.until) {
      left = std::chrono::ceil<std::chrono::seconds>(
                 std::max(*one.until - now, steady_clock::duration(0)))
                 .count();
    }
    rows.push_back({{"component", one.component},
                    {"level", to_string(one.level)},
                    {"left_s", std::move(left)}});
  }
  return rows;
}

Result<Json> show_log_level(Running& running, const Call& /*call*/) {
  auto& levels = running.log.levels();
  return Json{{"level", to_string(levels.of({}))},
              {"default", to_string(levels.usual())},
              {"items", log_levels_json(running)}};
}

void set_log_level(Running& running, const CallPtr& call, Ticket /*none: it waits for no change*/) {
  const auto wanted = wanted_from(running, call->params);
  if (!wanted) {
    return answer(running, *call, wanted.error());
  }
  if (auto met = check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  std::optional<steady_clock::time_point> until;
  if (wanted->length) {
    until = steady_clock::now() + *wanted->length;
  }
  auto& levels = running.log.levels();
  levels.set(wanted->component, wanted->level, until);
  const std::string level(to_string(levels.of(wanted->component)));
  running.log.write(logging::Event::log_level_set,
                    {{"component", wanted->component},
                     {"level", level},
                     {"until", wanted->length ? "for " + wanted->length_said
                                              : std::string("until it is set again")}});
  answer(running, *call,
         Json{{"component", wanted->component},
              {"level", level},
              {"for", wanted->length ? Json(wanted->length_said) : Json()},
              {"changed", true},
              {"state", "applied"},
              {"generation", running.generation.load()}});
}

}  // namespace mauve::daemon
