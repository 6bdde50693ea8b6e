// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/admission/timing_model.h"

#include <algorithm>

#include "analysis/machine.h"
#include "base/duration.h"
#include "exec/admission/placement.h"

#include <mauve/fsm.h>

namespace mauve::exec {
namespace {

analysis::Machine machine_of(const FsmBase& fsm) {
  analysis::Machine machine;
  for (const FsmState* state : fsm.states()) {
    std::vector<std::size_t> next;
    for (const FsmState::Transition& transition : state->transitions()) {
      next.push_back(transition.target->index());
    }
    if (state->successor() != nullptr) next.push_back(state->successor()->index());
    const std::string name(state->name());
    machine.states.push_back(
        state->kind() == FsmState::Kind::synchronization
            ? analysis::waiting(name, state->duration(), std::move(next))
            : analysis::running(name, Duration{0}, analysis::Source::unknown, std::move(next)));
  }
  machine.initial = fsm.initial() == nullptr ? machine.states.size() : fsm.initial()->index();
  return machine;
}

/// The longest measured time is not the worst possible one.
Duration with_margin(Duration measured) { return measured + measured / 5; }

/// Counted for every kind of job of the component: the runtime does not distinguish them.
void count_measured(analysis::Graph& graph, Duration longest) {
  for (analysis::Vertex& job : graph.vertices) {
    job.execution = with_margin(longest);
    job.source = analysis::Source::measured;
  }
}

}  // namespace

void TimingModel::add(const TimedComponent& component) {
  const TaskAttributes& attributes = component.bundle->task;
  auto graph =
      analysis::to_graph(machine_of(*component.fsm), {attributes.deadline, attributes.budget});
  if (!graph) {
    notes_.push_back(component.name + " is not counted: " + graph.error().message);
    return;
  }
  if (attributes.budget == Duration{0} && component.measured > Duration{0}) {
    count_measured(*graph, component.measured);
  }
  analysis::Task task;
  task.name = component.name;
  if (component.cpus.size() == 1) task.cpu = component.cpus.front();
  task.priority = attributes.priority;
  task.offset = attributes.offset;
  task.graph = *std::move(graph);
  task.sections = sections_of(component);
  task.version = component.version;
  set_.tasks.push_back(std::move(task));
}

/// No section is longer than the whole job, whose time counts while no other time is known.
std::vector<analysis::Section> TimingModel::sections_of(const TimedComponent& component) {
  const Duration declared = component.bundle->task.budget;
  const Duration job = declared > Duration{0} ? declared : with_margin(component.measured);
  std::vector<analysis::Section> sections;
  for (ResourceBase* resource : locks_of(*component.bundle->bindings)) {
    const LockTiming& lock = lock_of(*resource);
    sections.push_back({resource->name(), std::min(lock.lock_budget.value_or(job), job),
                        lock.lock_budget ? analysis::Source::declared : analysis::Source::unknown});
  }
  return sections;
}

/// The lock is read once, since callers may hold it while the model is computed.
const LockTiming& TimingModel::lock_of(const ResourceBase& resource) {
  const auto [found, is_new] = locks_.try_emplace(resource.name());
  LockTiming& lock = found->second;
  if (!is_new) return lock;
  lock.resource = resource.name();
  const auto changed = holds_.find(&resource);
  const Duration declared = changed != holds_.end() ? changed->second : resource.lock().budget();
  const Duration longest = resource.lock().longest_held();
  if (declared > Duration{0}) {
    lock.lock_budget = declared;
    lock.source = analysis::to_string(analysis::Source::declared);
  } else if (longest > Duration{0}) {
    lock.lock_budget = with_margin(longest);
    lock.source = analysis::to_string(analysis::Source::measured);
  } else {
    lock.source = analysis::to_string(analysis::Source::unknown);
  }
  if (declared > Duration{0} && longest > declared) {
    contradictions_.push_back(
        lock.resource + " was held for " +
        format_duration(std::chrono::ceil<std::chrono::microseconds>(longest)) +
        ", its lock budget is " + format_duration(declared));
  }
  return lock;
}

bool is_timed_alike(const Bundle& a, const Bundle& b) {
  const bool same_states = std::equal(
      a.fsm->states().begin(), a.fsm->states().end(), b.fsm->states().begin(),
      b.fsm->states().end(), [](const FsmState* x, const FsmState* y) {
        return x->name() == y->name() && x->kind() == y->kind() && x->duration() == y->duration();
      });
  return same_states && a.measured == b.measured && a.task.budget == b.task.budget &&
         a.task.deadline == b.task.deadline && a.task.offset == b.task.offset &&
         locks_of(*a.bindings) == locks_of(*b.bindings);
}

std::vector<LockTiming> TimingModel::locks() const {
  std::vector<LockTiming> locks;
  for (const auto& [name, lock] : locks_) locks.push_back(lock);
  return locks;
}

bool TimingModel::measures() const {
  const auto measured_job = [](const analysis::Vertex& job) {
    return job.source == analysis::Source::measured;
  };
  const auto measured_task = [&](const analysis::Task& task) {
    return std::any_of(task.graph.vertices.begin(), task.graph.vertices.end(), measured_job);
  };
  const auto measured_lock = [](const auto& lock) {
    return lock.second.source == analysis::to_string(analysis::Source::measured);
  };
  return std::any_of(set_.tasks.begin(), set_.tasks.end(), measured_task) ||
         std::any_of(locks_.begin(), locks_.end(), measured_lock);
}

std::vector<std::string> TimingModel::notes() const {
  std::vector<std::string> notes = notes_;
  std::string names;
  for (const auto& [name, lock] : locks_) {
    if (!lock.lock_budget) names += (names.empty() ? "" : ", ") + name;
  }
  if (!names.empty()) {
    notes.push_back(
        "how long a job holds a resource is neither declared (\"lock_budget\") nor measured yet, "
        "so it "
        "counts as long as the whole job: " +
        names);
  }
  return notes;
}

}  // namespace mauve::exec
