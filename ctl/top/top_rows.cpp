// SPDX-License-Identifier: LGPL-3.0-or-later
/// From answers of the daemon to rows.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <map>

#include "render/words.h"
#include "top/top.h"

namespace mauve::ctl {
namespace {

std::map<std::string, const Json*> by_name(const Json& result) {
  std::map<std::string, const Json*> found;
  for (const Json& one : list_in(result, "components")) found.emplace(word(one, "name"), &one);
  return found;
}

const Json& named(const std::map<std::string, const Json*>& all, const std::string& name) {
  static const Json kNothing;
  const auto found = all.find(name);
  return found == all.end() ? kNothing : *found->second;
}

std::optional<double> maybe_time(const Json& object, const char* key) {
  if (!member(object, key).is_number()) return std::nullopt;
  return number(object, key);
}

double used(const Json& statistics) {
  return number(member(statistics, "execution"), "sum_ns") +
         number(member(statistics, "preempted"), "sum_ns");
}

/// Statistics that were reset meanwhile are compared with nothing.
std::optional<double> busy_share(const Json& now, double now_ns, const Json& before,
                                 double before_ns) {
  const std::optional<double> since = maybe_time(now, "since_ns");
  if (!since) return std::nullopt;
  const bool goes_on = maybe_time(before, "since_ns") == since && now_ns > before_ns;
  const double time = goes_on ? now_ns - before_ns : now_ns - *since;
  if (time <= 0) return std::nullopt;
  return (used(now) - (goes_on ? used(before) : 0)) / time;
}

/// The mean time from job to job. Where that is the grid of the releases within a few jobs, the
/// grid.
double every(double grid, const Json& now, double now_ns, const Json& before, double before_ns) {
  constexpr double kNear = 0.05;
  const auto jobs_of = [](const Json& one) { return number(member(one, "lateness"), "count"); };
  const std::optional<double> since = maybe_time(now, "since_ns");
  if (!since) return grid;
  const bool goes_on = maybe_time(before, "since_ns") == since && now_ns > before_ns &&
                       jobs_of(now) > jobs_of(before);
  const double time = goes_on ? now_ns - before_ns : now_ns - *since;
  const double jobs = jobs_of(now) - (goes_on ? jobs_of(before) : 0);
  if (jobs < 1 || time <= 0) return grid;
  const double mean = time / jobs;
  return std::abs(mean - grid) <= std::max(kNear * grid, grid / jobs) ? grid : mean;
}

std::string core_of(const Json& status) {
  const std::string version = word(status, "core_version");
  const bool unknown = version.empty() || version == "-";
  return word(status, "core") + (unknown ? "" : "@" + version);
}

std::string cpus_of(const Json& status) {
  std::string text;
  for (const Json& one : list_in(status, "cpus")) text += (text.empty() ? "" : ",") + compact(one);
  return text;
}

bool contains(const std::string& text, const std::string& part) {
  const auto same = [](unsigned char a, unsigned char b) {
    return std::tolower(a) == std::tolower(b);
  };
  return std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end();
}

/// The greatest first; by name where they are equal.
template <typename Value>
void sort_by(std::vector<TopRow>& rows, Value value) {
  std::stable_sort(rows.begin(), rows.end(), [&](const TopRow& a, const TopRow& b) {
    return value(a) != value(b) ? value(a) > value(b) : a.name < b.name;
  });
}

}  // namespace

std::vector<TopRow> top_rows(const TopData& now, const TopData& before) {
  std::vector<TopRow> rows;
  const double now_ns = number(now.statistics, "t_ns");
  const auto counted_now = by_name(now.statistics);
  const auto counted_before = by_name(before.statistics);
  for (const Json& status : list_in(now.status, "components")) {
    TopRow row;
    row.name = word(status, "name");
    const Json& statistics = named(counted_now, row.name);
    const std::string state = word(status, "state");
    row.running = state == "running";
    row.faulted = state == "faulted" || state == "recovering";
    row.state = row.running ? word(status, "fsm_state") : state;
    row.core = core_of(status);
    row.priority = number(status, "priority");
    row.cpus = cpus_of(status);
    row.every = every(number(status, "period_ns"), statistics, now_ns,
                      named(counted_before, row.name), number(before.statistics, "t_ns"));
    const bool counted = number(member(statistics, "lateness"), "count") > 0;
    if (counted) row.late_last = maybe_time(status, "lateness_last_ns");
    if (counted) row.elapsed_last = maybe_time(status, "elapsed_last_ns");
    row.late_max = maybe_time(member(statistics, "lateness"), "max_ns");
    row.execution_p99 = maybe_time(member(statistics, "execution"), "p99_ns");
    row.execution_max = maybe_time(member(statistics, "execution"), "max_ns");
    const double release = number(status, "next_release_ns");
    row.unfinished = row.running && release < number(now.status, "t_ns");
    row.busy = busy_share(statistics, now_ns, named(counted_before, row.name),
                          number(before.statistics, "t_ns"));
    row.missed = number(statistics, "missed");
    row.overruns = number(statistics, "overruns");
    rows.push_back(std::move(row));
  }
  return rows;
}

Json to_json(const TopRow& row) {
  const auto whole = [](double value) { return static_cast<std::int64_t>(value); };
  const auto maybe = [&](const std::optional<double>& value) {
    return value ? Json(whole(*value)) : Json();
  };
  return {{"name", row.name},
          {"state", row.state},
          {"running", row.running},
          {"core", row.core},
          {"priority", whole(row.priority)},
          {"cpus", row.cpus},
          {"every_ns", whole(row.every)},
          {"lateness_last_ns", maybe(row.late_last)},
          {"lateness_max_ns", maybe(row.late_max)},
          {"unfinished", row.unfinished},
          {"elapsed_last_ns", maybe(row.elapsed_last)},
          {"execution_p99_ns", maybe(row.execution_p99)},
          {"execution_max_ns", maybe(row.execution_max)},
          {"busy", row.busy ? Json(*row.busy) : Json()},
          {"missed", whole(row.missed)},
          {"overruns", whole(row.overruns)}};
}

std::vector<TopRow> arranged(std::vector<TopRow> rows, const TopView& view) {
  std::erase_if(rows, [&](const TopRow& row) {
    return !contains(row.name, view.filter) && !contains(row.core, view.filter);
  });
  switch (view.sort) {
    case TopSort::priority:
      sort_by(rows, [](const TopRow& row) { return row.priority; });
      break;
    case TopSort::name:
      sort_by(rows, [](const TopRow&) { return 0; });
      break;
    case TopSort::late:
      sort_by(rows, [](const TopRow& row) { return row.late_max.value_or(-1); });
      break;
    case TopSort::execution:
      sort_by(rows, [](const TopRow& row) { return row.execution_max.value_or(-1); });
      break;
    case TopSort::busy:
      sort_by(rows, [](const TopRow& row) { return row.busy.value_or(-1); });
      break;
    case TopSort::missed:
      sort_by(rows, [](const TopRow& row) { return row.missed + row.overruns; });
      break;
  }
  return rows;
}

std::optional<std::size_t> selected_row(const std::vector<TopRow>& rows, const TopView& view) {
  if (rows.empty()) return std::nullopt;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].name == view.selected) return i;
  }
  return 0;
}

}  // namespace mauve::ctl
