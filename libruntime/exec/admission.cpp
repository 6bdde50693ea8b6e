// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/admission.h"

#include <algorithm>

#include "analysis/admission.h"
#include "exec/timing_model.h"

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
TimedComponent timed(const Deployed& deployed, const PreparedMember& member) {
  TimedComponent after = timed(deployed);
  after.bundle = member.next.get();
  if (!member.next->task.cpus.empty()) after.cpus = member.next->task.cpus;
  if (member.next->core_type.name != member.base->core_type.name) after.measured = Duration{0};
  // In place the new machine is configured later: until then the old one tells.
  if (member.next->fsm->initial() != nullptr) after.fsm = member.next->fsm.get();
  after.version = member.next->core != member.base->core ? 1 : 0;
  return after;
}

bool runs(const System& system, const Deployed& deployed) {
  if (!system.up) return deployed.component->bundle()->task.start;
  return !deployed.hidden && deployed.state() == ComponentState::running;
}

TimingModel model_of(System& system) {
  TimingModel model;
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

TimingModel model_after(System& system, const PreparedChange::Content& change) {
  TimingModel model;
  const std::lock_guard lock(system.members);
  for (const Deployed& deployed : system.deployed) {
    const bool ran = runs(system, deployed);
    const PreparedMember* member = find(change, deployed.component);
    if (member == nullptr) {
      if (ran) model.add(timed(deployed));
    } else if (runs_after(*member, ran)) {
      model.add(timed(deployed, *member));
    }
  }
  std::vector<int> chosen;
  for (const PreparedMember& member : change.members) {
    if (member.part != Part::joins) continue;
    std::vector<int> cpus = member.next->task.cpus;
    if (cpus.empty()) {
      chosen.push_back(least_used_cpu(system, chosen));
      cpus = {chosen.back()};
    }
    if (!runs_after(member, false)) continue;
    model.add({member.component->name(), member.next.get(), member.next->fsm.get(), cpus});
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
    if (task.cpu && job->response != analysis::kUnbounded) {
      row.response = job->response;
      row.slack = job->slack();
    }
  }
  for (const Problem& problem : problems) {
    if (!row.problem.empty() || problem.error.at != task.name) continue;
    row.problem =
        problem.error.message + (problem.error.hint.empty() ? "" : " (" + problem.error.hint + ")");
  }
  return row;
}

Timing timing_of(const TimingModel& model) {
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
  timing.problems = sentences(problems);
  timing.notes = model.notes();
  return timing;
}

}  // namespace

Status admit_deployment(System& system) {
  if (system.options.admission == Admission::off) return ok();
  const auto problems = analysis::problems(analysis::analyze(model_of(system).set()));
  if (problems.empty()) return ok();
  if (system.options.admission == Admission::strict) return problems.front().error;
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
  auto problems = analysis::problems(analysis::admit(before.set(), after.set()));
  if (problems.empty()) return std::vector<std::string>{};
  if (system.options.admission == Admission::strict) return problems.front().error;
  // Of what was so before, and is no member, it was said before.
  const auto known = analysis::problems(analysis::analyze(before.set()));
  std::erase_if(problems, [&](const Problem& problem) {
    const auto is_same = [&](const Problem& other) {
      return other.kind == problem.kind && other.error.at == problem.error.at;
    };
    const auto is_member = [&](const PreparedMember& member) {
      return member.component->name() == problem.error.at && member.part != Part::leaves;
    };
    return std::any_of(known.begin(), known.end(), is_same) &&
           std::none_of(change.members.begin(), change.members.end(), is_member);
  });
  return warnings_of(problems);
}

Timing analyze(System& system) { return timing_of(model_of(system)); }

Timing analyze(Architecture& architecture) {
  System system(architecture, {.realtime = Realtime::off, .simulated = true});
  for (ComponentBase* component : architecture.components()) {
    static_cast<void>(component->fsm().configure());
    Deployed deployed;
    deployed.component = component;
    deployed.cpus = component->bundle()->task.cpus;
    deployed.task = std::make_shared<Task>(component->name(), system.runner->clock());
    system.deployed.push_back(std::move(deployed));
  }
  for (Deployed& deployed : system.deployed) place(system, deployed);
  Timing timing = timing_of(model_of(system));
  for (ComponentBase* component : architecture.components()) {
    static_cast<void>(component->fsm().cleanup());
  }
  return timing;
}

}  // namespace mauve::exec
