// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/admission.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <unordered_map>

#include "analysis/processor.h"
#include "analysis/transition.h"

namespace mauve::analysis {
namespace {

using Tasks = std::vector<const Task*>;

/// The tasks of each CPU: those pinned to it, and all tasks that float.
std::map<int, Tasks> by_cpu(const TaskSet& set) {
  std::map<int, Tasks> result;
  for (const Task& task : set.tasks) {
    if (task.cpu) result[*task.cpu].push_back(&task);
  }
  for (const Task& task : set.tasks) {
    if (task.cpu) continue;
    for (auto& [cpu, tasks] : result) tasks.push_back(&task);
  }
  return result;
}

bool change_both_ways(const Tasks& tasks) {
  const auto some = [&](Presence presence) {
    return std::any_of(tasks.begin(), tasks.end(),
                       [=](const Task* task) { return task->presence == presence; });
  };
  return some(Presence::before) && some(Presence::after);
}

/// Adds the findings about one CPU to the report; false when the CPU does not pass.
bool add(Processor processor, int cpu, Report& report) {
  CpuReport second = processor.second();
  second.cpu = cpu;
  std::vector<TaskReport> tasks = processor.tasks();
  const bool passes =
      !second.overloaded &&
      std::none_of(tasks.begin(), tasks.end(), [](const TaskReport& task) { return task.late(); });
  std::move(tasks.begin(), tasks.end(), std::back_inserter(report.tasks));
  report.cpus.push_back(second);
  return passes;
}

TaskReport floating(const Task& task) {
  TaskReport report;
  report.name = task.name;
  report.priority = task.priority;
  report.presence = task.presence;
  for (const Vertex& vertex : task.graph.vertices) {
    report.source = std::max(report.source, vertex.source);
  }
  return report;
}

std::vector<SharedReport> cross_cpu(const TaskSet& set) {
  std::unordered_map<std::string_view, Tasks> users;
  for (const Task& task : set.tasks) {
    for (const Section& section : task.sections) {
      Tasks& found = users[section.resource];
      if (found.empty() || found.back() != &task) found.push_back(&task);
    }
  }
  std::vector<SharedReport> result;
  for (const auto& [resource, tasks] : users) {
    const std::optional<int>& first = tasks.front()->cpu;
    const bool one_cpu = std::all_of(tasks.begin(), tasks.end(), [&](const Task* task) {
      return task->cpu.has_value() && task->cpu == first;
    });
    if (one_cpu || tasks.size() == 1) continue;
    SharedReport shared{std::string(resource), {}};
    for (const Task* task : tasks) shared.tasks.push_back(task->name);
    result.push_back(std::move(shared));
  }
  std::sort(result.begin(), result.end(),
            [](const SharedReport& a, const SharedReport& b) { return a.resource < b.resource; });
  return result;
}

/// The largest factor that one CPU bears, above `low`, which it does, and below `high`, which it
/// does not.
double bisected(const Tasks& tasks, const Overheads& overheads, double low, double high) {
  while (high - low > 0.01 * std::max(low, 0.01)) {
    const double middle = (low + high) / 2;
    (Processor(tasks, overheads, {middle}).passes() ? low : high) = middle;
  }
  return low;
}

}  // namespace

Report analyze(const TaskSet& set) {
  Report report;
  for (const auto& [cpu, tasks] : by_cpu(set)) {
    const std::size_t before = report.tasks.size();
    if (add(Processor(tasks, set.overheads, {}), cpu, report) || !change_both_ways(tasks)) continue;
    report.tasks.resize(before);
    report.cpus.pop_back();
    add(Processor(tasks, set.overheads, {1, true}), cpu, report);
  }
  for (const Task& task : set.tasks) {
    if (!task.cpu) report.tasks.push_back(floating(task));
  }
  report.cross_cpu = cross_cpu(set);
  return report;
}

Report admit(const TaskSet& before, const TaskSet& after) {
  return analyze(transition(before, after));
}

double largest_factor(const TaskSet& set) {
  double largest = kLargestFactor;
  for (const auto& [cpu, tasks] : by_cpu(set)) {
    const auto passes = [&, &tasks = tasks](double factor) {
      return Processor(tasks, set.overheads, {factor}).passes();
    };
    if (passes(largest)) continue;
    double low = std::min(largest, 1.0);
    double high = largest;
    if (passes(low)) {
      while (low * 2 < largest && passes(low * 2)) low *= 2;
      high = std::min(high, low * 2);
    } else {
      high = low;
      low = 0;
    }
    largest = bisected(tasks, set.overheads, low, high);
  }
  return largest;
}

}  // namespace mauve::analysis
