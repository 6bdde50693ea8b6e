// SPDX-License-Identifier: LGPL-3.0-or-later
/// The answers of a daemon with four components to top.
#pragma once

#include "render/words.h"
#include "top/top.h"

namespace mauve::ctl {

inline double number_of(const Json& object, const char* key) { return number(object, key); }

/// control runs; laser is in its job; driver is faulted; spare never ran.
inline TopData top_answers() {
  const auto times = [](std::uint64_t count, std::int64_t sum, std::int64_t longest) -> Json {
    if (count == 0) return {{"count", 0}, {"sum_ns", 0}, {"p99_ns", nullptr}, {"max_ns", nullptr}};
    return {{"count", count},
            {"sum_ns", sum},
            {"mean_ns", 20'000},
            {"p99_ns", 40'000},
            {"max_ns", longest}};
  };
  const auto counted = [&](const char* name, std::uint64_t jobs) -> Json {
    return {{"name", name},
            {"core", "guidance/gap"},
            {"since_ns", jobs == 0 ? Json() : Json(51'000'000'000)},
            {"missed", 0},
            {"overruns", 0},
            {"lateness", times(jobs, 1'000'000, 60'000)},
            {"execution", times(jobs, 200'000'000, 70'000)},
            {"preempted", times(jobs / 10, 100'000'000, 900'000)},
            {"response", times(jobs, 400'000'000, 960'000)}};
  };
  const auto component = [](const char* name, const char* state, int priority,
                            std::int64_t release) -> Json {
    return {{"name", name},
            {"state", state},
            {"fsm_state", "reach_goal"},
            {"core", "guidance/gap"},
            {"core_version", "1.2"},
            {"priority", priority},
            {"cpus", {0, 1}},
            {"period_ns", 10'000'000},
            {"next_release_ns", release},
            {"lateness_last_ns", 12'345},
            {"elapsed_last_ns", 23'456}};
  };
  TopData data;
  data.status = {{"architecture", "rover"},
                 {"generation", 3},
                 {"t_ns", 61'000'000'000},
                 {"components",
                  {component("control", "running", 40, 61'005'000'000),
                   component("laser", "running", 60, 60'999'000'000),
                   component("driver", "faulted", 30, 0), component("spare", "stopped", 10, 0)}}};
  data.statistics = {{"t_ns", 61'000'000'000},
                     {"components",
                      {counted("control", 1000), counted("laser", 400), counted("driver", 10),
                       counted("spare", 0)}}};
  data.statistics["components"][0]["missed"] = 2;
  return data;
}

}  // namespace mauve::ctl
