// SPDX-License-Identifier: LGPL-3.0-or-later
/// Traces of systems that obey the model, made by a small simulation of SCHED_FIFO: any number of
/// components on two processors, with changes, overruns and missed releases.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "mtrace/check.h"
#include "mtrace/trace.h"

namespace mauve::ctl::mtrace {

/// For messages of tests.
inline std::string first_violation(const Verdict& verdict) {
  return verdict.first ? verdict.first->rule + ": " + verdict.first->message : "none";
}

/// At the end of the trace.
inline Record& append_record(Trace& trace, std::int64_t time, std::string_view thread, Event event,
                             std::string_view name, std::int64_t a, std::int64_t b) {
  Record record;
  record.time = time;
  record.thread = trace.intern(thread);
  record.event = event;
  record.name = trace.intern(name);
  record.a = a;
  record.b = b;
  return trace.records.emplace_back(record);
}

class MadeTrace {
 public:
  explicit MadeTrace(unsigned seed) : random_(seed) {}

  /// `load`: how much of each processor its components want, in percent.
  Trace make(std::size_t components, std::int64_t length, std::size_t changes, int load) {
    length_ = length;
    trace_.header.architecture = "made";
    trace_.header.t0 = 1'000'000'000'000;
    trace_.header.to = length;
    trace_.reading.complete = true;
    for (std::size_t i = 0; i < components; ++i) add_component(i, components, load);
    for (std::size_t i = 1; i <= changes; ++i) add_change(i);
    for (std::int64_t cpu = 0; cpu < 2; ++cpu) run(cpu);
    std::stable_sort(trace_.records.begin(), trace_.records.end(),
                     [](const Record& x, const Record& y) { return x.time < y.time; });
    std::uint32_t line = 1;
    for (Record& record : trace_.records) record.line = ++line;
    return std::move(trace_);
  }

 private:
  static constexpr std::int64_t kWake = 6'000;
  static constexpr std::int64_t kUs = 1'000;

  struct Task {
    std::size_t component = 0;
    std::int64_t next = 0;  // release
    std::int64_t released = 0;
    std::int64_t wait = 0;                                   // that led to `next`
    std::vector<std::pair<std::size_t, std::int64_t>> left;  // states, and how long each runs
    bool in_job = false;
    bool in_state = false;
    bool preempted = false;
    std::int64_t change = 0;
    std::int64_t overruns = 0;
    std::int64_t missed = 0;
  };
  struct Change {
    std::int64_t number = 0;
    std::int64_t instant = 0;
    std::vector<std::size_t> members;
  };

  std::int64_t any(std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(random_);
  }
  const Component& component(const Task& task) const {
    return trace_.header.components[task.component];
  }
  void report(std::int64_t time, const std::string& thread, Event event,
              const std::string& name = {}, std::int64_t a = 0, std::int64_t b = 0) {
    append_record(trace_, time, thread, event, name, a, b);
  }

  /// Three execution states, and one or two waits of which one is a multiple of the grid.
  void add_component(std::size_t index, std::size_t of, int load) {
    constexpr std::int64_t kPeriods[] = {2'000, 5'000, 10'000, 20'000};
    Component made;
    made.name = "c" + std::to_string(index);
    made.priority = 80 - static_cast<std::int64_t>(index);
    made.cpus = {static_cast<std::int64_t>(index % 2)};
    made.realtime = true;
    made.scheduled = made.timed = -100 * kUs;
    made.period = kPeriods[any(0, 3)] * kUs;
    made.offset = any(0, 3) == 0 ? any(0, 50) * 100 * kUs : 0;
    for (const char* name : {"read", "think", "write"}) made.states.push_back({name, false, 0});
    made.states.push_back({"pace", true, made.period});
    if (any(0, 1) == 1) made.states.push_back({"rest", true, made.period * any(2, 4)});
    const auto share = static_cast<std::int64_t>((of + 1) / 2);
    cost_.push_back(made.period * load / 100 / share / 3);
    trace_.header.components.push_back(std::move(made));
  }

  void add_change(std::size_t number) {
    Change change;
    change.number = static_cast<std::int64_t>(number);
    const std::int64_t part = length_ / 12;
    change.instant = static_cast<std::int64_t>(number) * part + any(0, part / 2);
    for (std::size_t i = 0; i < trace_.header.components.size(); ++i) {
      if (i == 0 || any(0, 2) == 0) change.members.push_back(i);
    }
    const std::int64_t decided = change.instant - 200 * kUs;
    report(decided - 500 * kUs, "[control]", Event::prepare, "swap", change.instant, change.number);
    report(decided, "[control]", Event::commit, "swap", change.instant, change.number);
    for (const std::size_t member : change.members) {
      report(decided, "[control]", Event::member, trace_.header.components[member].name, 0,
             change.number);
    }
    changes_.push_back(std::move(change));
  }

  /// One processor: the most urgent task that is ready, until it waits or a more urgent one comes.
  void run(std::int64_t cpu) {
    std::vector<Task> tasks;
    for (std::size_t i = 0; i < trace_.header.components.size(); ++i) {
      if (trace_.header.components[i].cpus.front() != cpu) continue;
      Task task;
      task.component = i;
      task.next = trace_.header.components[i].offset;
      report(-100 * kUs, trace_.header.components[i].name, Event::started, {}, task.next);
      tasks.push_back(task);
    }
    for (std::int64_t now = 0; now < length_ && !tasks.empty();) {
      const auto ready = std::find_if(tasks.begin(), tasks.end(), [&](const Task& one) {
        return one.in_job || one.next <= now;
      });
      if (ready != tasks.end()) {
        now = go_on(*ready, tasks, now);
        continue;
      }
      const auto soonest = std::min_element(
          tasks.begin(), tasks.end(), [](const Task& x, const Task& y) { return x.next < y.next; });
      now = soonest->next + kWake;
    }
  }

  std::int64_t go_on(Task& task, const std::vector<Task>& tasks, std::int64_t now) {
    if (!task.in_job) begin(task, now);
    auto& [state, length] = task.left.front();
    const Component& its = component(task);
    if (!task.in_state) {
      report(now, its.name, Event::begin, its.states[state].name);
      if (state == 2) report(now, its.name, Event::lock, "world");
    }
    task.in_state = true;
    std::int64_t until = now + length;
    for (const Task& other : tasks) {
      if (&other == &task) break;  // those before it are more urgent
      if (!other.in_job) until = std::min(until, std::max(now, other.next));
    }
    length -= until - now;
    if (length > 0) {
      task.preempted = true;
      return until + kWake;
    }
    if (state == 2) report(until, its.name, Event::unlock, "world");
    report(until, its.name, Event::end, its.states[state].name, task.preempted ? 1 : 0);
    task.in_state = false;
    task.left.erase(task.left.begin());
    if (task.left.empty()) end(task, until);
    return until;
  }

  void begin(Task& task, std::int64_t now) {
    const std::string& name = component(task).name;
    if (task.wait > 0 && now - task.next >= task.wait) {
      const std::int64_t dropped = (now - task.next) / task.wait;
      task.next += dropped * task.wait;
      task.missed += dropped;
      report(now, name, Event::missed, {}, dropped, task.missed);
    }
    for (const Change& change : changes_) {
      const bool member = std::find(change.members.begin(), change.members.end(), task.component) !=
                          change.members.end();
      if (!member || change.number <= task.change || task.next < change.instant) continue;
      task.change = change.number;
      report(now, name, Event::applied, "change", change.instant, change.number);
    }
    task.released = task.next;
    report(now, name, Event::release, {}, task.released, task.change);
    const std::int64_t cost = cost_[task.component];
    for (std::size_t state = 0; state < 3; ++state) {
      task.left.emplace_back(state, any(cost / 2, cost));
    }
    task.in_job = true;
    task.preempted = false;
  }

  void end(Task& task, std::int64_t now) {
    const Component& its = component(task);
    const State& wait = its.states[static_cast<std::size_t>(
        any(3, static_cast<std::int64_t>(its.states.size()) - 1))];
    task.wait = wait.wait;
    task.next = task.released + wait.wait;
    if (now > task.next) {
      report(now, its.name, Event::overrun, {}, now - task.next, ++task.overruns);
    }
    report(now, its.name, Event::wait, wait.name, task.next, task.preempted ? 1 : 0);
    task.in_job = false;
  }

  std::mt19937 random_;
  Trace trace_;
  std::int64_t length_ = 0;
  std::vector<std::int64_t> cost_;  // of each state, by component
  std::vector<Change> changes_;
};

}  // namespace mauve::ctl::mtrace
