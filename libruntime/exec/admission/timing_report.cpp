// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/admission/timing_report.h"

#include "base/thread_role.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "base/duration.h"

namespace mauve::exec {
namespace {

using analysis::Problem;

ComponentTiming row_of(const analysis::TaskReport& task, const std::vector<Problem>& problems) {
  ComponentTiming row;
  row.name = task.name;
  row.cpu = task.cpu;
  row.priority = task.priority;
  row.source = analysis::to_string(task.source);
  row.blocking = task.blocking;
  if (const analysis::JobReport* job = task.tightest()) {
    row.execution = job->job.execution;
    row.deadline = job->deadline;
    row.response = response_of(task);
    if (row.response) row.slack = job->slack();
  }
  for (const Problem& problem : problems) {
    if (!row.problem.empty() || problem.error.at != task.name) continue;
    row.problem =
        problem.error.message + (problem.error.hint.empty() ? "" : " (" + problem.error.hint + ")");
  }
  return row;
}

std::string per_cent(double share) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g %%", 100 * share);
  return text.data();
}

/// In microseconds, or longer units where that suffices.
std::string in_words(Duration duration) {
  return format_duration(std::chrono::ceil<std::chrono::microseconds>(duration));
}

/// "measured on CPU 0 in the last 90 s: ..."
std::string noise_of(const WakeNoise& noise, const MachineCosts& machine) {
  const auto whole = [](Duration time) {
    return format_duration(std::chrono::round<std::chrono::seconds>(time));
  };
  const double beyond = static_cast<double>(noise.beyond) /
                        static_cast<double>(std::max<std::uint64_t>(1, noise.late.count));
  return "measured on CPU " + std::to_string(noise.cpu) + " in the last " + whole(noise.span) +
         ": threads woke up within " + in_words(noise.late.percentile(50)) + " (50 %), " +
         in_words(noise.late.percentile(99)) + " (99 %), " + in_words(noise.late.percentile(99.9)) +
         " (99.9 %); " + per_cent(beyond) + " of " + std::to_string(noise.late.count) +
         " later than the assumed " + format_duration(machine.wake) + "; worst since the start " +
         in_words(noise.worst) + ", " + whole(noise.worst_ago) + " ago";
}

/// The measurements of one component that contradict the proof.
void contradict(const Deployed& deployed, std::vector<std::string>& found) {
  const std::string& name = deployed.component->name();
  const Bundle& bundle = *deployed.component->bundle();
  const rt::JobTimes& times = bundle.measured->shown();
  const Counters& counters = deployed.task->counters();
  const Duration budget = bundle.task.budget;
  const Duration used{counters.used_max.load(std::memory_order_relaxed)};
  const std::uint64_t longer = times.over_budget.load(std::memory_order_relaxed);
  const std::string declared = "its budget is " + format_duration(budget) + " (" +
                               std::to_string(longer) + (longer == 1 ? " job" : " jobs") +
                               " over it); the proof below assumes " + format_duration(budget);
  if (budget > Duration{0} && used > budget) {
    found.push_back(name + " used up to " + in_words(used) + " of processor time, " + declared);
  }
  if (const std::uint64_t missed = times.missed.load(std::memory_order_relaxed); missed > 0) {
    found.push_back(name + " missed " + std::to_string(missed) +
                    (missed == 1 ? " release" : " releases"));
  }
}

}  // namespace

std::string sentence(const Error& error) {
  return error.at + ": " + error.message + (error.hint.empty() ? "" : " (" + error.hint + ")");
}

std::vector<std::string> sentences(const std::vector<Problem>& problems) {
  std::vector<std::string> all;
  for (const Problem& problem : problems) all.push_back(sentence(problem.error));
  return all;
}

std::optional<Duration> response_of(const analysis::TaskReport& task) {
  const analysis::JobReport* job = task.tightest();
  const bool known = job != nullptr && task.cpu && task.source != analysis::Source::unknown;
  if (!known || job->response == analysis::kUnbounded) return std::nullopt;
  return job->response;
}

std::string assumption_of(const MachineCosts& machine) {
  return "assumed of the machine: " + format_duration(machine.wake) + " to wake a thread up, " +
         format_duration(machine.activation) + " to switch to it and back, " +
         format_duration(machine.interrupt) + " for a timer, " + format_duration(machine.kernel) +
         " of each " + format_duration(MachineCosts::window) +
         " for kernel and host (mauved --machine declares other costs)";
}

Timing report_of(const System& system, const TimingModel& model) {
  MAUVE_ON_THREAD(control);
  const analysis::Report report = analysis::analyze(model.set());
  const std::vector<Problem> problems = analysis::problems(report);
  Timing timing;
  for (const analysis::TaskReport& task : report.tasks) {
    timing.components.push_back(row_of(task, problems));
  }
  for (const analysis::CpuReport& cpu : report.cpus) {
    timing.cpus.push_back({cpu.cpu, cpu.load, cpu.overloaded});
  }
  const bool known = std::none_of(problems.begin(), problems.end(), [](const Problem& problem) {
    return problem.kind == Problem::Kind::unknown || problem.kind == Problem::Kind::floating;
  });
  if (known && !report.tasks.empty()) timing.factor = analysis::largest_factor(model.set());
  timing.locks = model.locks();
  timing.problems = sentences(problems);
  timing.contradictions = model.contradictions();
  for (const Deployed& deployed : system.deployed) {
    if (!deployed.hidden) contradict(deployed, timing.contradictions);
  }
  timing.notes = model.notes();
  timing.machine = system.options.machine;
  timing.notes.push_back(assumption_of(timing.machine));
  if (const auto noise = system.runner->noise()) timing.noise = noise->look(system.runner->now());
  for (const WakeNoise& one : timing.noise) {
    timing.notes.push_back(noise_of(one, timing.machine));
  }
  if (system.realtime && timing.noise.empty()) {
    timing.notes.push_back(
        "no probe measures the machine: it needs SCHED_FIFO 99 (LimitRTPRIO=99); without it a core "
        "on probation is also blamed for time that a host takes");
  }
  return timing;
}

}  // namespace mauve::exec
