// SPDX-License-Identifier: LGPL-3.0-or-later
/// metrics.get: state and statistics for Prometheus, text exposition format 0.0.4.
#include <array>
#include <cstdio>
#include <initializer_list>

#include "commands/command.h"
#include "mauve/host/architecture.h"
#include "mauve/host/version.h"

namespace mauve::daemon {

namespace {

struct Label {
  std::string_view name;
  std::string_view value;
};

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\' || c == '"') {
      out += '\\';
    }
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out;
}

std::string text_of(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.15g", value);
  return text.data();
}

double in_seconds(Duration time) { return static_cast<double>(time.count()) / 1e9; }
double as_number(std::uint64_t number) { return static_cast<double>(number); }

/// The samples of a family stand together, so families are written one after the other.
class Page {
 public:
  void family(std::string_view name, std::string_view type, std::string_view help) {
    name_ = "mauve_";
    name_ += name;
    text_.append("# HELP ").append(name_).append(" ").append(help).append("\n");
    text_.append("# TYPE ").append(name_).append(" ").append(type).append("\n");
  }
  void sample(std::initializer_list<Label> labels, double value) { add("", labels, {}, value); }
  /// Each bound is four times the one before, and a bound of our own buckets, so counts are exact.
  void histogram(std::initializer_list<Label> labels, const Distribution& times) {
    constexpr std::int64_t kFirst = 1LL << 10U;  // 1 us
    constexpr std::int64_t kLast = 1LL << 32U;   // 4.3 s
    std::uint64_t passed = 0;
    auto bucket = times.buckets.begin();
    for (std::int64_t bound = kFirst; bound <= kLast; bound *= 4) {
      for (; bucket != times.buckets.end() && bucket->to.count() <= bound; ++bucket) {
        passed += bucket->count;
      }
      add("_bucket", labels, text_of(in_seconds(Duration{bound})), as_number(passed));
    }
    for (; bucket != times.buckets.end(); ++bucket) {
      passed += bucket->count;
    }
    add("_bucket", labels, "+Inf", as_number(passed));
    add("_sum", labels, {}, in_seconds(times.sum));
    add("_count", labels, {}, as_number(passed));
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  void add(std::string_view suffix, std::initializer_list<Label> labels, const std::string& bound,
           double value) {
    std::string inside;
    for (const auto& [name, said] : labels) {
      inside.append(inside.empty() ? "" : ",").append(name).append("=\"");
      inside.append(escaped(said)).append("\"");
    }
    if (!bound.empty()) {
      inside.append(inside.empty() ? "" : ",").append("le=\"").append(bound).append("\"");
    }
    text_.append(name_).append(suffix);
    if (!inside.empty()) {
      text_.append("{").append(inside).append("}");
    }
    text_.append(" ").append(text_of(value)).append("\n");
  }

  std::string name_;
  std::string text_;
};

void add_system(Page& page, const Running& running) {
  const std::chrono::duration<double> up = std::chrono::steady_clock::now() - running.since;
  page.family("info", "gauge", "What runs; always 1.");
  page.sample({{"architecture", running.architecture.name()}, {"version", kVersion}}, 1);
  page.family("generation", "gauge", "Generation in force.");
  page.sample({}, as_number(running.deployer.generation()));
  page.family("uptime_seconds", "gauge", "Time since the daemon started.");
  page.sample({}, up.count());
  page.family("log_records_unwritten_total", "counter",
              "Records that a destination of the log did not take.");
  page.sample({}, as_number(running.log.unwritten()));
}

/// Counted since mauved began, also of methods that are not called any more.
void add_commands(Page& page, const Counts& counts) {
  page.family("commands_total", "counter", "Requests that were answered, refused ones included.");
  for (const auto& [method, count] : counts.answers()) {
    page.sample({{"method", method}}, as_number(count));
  }
  page.family("refusals_total", "counter", "Requests that were refused, by the name of the error.");
  for (const auto& [what, count] : counts.refusals()) {
    page.sample({{"method", what.first}, {"error", what.second}}, as_number(count));
  }
}

/// The outcomes that the system caused by itself. The component of a rollback is empty when a user
/// asked for it, or no user confirmed the change.
void add_outcomes(Page& page, const Counts& counts, const std::vector<ComponentStatus>& all) {
  struct Counter {
    const char* name;
    const char* help;
    Outcome::Kind kind;
  };
  constexpr std::array<Counter, 3> kCounters{
      {{"restarts_total", "Faults after which a fresh core took over.", Outcome::Kind::restarted},
       {"fallbacks_total", "Faults after which the fallback core took over.",
        Outcome::Kind::fell_back},
       {"rollbacks_total",
        "Changes that were rolled back, by the component at fault; empty: by an undo, or without a "
        "confirmation.",
        Outcome::Kind::rolled_back}}};
  for (const auto& counter : kCounters) {
    page.family(counter.name, "counter", counter.help);
    auto counted = counts.of(counter.kind);
    for (const auto& one : all) {
      counted[one.name] += 0;  // a series begins with zero
    }
    for (const auto& [component, count] : counted) {
      page.sample({{"component", component}}, as_number(count));
    }
  }
}

void add_status(Page& page, const std::vector<ComponentStatus>& all) {
  page.family("component_info", "gauge", "Type and core of a component; always 1.");
  for (const auto& one : all) {
    page.sample({{"component", one.name}, {"type", one.type}, {"core", one.core}}, 1);
  }
  page.family("component_running", "gauge", "1 while it runs, 0 when it is stopped or faulted.");
  for (const auto& one : all) {
    page.sample({{"component", one.name}}, one.state == ComponentState::running ? 1 : 0);
  }
  struct Counter {
    const char* name;
    const char* help;
    std::uint64_t ComponentStatus::*value;
  };
  constexpr std::array<Counter, 6> kCounters{
      {{"releases_total", "Jobs that ran.", &ComponentStatus::releases},
       {"missed_releases_total", "Releases that never ran.", &ComponentStatus::missed},
       {"overruns_total", "Jobs that ended after their wait or deadline.",
        &ComponentStatus::overruns},
       {"faults_total", "Jobs that threw, crashed or hung.", &ComponentStatus::faults},
       {"over_budget_total", "Jobs that used more processor time than the declared budget.",
        &ComponentStatus::over_budget},
       {"implausible_values_total", "Values that a port did not let out.",
        &ComponentStatus::implausible}}};
  for (const auto& counter : kCounters) {
    page.family(counter.name, "counter", counter.help);
    for (const auto& one : all) {
      page.sample({{"component", one.name}}, as_number(one.*counter.value));
    }
  }
}

void add_times(Page& page, const std::vector<ComponentStatistics>& all) {
  page.family("start_lateness_seconds", "histogram", "From a release to the start of its job.");
  for (const auto& one : all) {
    page.histogram({{"component", one.name}}, one.lateness);
  }
  page.family("execution_seconds", "histogram",
              "Time of a job, apart by whether something came between.");
  for (const auto& one : all) {
    page.histogram({{"component", one.name}, {"preempted", "false"}}, one.execution);
    page.histogram({{"component", one.name}, {"preempted", "true"}}, one.preempted);
  }
  page.family("response_seconds", "histogram", "From a release to the end of its job.");
  for (const auto& one : all) {
    page.histogram({{"component", one.name}}, one.response);
  }
  page.family("budget_seconds", "gauge", "Declared time of a job.");
  for (const auto& one : all) {
    if (one.budget > Duration{0}) {
      page.sample({{"component", one.name}}, in_seconds(one.budget));
    }
  }
}

void add_locks(Page& page, const std::vector<ComponentStatistics>& all) {
  page.family("lock_waits_total", "counter", "Waits for resources that others held.");
  for (const auto& one : all) {
    page.sample({{"component", one.name}}, as_number(one.lock_waits.count));
  }
  page.family("lock_wait_seconds_total", "counter", "Time of these waits.");
  for (const auto& one : all) {
    page.sample({{"component", one.name}}, in_seconds(one.lock_waits.sum));
  }
}

void add_states(Page& page, const std::vector<ComponentStatistics>& all) {
  page.family("state_runs_total", "counter", "How often an execution state ran.");
  for (const auto& one : all) {
    for (const auto& state : one.states) {
      page.sample({{"component", one.name}, {"state", state.name}},
                  as_number(state.execution.count + state.preempted.count));
    }
  }
  page.family("state_execution_seconds_total", "counter",
              "Time of an execution state, with what came between.");
  for (const auto& one : all) {
    for (const auto& state : one.states) {
      page.sample({{"component", one.name}, {"state", state.name}},
                  in_seconds(state.execution.sum + state.preempted.sum));
    }
  }
}

}  // namespace

Result<Json> metrics(Running& running, const Call& /*call*/) {
  const auto statistics = running.deployer.statistics();
  Page page;
  add_system(page, running);
  add_commands(page, running.counts);
  const auto status = running.deployer.status();
  add_status(page, status);
  add_outcomes(page, running.counts, status);
  add_times(page, statistics);
  add_locks(page, statistics);
  add_states(page, statistics);
  return Json{{"format", "prometheus 0.0.4"}, {"text", page.take()}};
}

}  // namespace mauve::daemon
