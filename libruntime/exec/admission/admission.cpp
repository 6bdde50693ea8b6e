// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/admission/admission.h"

#include "base/thread_role.h"

#include <algorithm>

#include "analysis/admission.h"
#include "base/duration.h"
#include "base/mutex.h"
#include "exec/admission/placement.h"
#include "exec/admission/relaxation.h"
#include "exec/admission/timing_model.h"
#include "exec/admission/timing_report.h"
#include "exec/system/prepared.h"

#include <mauve/host/architecture.h>

namespace mauve::exec {
namespace {

using analysis::Problem;

analysis::Overheads overheads_of(const MachineCosts& machine) {
  analysis::Overheads overheads;
  overheads.wake = machine.wake;
  overheads.activation = machine.activation;
  overheads.interrupt = machine.interrupt;
  overheads.tick = machine.kernel;
  overheads.tick_period = MachineCosts::window;
  return overheads;
}

/// The longest processor time of a job, or its longest duration where that is not known.
Duration measured(const Deployed& deployed) {
  const Counters& counters = deployed.task->counters();
  const std::int64_t used = counters.used_max.load(std::memory_order_relaxed);
  return Duration{used > 0 ? used : counters.elapsed_max.load(std::memory_order_relaxed)};
}

TimedComponent timed(const Deployed& deployed) {
  const Bundle& bundle = *deployed.component->bundle();
  const auto& cpus = bundle.task.cpus.empty() ? deployed.cpus : bundle.task.cpus;
  return {deployed.component->name(), &bundle, bundle.fsm.get(), cpus, measured(deployed), 0};
}

/// The component as it is after the change.
TimedComponent timed_after(const Deployed& deployed, const Bundle& base, const Bundle& next) {
  TimedComponent after = timed(deployed);
  after.bundle = &next;
  if (!next.task.cpus.empty()) after.cpus = next.task.cpus;
  if (is_other_code(*base.core, *next.core)) after.measured = Duration{0};
  // In place the new machine is configured later: until then the old one counts.
  if (next.fsm->initial() != nullptr) after.fsm = next.fsm.get();
  after.version = next.core != base.core ? 1 : 0;
  return after;
}

bool runs(const System& system, const Deployed& deployed) {
  if (!system.up) return deployed.component->bundle()->task.start;
  return !deployed.hidden && deployed.state() == ComponentState::running;
}

TimingModel model_of(System& system) {
  TimingModel model(overheads_of(system.options.machine));
  const MutexLock lock(system.members);
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
    if (resource.lock_budget) holds.emplace(resource.resource, *resource.lock_budget);
  }
  return holds;
}

/// `standby`, when there is one, runs in place of the bundle that the change brings its component.
TimingModel model_after(System& system, const PreparedChange::Content& change,
                        const PreparedMember* standby = nullptr) {
  const auto next_of = [&](const PreparedMember& member) -> const Bundle& {
    const bool relieved = standby != nullptr && standby->component == member.component;
    return relieved ? *standby->next : *member.next;
  };
  TimingModel model(overheads_of(system.options.machine), holds_after(change));
  const MutexLock lock(system.members);
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

/// The same kind of problem at the same address, with any figures.
bool has(const std::vector<Problem>& problems, const Problem& problem) {
  return std::any_of(problems.begin(), problems.end(), [&](const Problem& other) {
    return other.kind == problem.kind && other.error.at == problem.error.at;
  });
}

/// One line names all jobs without a declared execution time.
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

std::vector<Problem> problems_of(const analysis::TaskSet& set) {
  return analysis::problems(analysis::analyze(set));
}

/// A change is not to blame for a problem that existed before it, not even while it removes that
/// problem.
std::vector<Problem> problems_brought(const analysis::TaskSet& before,
                                      const analysis::TaskSet& after) {
  const auto known = problems_of(before);
  auto found = analysis::problems(analysis::admit(before, after));
  std::erase_if(found, [&](const Problem& problem) { return has(known, problem); });
  return found;
}

/// Would Admission::strict admit this change?
bool admits(const analysis::TaskSet& before, const analysis::TaskSet& after) {
  return problems_of(after).empty() && problems_brought(before, after).empty();
}

/// The names of the tasks that have other jobs after the change.
std::vector<std::string> changed_tasks(const PreparedChange::Content& change) {
  std::vector<std::string> names;
  for (const PreparedMember& member : change.members) {
    if (member.part != Part::leaves && member.mode != Mode::park) {
      names.push_back(member.component->name());
    }
  }
  return names;
}

/// A refusal names the assumed machine when the same would pass on a machine that takes no time.
Error with_assumption(Error error, const System& system, analysis::TaskSet set,
                      const analysis::Passes& passes) {
  set.overheads = analysis::no_overheads();
  if (passes(set)) {
    error.hint += (error.hint.empty() ? "" : "; ") + assumption_of(system.options.machine);
  }
  return error;
}

}  // namespace

Status admit_deployment(System& system) {
  MAUVE_ON_THREAD(control);
  if (system.options.admission == Admission::off) return ok();
  const TimingModel model = model_of(system);
  const auto problems = problems_of(model.set());
  if (problems.empty()) return ok();
  if (system.options.admission == Admission::strict) {
    std::vector<std::string> tasks;
    if (problems.front().kind == Problem::Kind::late) tasks.push_back(problems.front().error.at);
    const auto passes = [](const analysis::TaskSet& set) { return problems_of(set).empty(); };
    return with_assumption(refusal_of(problems.front(), model.set(), tasks, passes), system,
                           model.set(), passes);
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
    const auto passes = [&](const analysis::TaskSet& set) { return admits(before.set(), set); };
    return with_assumption(refusal_of(problems.front(), after.set(), changed_tasks(change), passes),
                           system, after.set(), passes);
  }
  // A problem that lasts is reported again when it concerns a member.
  for (const Problem& problem : lasting) {
    const bool of_member = std::any_of(
        change.members.begin(), change.members.end(),
        [&](const PreparedMember& member) { return member.component->name() == problem.error.at; });
    if (of_member && !has(problems, problem)) problems.push_back(problem);
  }
  return warnings_of(problems);
}

bool admit_standby(System& system, const PreparedChange::Content& change,
                   const PreparedMember& standby) {
  if (system.options.admission != Admission::strict) return true;
  return admits(model_of(system).set(), model_after(system, change, &standby).set());
}

Responses responses(System& system) {
  MAUVE_ON_THREAD(control);
  const TimingModel model = model_of(system);
  Responses known{{}, model.measures()};
  for (const analysis::TaskReport& task : analysis::analyze(model.set()).tasks) {
    if (const auto response = response_of(task)) known.bounds.emplace(task.name, *response);
  }
  return known;
}

Timing analyze(System& system) { return report_of(system, model_of(system)); }

Timing analyze(Architecture& architecture, const MachineCosts& machine) {
  System system(architecture, {.realtime = Realtime::off, .simulated = true, .machine = machine});
  for (ComponentBase* component : architecture.components()) {
    static_cast<void>(component->fsm().configure());
    Deployed deployed;
    deployed.component = component;
    deployed.cpus = component->bundle()->task.cpus;
    deployed.task = new_task(system, *component);
    system.deployed.push_back(std::move(deployed));
  }
  for (Deployed& deployed : system.deployed) place(system, deployed);
  Timing timing = report_of(system, model_of(system));
  for (ComponentBase* component : architecture.components()) {
    static_cast<void>(component->fsm().cleanup());
  }
  return timing;
}

}  // namespace mauve::exec
