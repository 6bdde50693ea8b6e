// SPDX-License-Identifier: LGPL-3.0-or-later
#include <cstdio>
#include <string>

#include "render/render.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

/// Null: no bound was found.
std::string time_of(const Json& row, const char* key) {
  const Json value = row.is_object() ? row.value(key, Json()) : Json();
  return value.is_number() ? nanoseconds_in_words(number(row, key)) : "-";
}

std::string execution_of(const Json& row) {
  return word(row, "source") == "unknown" ? "-" : time_of(row, "execution_ns");
}

/// "CPU 0: 55 %, CPU 1: 3 %"
std::string loads_of(const Json& cpus) {
  std::string text;
  for (const Json& cpu : cpus) {
    char load[32];
    std::snprintf(load, sizeof load, "%.0f %%", 100 * number(cpu, "load"));
    text += (text.empty() ? "CPU " : ", CPU ") + word(cpu, "cpu") + ": " + load;
  }
  return text;
}

std::string verdict_of(const Json& result) {
  const Json factor = result.is_object() ? result.value("factor", Json()) : Json();
  if (!factor.is_number()) {
    return "not proved: some execution times are unknown, or some components may run on several "
           "CPUs";
  }
  char text[120];
  const bool late = factor.get<double>() < 1;
  const bool contradicted = !list_in(result, "contradictions").empty();
  std::snprintf(text, sizeof text,
                late ? "not proved: deadlines would be met with %.2f of the execution times"
                : contradicted
                    ? "for the assumed times only: deadlines are met up to %.2f times the "
                      "execution times"
                    : "proved: deadlines are met up to %.2f times the execution times",
                factor.get<double>());
  return late || list_in(result, "problems").empty() ? text : "not proved: see the warnings";
}

/// "not valid for what runs: ...", before everything else.
std::string contradictions_of(const Json& result, Look look) {
  std::string text;
  for (const Json& one : list_in(result, "contradictions")) {
    join(text, harmless(compact(one)), "; ");
  }
  if (text.empty()) return {};
  text = wrapped("not valid for what runs: " + text, look.width, 2);
  return painted(text, Paint::red, look.colour) + "\n";
}

/// How long resources with a lock are held; where that is unknown, whole jobs count.
std::string locks_of(const Json& locks, Look look) {
  if (locks.empty()) return {};
  Table table({{"LOCK"}, {"HOLD", true}, {"SOURCE"}});
  for (const Json& lock : locks) {
    const bool unknown = word(lock, "source") == "unknown";
    table.add({{word(lock, "resource")},
               {time_of(lock, "lock_budget_ns")},
               {word(lock, "source"), unknown ? Paint::yellow : Paint::plain}});
  }
  return table.text(look.width, look.colour);
}

}  // namespace

std::string render_analysis(const Json& result, Look look) {
  const Json& rows = list_in(result, "components");
  if (rows.empty()) return "no component runs\n";
  Table table({{"NAME"},
               {"CPU", true},
               {"PRIO", true},
               {"EXECUTION", true},
               {"SOURCE"},
               {"BLOCKED", true},
               {"RESPONSE", true},
               {"DEADLINE", true},
               {"SLACK", true}});
  for (const Json& row : rows) {
    const bool unknown = word(row, "source") == "unknown";
    const bool late = number(row, "slack_ns") < 0 || time_of(row, "response_ns") == "-";
    table.add({{word(row, "name")},
               {word(row, "cpu")},
               {word(row, "priority")},
               {execution_of(row)},
               {word(row, "source"), unknown ? Paint::yellow : Paint::plain},
               {time_of(row, "blocking_ns")},
               {time_of(row, "response_ns")},
               {time_of(row, "deadline_ns")},
               {time_of(row, "slack_ns"), late ? Paint::red : Paint::plain}});
  }
  std::string text = contradictions_of(result, look) + table.text(look.width, look.colour);
  text += wrapped(
              "execution time: processor time of a job; response time: elapsed, from its "
              "release to its end",
              look.width, 2) +
          "\n";
  text += locks_of(list_in(result, "locks"), look);
  text += wrapped(verdict_of(result) + "; " + loads_of(list_in(result, "cpus")), look.width, 2);
  text += "\n";
  for (const Json& problem : list_in(result, "problems")) {
    text += wrapped("warning: " + harmless(compact(problem)), look.width, 2) + "\n";
  }
  for (const Json& note : list_in(result, "notes")) {
    text += wrapped("note: " + harmless(compact(note)), look.width, 2) + "\n";
  }
  return text;
}

}  // namespace mauve::ctl
