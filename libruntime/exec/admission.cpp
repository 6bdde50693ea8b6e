// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/admission.h"

#include <algorithm>
#include <optional>
#include <set>

#include "analysis/admission.h"
#include "base/duration.h"
#include "exec/placement.h"
#include "exec/relaxation.h"
#include "exec/timing_model.h"
#include "rt/machine_costs.h"

namespace mauve::exec {
namespace {

using analysis::Problem;

/// Where it is not known what a job used, as long as it took.
Duration measured(const Deployed& deployed) {
  const Counters& counters = deployed.task->counters();
  const std::int64_t used = counters.used_max.load(std::memory_order_relaxed);
  return Duration{used > 0 ? used : counters.execution_max.load(std::memory_order_relaxed)};
}

TimedComponent timed(const Deployed& deployed) {
  const Bundle& bundle = *deployed.component->bundle();
  const auto& cpus = bundle.task.cpus.empty() ? deployed.cpus : bundle.task.cpus;
  return {deployed.component->name(), &bundle, bundle.fsm.get(), cpus, measured(deployed), 0};
}

/// As it is after the change.
TimedComponent timed_after(const Deployed& deployed, const Bundle& base, const Bundle& next) {
  TimedComponent after = timed(deployed);
  after.bundle = &next;
  if (!next.task.cpus.empty()) after.cpus = next.task.cpus;
  if (is_other_code(*base.core, *next.core)) after.measured = Duration{0};
  // In place the new machine is configured later: until then the old one tells.
  if (next.fsm->initial() != nullptr) after.fsm = next.fsm.get();
  after.version = next.core != base.core ? 1 : 0;
  return after;
}

bool runs(const System& system, const Deployed& deployed) {
  if (!system.up) return deployed.component->bundle()->task.start;
  return !deployed.hidden && deployed.state() == ComponentState::running;
}

TimingModel model_of(System& system) {
  TimingModel model(system.overheads);
  const std::lock_guard lock(system.members);
  for (const Deployed& deployed : system.deployed) {
    if (runs(system, deployed)) model.add(timed(deployed));
  }
  return model;
}

const PreparedMember* find(const PreparedChange::Content& change, const ComponentBase* component) {
  for (const PreparedMember& member : change.members) {
    if (member.component == component) return &member;
  }
  return nullptr;
}

bool runs_after(const PreparedMember& member, bool ran) {
  if (member.part == Part::leaves) return false;
  return member.mode == Mode::run || (ran && member.mode == Mode::keep);
}

Holds holds_after(const PreparedChange::Content& change) {
  Holds holds;
  for (const PreparedResource& resource : change.resources) {
    if (resource.hold) holds.emplace(resource.resource, *resource.hold);
  }
  return holds;
}

/// `relief`, when there is one, runs in place of what the change brings its component.
TimingModel model_after(System& system, const PreparedChange::Content& change,
                        const PreparedMember* relief = nullptr) {
  const auto next_of = [&](const PreparedMember& member) -> const Bundle& {
    const bool relieved = relief != nullptr && relief->component == member.component;
    return relieved ? *relief->next : *member.next;
  };
  TimingModel model(system.overheads, holds_after(change));
  const std::lock_guard lock(system.members);
  for (const Deployed& deployed : system.deployed) {
    const bool ran = runs(system, deployed);
    const PreparedMember* member = find(change, deployed.component);
    if (member == nullptr) {
      if (ran) model.add(timed(deployed));
    } else if (runs_after(*member, ran)) {
      model.add(timed_after(deployed, *member->base, next_of(*member)));
    }
  }
  Placement placement(system);
  for (const PreparedMember& member : change.members) {
    if (member.part != Part::joins) continue;
    const std::string& name = member.component->name();
    const Bundle& next = next_of(member);
    const Placement::Seat seat = placement.seat(name, next);
    if (!runs_after(member, false)) continue;
    model.add({name, &next, next.fsm.get(), seat.cpus});
  }
  return model;
}

std::string sentence(const Error& error) {
  return error.at + ": " + error.message + (error.hint.empty() ? "" : " (" + error.hint + ")");
}

std::vector<std::string> sentences(const std::vector<Problem>& problems) {
  std::vector<std::string> all;
  for (const Problem& problem : problems) all.push_back(sentence(problem.error));
  return all;
}

/// The same of the same, whatever its figures.
bool has(const std::vector<Problem>& problems, const Problem& problem) {
  return std::any_of(problems.begin(), problems.end(), [&](const Problem& other) {
    return other.kind == problem.kind && other.error.at == problem.error.at;
  });
}

/// What nobody declared is said once, in one line.
std::vector<std::string> warnings_of(const std::vector<Problem>& problems) {
  std::vector<Problem> others;
  std::string unknown;
  for (const Problem& problem : problems) {
    if (problem.kind != Problem::Kind::unknown) {
      others.push_back(problem);
    } else {
      unknown += (unknown.empty() ? "" : ", ") + problem.error.at;
    }
  }
  std::vector<std::string> warnings = sentences(others);
  if (!unknown.empty()) {
    warnings.push_back(unknown +
                       ": execution times are not known and not counted (declare a "
                       "budget)");
  }
  return warnings;
}

/// Of the job with the least slack, where it can be said.
std::optional<Duration> response_of(const analysis::TaskReport& task) {
  const analysis::JobReport* job = task.tightest();
  const bool known = job != nullptr && task.cpu && task.source != analysis::Source::unknown;
  if (!known || job->response == analysis::kUnbounded) return std::nullopt;
  return job->response;
}

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

std::vector<Problem> problems_of(const analysis::TaskSet& set) {
  return analysis::problems(analysis::analyze(set));
}

/// What was so before is not the doing of a change, not even while it leads away from it.
std::vector<Problem> problems_brought(const analysis::TaskSet& before,
                                      const analysis::TaskSet& after) {
  const auto known = problems_of(before);
  auto found = analysis::problems(analysis::admit(before, after));
  std::erase_if(found, [&](const Problem& problem) { return has(known, problem); });
  return found;
}

/// By Admission::strict.
bool admits(const analysis::TaskSet& before, const analysis::TaskSet& after) {
  return problems_of(after).empty() && problems_brought(before, after).empty();
}

/// Whose jobs are others after the change.
std::vector<std::string> changed_tasks(const PreparedChange::Content& change) {
  std::vector<std::string> names;
  for (const PreparedMember& member : change.members) {
    if (member.part != Part::leaves && member.mode != Mode::park) {
      names.push_back(member.component->name());
    }
  }
  return names;
}

/// What the machine takes, in words.
std::string overheads_of(const System& system) {
  const analysis::Overheads& costs = system.overheads;
  return "the machine takes " + format_duration(costs.wake) + " to wake a thread up, " +
         format_duration(costs.activation) + " to switch to it and back, " +
         format_duration(costs.interrupt) + " for a timer, " + format_duration(costs.tick) +
         " of each " + format_duration(costs.tick_period) +
         (system.overheads_measured ? " (measured when it was deployed)" : " (assumed)");
}

Timing timing_of(const System& system, const TimingModel& model) {
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
  timing.notes = model.notes();
  timing.notes.push_back(overheads_of(system));
  return timing;
}

}  // namespace

void measure_overheads(System& system, int priority) {
  if (!system.realtime || system.options.admission == Admission::off) return;
  std::set<int> cpus;
  for (const Deployed& deployed : system.deployed) {
    cpus.insert(deployed.cpus.begin(), deployed.cpus.end());
  }
  const auto costs = rt::measure_machine({cpus.begin(), cpus.end()}, priority);
  if (!costs) return;
  system.overheads.wake = costs->wake;
  system.overheads.activation = costs->activation;
  system.overheads.interrupt = costs->interrupt;
  system.overheads.tick = costs->kernel;
  system.overheads.tick_period = rt::MachineCosts::window;
  system.overheads_measured = true;
}

Status admit_deployment(System& system) {
  if (system.options.admission == Admission::off) return ok();
  const TimingModel model = model_of(system);
  const auto problems = problems_of(model.set());
  if (problems.empty()) return ok();
  if (system.options.admission == Admission::strict) {
    std::vector<std::string> tasks;
    if (problems.front().kind == Problem::Kind::late) tasks.push_back(problems.front().error.at);
    return refusal_of(problems.front(), model.set(), tasks,
                      [](const analysis::TaskSet& set) { return problems_of(set).empty(); });
  }
  for (const std::string& warning : warnings_of(problems)) {
    system.warnings.push_back("admission: " + warning);
  }
  return ok();
}

Result<std::vector<std::string>> admit_change(System& system,
                                              const PreparedChange::Content& change) {
  if (system.options.admission == Admission::off) return std::vector<std::string>{};
  const TimingModel before = model_of(system);
  const TimingModel after = model_after(system, change);
  const auto lasting = problems_of(after.set());
  auto problems = problems_brought(before.set(), after.set());
  if (system.options.admission == Admission::strict) {
    if (problems.empty()) problems = lasting;
    if (problems.empty()) return std::vector<std::string>{};
    return refusal_of(problems.front(), after.set(), changed_tasks(change),
                      [&](const analysis::TaskSet& set) { return admits(before.set(), set); });
  }
  // Of members it is said again what stays so.
  for (const Problem& problem : lasting) {
    const bool of_member = std::any_of(
        change.members.begin(), change.members.end(),
        [&](const PreparedMember& member) { return member.component->name() == problem.error.at; });
    if (of_member && !has(problems, problem)) problems.push_back(problem);
  }
  return warnings_of(problems);
}

bool admit_relief(System& system, const PreparedChange::Content& change,
                  const PreparedMember& relief) {
  if (system.options.admission != Admission::strict) return true;
  return admits(model_of(system).set(), model_after(system, change, &relief).set());
}

std::map<std::string, Duration> responses(System& system) {
  const TimingModel model = model_of(system);
  std::map<std::string, Duration> known;
  for (const analysis::TaskReport& task : analysis::analyze(model.set()).tasks) {
    if (const auto response = response_of(task)) known.emplace(task.name, *response);
  }
  return known;
}

Timing analyze(System& system) { return timing_of(system, model_of(system)); }

Timing analyze(Architecture& architecture) {
  System system(architecture, {.realtime = Realtime::off, .simulated = true});
  for (ComponentBase* component : architecture.components()) {
    static_cast<void>(component->fsm().configure());
    Deployed deployed;
    deployed.component = component;
    deployed.cpus = component->bundle()->task.cpus;
    deployed.task = new_task(system, *component);
    system.deployed.push_back(std::move(deployed));
  }
  for (Deployed& deployed : system.deployed) place(system, deployed);
  Timing timing = timing_of(system, model_of(system));
  for (ComponentBase* component : architecture.components()) {
    static_cast<void>(component->fsm().cleanup());
  }
  return timing;
}

}  // namespace mauve::exec
