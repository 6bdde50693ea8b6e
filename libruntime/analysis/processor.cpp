// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/processor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <unordered_map>

#include "analysis/blocking.h"

namespace mauve::analysis {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
/// Jobs looked at one by one; windows that hold more are bounded by a line.
constexpr double kMostJobs = 200'000;
constexpr double kLongestWindow = 3.6e12;  // an hour
constexpr double kSecond = 1e9;

std::int64_t rounded_up(double value) {
  return value < static_cast<double>(kNever) / 2 ? static_cast<std::int64_t>(std::ceil(value)) + 1
                                                 : kNever;
}

std::vector<Demand> demands_of(std::vector<const Task*> tasks, const Overheads& overheads,
                               double factor) {
  std::stable_sort(tasks.begin(), tasks.end(),
                   [](const Task* a, const Task* b) { return a->priority > b->priority; });
  std::vector<Demand> demands;
  demands.reserve(tasks.size());
  for (const Task* task : tasks) demands.emplace_back(*task, overheads, factor);
  return demands;
}

Duration as_duration(std::int64_t time) { return time == kNever ? kUnbounded : Duration(time); }

}  // namespace

Processor::Processor(std::vector<const Task*> tasks, const Overheads& overheads, Options options)
    : overheads_(overheads),
      options_(options),
      demands_(demands_of(std::move(tasks), overheads, options.factor)),
      kernel_(demands_, overheads) {
  find_blocking();
  unroll();
}

void Processor::find_blocking() {
  std::unordered_map<std::string_view, std::size_t> resources;
  std::vector<std::size_t> level;
  std::vector<Use> uses;
  for (std::size_t i = 0; i < demands_.size(); ++i) {
    const Task& task = *demands_[i].task;
    const bool same = i > 0 && task.priority == demands_[i - 1].task->priority;
    level.push_back(i == 0 ? 0 : level.back() + (same ? 0 : 1));
    for (const Section& section : task.sections) {
      const std::size_t resource =
          resources.try_emplace(section.resource, resources.size()).first->second;
      const double length = static_cast<double>(section.length.count()) * options_.factor;
      uses.push_back(
          {i, resource,
           static_cast<std::int64_t>(std::ceil(length)) + 2 * overheads_.activation.count()});
    }
  }
  if (uses.empty()) return;
  const std::vector<std::int64_t> times = blocking(level, uses);
  for (std::size_t i = 0; i < demands_.size(); ++i) demands_[i].blocking = times[i];
  for (const auto& [name, resource] : resources) name_guessed(name, level);
}

/// A resource delays each task that is not below all its users, and not among the lowest of them.
void Processor::name_guessed(std::string_view resource, const std::vector<std::size_t>& level) {
  constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();
  std::size_t highest = kNobody;
  std::size_t lowest = 0;  // of the users whose holding time is unknown
  for (std::size_t i = 0; i < demands_.size(); ++i) {
    for (const Section& section : demands_[i].task->sections) {
      if (section.resource != resource) continue;
      highest = std::min(highest, level[i]);
      if (section.source == Source::unknown) lowest = level[i];
    }
  }
  for (std::size_t i = 0; i < demands_.size(); ++i) {
    if (highest <= level[i] && level[i] < lowest) demands_[i].guessed.emplace_back(resource);
  }
}

Cover Processor::whole_line() const {
  Interference all({}, kernel_, 0, options_.in_turn);
  for (const Demand& demand : demands_) all.include(demand);
  return all.line();
}

void Processor::unroll() {
  std::int64_t longest = 0;
  std::int64_t delay_at_most = 0;
  double jobs = 0;
  for (const Demand& demand : demands_) {
    for (std::size_t i = 0; i < demand.costs.size(); ++i) {
      // As far as the next release, since a late job may need a later deadline.
      const bool last = demand.separations[i] == kNever;
      longest = std::max(longest, last ? demand.deadlines[i] : demand.separations[i]);
    }
    delay_at_most = std::max(delay_at_most, delay(demand));
    jobs += demand.jobs.rate;
  }
  const Cover line = whole_line();
  double busy = std::min(static_cast<double>(longest), kLongestWindow);
  if (line.rate < 1) {
    busy = std::min(busy, (line.burst + static_cast<double>(delay_at_most)) / (1 - line.rate));
  }
  if (jobs > 0) busy = std::min(busy, kMostJobs / jobs);
  horizon_ = rounded_up(busy);
  for (Demand& demand : demands_) demand.unroll(horizon_);
  kernel_.unroll(demands_, horizon_);
}

std::int64_t Processor::response(const Demand& demand, std::size_t vertex,
                                 const Interference& others) const {
  const std::int64_t fixed = delay(demand) + demand.costs[vertex];
  std::int64_t window =
      std::max<std::int64_t>(fixed, 1);  // a job without work waits for others too
  while (window <= horizon_) {
    const std::int64_t next = fixed + others.work_within(window);
    if (next <= window) return window + demand.task->jitter.count();
    window = next;
  }
  const Cover line = others.line();
  if (line.rate >= 1) return kNever;
  const double bound = (static_cast<double>(fixed) + line.burst) / (1 - line.rate);
  const std::int64_t end = rounded_up(bound);
  return end == kNever ? kNever : end + demand.task->jitter.count();
}

/// The best of all windows at whose ends more work comes, and of the deadline.
std::int64_t Processor::needed_execution(const Demand& demand, std::size_t vertex,
                                         const Interference& others) const {
  const std::int64_t deadline = demand.deadlines[vertex] - demand.task->jitter.count();
  std::int64_t most = 0;
  const auto look_at = [&](std::int64_t window) {
    if (window > 0 && window <= std::min(deadline, horizon_)) {
      most = std::max(most, window - others.work_within(window));
    }
  };
  for (const std::int64_t time : others.times()) look_at(time);
  look_at(deadline);
  return most - delay(demand) - overheads_.activation.count();
}

template <typename Visit>
bool Processor::each(Visit visit) {
  Interference others(demands_, kernel_, horizon_, options_.in_turn);
  for (std::size_t begin = 0; begin < demands_.size();) {
    std::size_t end = begin;
    while (end < demands_.size() &&
           demands_[end].task->priority == demands_[begin].task->priority) {
      others.include(demands_[end++]);
    }
    for (; begin < end; ++begin) {
      if (!demands_[begin].task->cpu) continue;
      others.look_from(demands_[begin]);
      if (!visit(demands_[begin], others)) return false;
    }
  }
  return true;
}

bool Processor::passes() {
  // The demand of the busiest second is at least the demand of the long run.
  if (whole_line().rate * kSecond > static_cast<double>(kSecondLimit.count())) return false;
  const bool in_time = each([this](const Demand& demand, const Interference& others) {
    for (std::size_t i = 0; i < demand.costs.size(); ++i) {
      if (response(demand, i, others) > demand.deadlines[i]) return false;
    }
    return true;
  });
  return in_time && !second().overloaded;
}

TaskReport Processor::report(const Demand& demand, const Interference& others) const {
  const Task& task = *demand.task;
  TaskReport report{task.name,        task.cpu,
                    task.priority,    task.presence,
                    Source::declared, Duration(demand.blocking),
                    demand.guessed,   {}};
  for (std::size_t i = 0; i < demand.costs.size(); ++i) {
    const Vertex& vertex = task.graph.vertices[i];
    report.source = std::max(report.source, vertex.source);
    if (vertex.part == Part::back) continue;  // as before
    JobReport job{vertex, as_duration(response(demand, i, others)), Duration(demand.deadlines[i]),
                  Duration(demand.separations[i]), Duration{0}};
    if (job.late()) job.needed_execution = Duration(needed_execution(demand, i, others));
    report.jobs.push_back(std::move(job));
  }
  return report;
}

std::vector<TaskReport> Processor::tasks() {
  std::vector<TaskReport> reports;
  reports.reserve(demands_.size());
  each([&](const Demand& demand, const Interference& others) {
    reports.push_back(report(demand, others));
    return true;
  });
  return reports;
}

CpuReport Processor::second() const {
  const Cover line = whole_line();
  std::int64_t busiest = rounded_up(line.value(kSecond));
  double jobs = 0;
  for (const Demand& demand : demands_) jobs += demand.jobs.rate * kSecond;
  // The line is too high by one job of each task. Where that decides, the work is computed exactly.
  const auto limit = kSecondLimit.count();
  if (busiest > limit && !options_.in_turn && jobs <= kMostJobs) {
    busiest = kernel_.work_within(std::int64_t{1'000'000'000});
    for (const Demand& demand : demands_) busiest += demand.work_within(1'000'000'000);
  }
  return {0, line.rate, Duration(busiest), busiest > limit};
}

}  // namespace mauve::analysis
