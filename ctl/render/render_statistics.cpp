// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

/// Null: there was none.
std::string time_in(const Json& times, const char* key) {
  return member(times, key).is_number() ? nanoseconds_in_words(number(times, key)) : "-";
}

std::string percent(double part, double whole) {
  if (whole <= 0) return "-";
  std::array<char, 32> text{};
  const double share = 100 * part / whole;
  std::snprintf(text.data(), text.size(), share < 10 ? "%.1f %%" : "%.0f %%", share);
  return text.data();
}

double undisturbed_max(const Json& one) { return number(member(one, "execution"), "max_ns"); }

/// By the longest job that nothing preempted, or by the longest of those that exceeded it.
std::string budget_used(const Json& one) {
  const double used = std::max(undisturbed_max(one), number(one, "over_budget_max_ns"));
  return percent(used, number(one, "budget_ns"));
}

/// "budget 100 us: exceeded by 253 of 273 jobs, longest 15.0 ms of processor time"
std::string budget_in_words(const Json& one) {
  const double budget = number(one, "budget_ns");
  const std::string text = "budget " + nanoseconds_in_words(budget) + ": ";
  const std::uint64_t over = whole_number(one, "over_budget");
  if (over == 0) return text + "the longest undisturbed job used " + budget_used(one);
  return text + "exceeded by " + std::to_string(over) + " of " +
         counted(whole_number(member(one, "lateness"), "count"), "job") + ", longest " +
         nanoseconds_in_words(number(one, "over_budget_max_ns")) + " of processor time";
}

Cell trouble_cell(const Json& one, const char* key) {
  return {word(one, key), number(one, key) > 0 ? Paint::yellow : Paint::plain};
}

std::vector<Cell> row_of(const Json& one) {
  const Json& late = member(one, "lateness");
  const Json& clean = member(one, "execution");
  const double preempted = number(member(one, "preempted"), "count");
  const Cell over = number(one, "over_budget") > 0 ? Cell{budget_used(one), Paint::yellow}
                                                   : Cell{budget_used(one)};
  return {{word(one, "name")},
          {word(late, "count")},
          {time_in(late, "p99_ns")},
          {time_in(late, "max_ns")},
          {time_in(clean, "p50_ns")},
          {time_in(clean, "p99_ns")},
          {time_in(clean, "max_ns")},
          {percent(preempted, preempted + number(clean, "count"))},
          {time_in(member(one, "response"), "max_ns")},
          over,
          trouble_cell(one, "missed"),
          trouble_cell(one, "overruns")};
}

std::string all_of(const Json& components, Look look) {
  Table table({{"NAME"},
               {"JOBS", true, 3},
               {"LATE P99", true, 5},
               {"LATE MAX", true},
               {"EXEC P50", true, 7},
               {"EXEC P99", true, 4},
               {"EXEC MAX", true},
               {"PREEMPTED", true, 8},
               {"RESPONSE", true, 2},
               {"BUDGET", true, 6},
               {"MISSED", true, 1},
               {"OVERRUNS", true, 1}});
  for (const Json& one : components) table.add(row_of(one));
  return table.text(look.width, look.colour);
}

/// These times contain the processor time of the jobs and that of the threads that preempted them.
constexpr const char* kPreempted = "  with preemption";

struct Figure {
  const char* title;
  const char* key;
  int rank;  ///< of its column
};
constexpr std::array<Figure, 6> kFigures{{{"MEAN", "mean_ns", 3},
                                          {"P50", "p50_ns", 2},
                                          {"P90", "p90_ns", 5},
                                          {"P99", "p99_ns", 1},
                                          {"P99.9", "p99_9_ns", 4},
                                          {"MAX", "max_ns", 0}}};

Table figures(const char* title) {
  std::vector<Column> columns{{title}, {"COUNT", true}};
  for (const Figure& figure : kFigures) columns.push_back({figure.title, true, figure.rank});
  return Table(std::move(columns));
}

void add_figures(Table& table, const std::string& name, Json times) {
  if (!times.contains("mean_ns") && number(times, "count") > 0) {
    times["mean_ns"] = number(times, "sum_ns") / number(times, "count");
  }
  std::vector<Cell> row{{name}, {word(times, "count")}};
  for (const Figure& figure : kFigures) row.push_back({time_in(times, figure.key)});
  table.add(std::move(row));
}

/// "control: guidance/gap; counted for 5 min 2 s"
std::string since_when(const Json& one, double now) {
  std::string text = word(one, "name") + ": " + word(one, "core");
  if (!member(one, "since_ns").is_number()) return text + "; no job yet\n";
  return text + "; counted for " + seconds_in_words((now - number(one, "since_ns")) / 1e9) + "\n";
}

std::string remarks(const Json& one, Look look) {
  std::string text = counted(whole_number(one, "missed"), "release") + " missed, " +
                     counted(whole_number(one, "overruns"), "overrun");
  if (number(one, "budget_ns") > 0) text += "; " + budget_in_words(one);
  if (const Json& waits = member(one, "lock_waits"); number(waits, "count") > 0) {
    text += "; waited " + counted(whole_number(waits, "count"), "time") + " for resources, " +
            time_in(waits, "sum_ns") + " in all, at most " + time_in(waits, "max_ns");
  }
  text = wrapped(text, look.width, 2) + "\n";
  const auto kernel = kernel_in_words(member(one, "kernel"));
  return kernel.empty() ? text : text + wrapped(kernel, look.width, 2) + "\n";
}

std::string states_of(const Json& states, Look look) {
  if (states.empty()) return {};
  Table table = figures("STATE");
  for (const Json& state : states) {
    add_figures(table, word(state, "name"), member(state, "execution"));
    const Json& preempted = member(state, "preempted");
    if (number(preempted, "count") > 0) add_figures(table, kPreempted, preempted);
  }
  return table.text(look.width, look.colour);
}

}  // namespace

std::string render_details(const Json& one, double now_ns, Look look) {
  Table jobs = figures("JOBS");
  add_figures(jobs, "late by", member(one, "lateness"));
  add_figures(jobs, "execution", member(one, "execution"));
  add_figures(jobs, kPreempted, member(one, "preempted"));
  add_figures(jobs, "response", member(one, "response"));
  return wrapped(since_when(one, now_ns), look.width, 2) + jobs.text(look.width, look.colour) +
         remarks(one, look) + states_of(list_in(one, "states"), look);
}

std::string render_statistics(const Json& result, Look look) {
  const Json& components = list_in(result, "components");
  if (components.empty()) return "no component runs\n";
  if (!components.front().contains("states")) return all_of(components, look);
  return render_details(components.front(), number(result, "t_ns"), look);
}

}  // namespace mauve::ctl
