// SPDX-License-Identifier: LGPL-3.0-or-later
/// The analysis of 500 components on 2 CPUs: how long a change waits for its admission.
#include <chrono>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <random>

#include "analysis/admission.h"
#include "analysis/machine.h"
#include "analysis/transition.h"
#include "bench/support/report.h"

namespace bench {
namespace {

namespace analysis = mauve::analysis;
using mauve::Duration;
using namespace std::chrono_literals;

constexpr int kCpus = 2;
constexpr int kLoad = 60;  // percent of each CPU
/// Where each timer has an instant of its own, interrupts of a virtual machine would take a third.
constexpr analysis::Overheads kBareMetal{10us, 1us, 3us, 5us, 4ms, 5us};

/// A component of one state, run each `period`.
analysis::Graph each(Duration period, Duration execution) {
  analysis::Machine machine;
  machine.states = {analysis::running("update", execution, analysis::Source::measured, {1}),
                    analysis::waiting("period", period, {0})};
  return analysis::to_graph(machine).value();
}

/// Shares the load evenly. `periods` in us. One in five holds a lock of a group of eight.
analysis::TaskSet components(int count, const std::vector<int>& periods,
                             const analysis::Overheads& overheads) {
  analysis::TaskSet set{{}, overheads};
  std::mt19937 random(1);
  const int of_a_cpu = count / kCpus;
  for (int i = 0; i < count; ++i) {
    const std::size_t which = random() % periods.size();
    const Duration period = std::chrono::microseconds(periods[which]);
    const Duration share = period * kLoad / 100 / of_a_cpu;
    // The time that the machine needs for each job is part of the load.
    const Duration execution = std::max<Duration>(share - set.overheads.activation, 1us);
    analysis::Task task;
    task.name = "component" + std::to_string(i);
    task.cpu = i % kCpus;
    task.priority = 90 - static_cast<int>(which);
    task.graph = each(period, execution);
    if (i % 10 < kCpus) {
      task.sections = {
          {"resource" + std::to_string(i % kCpus) + "." + std::to_string(i / 80), execution / 2}};
    }
    set.tasks.push_back(std::move(task));
  }
  return set;
}

/// Milliseconds of one call.
double timed(const std::function<void()>& body) {
  const auto begin = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
      .count();
}

double median_of(const Options& options, const std::function<void()>& body) {
  std::vector<double> times;
  for (int i = 0; i < options.choose(20, 2); ++i) times.push_back(timed(body));
  return median(std::move(times));
}

void must_pass(const analysis::Report& report) {
  if (report.proven()) return;
  std::cerr << mauve::to_string(analysis::problems(report).front().error) << "\n";
  std::exit(1);
}

/// All numbers of `set`, and of the change of ten of its components.
void measure(Report& report, const Options& options, const std::string& text,
             const analysis::TaskSet& set) {
  analysis::TaskSet after = set;
  for (std::size_t i = 0; i < 10; ++i) after.tasks[i * set.tasks.size() / 10].version = 1;
  must_pass(analysis::analyze(set));
  must_pass(analysis::admit(set, after));
  Figure& whole = report.figure(text + ": analyze", "ms", at_most(10));
  Figure& change = report.figure(text + ": admit a change of 10", "ms", at_most(10));
  for (int i = 0; i < options.rounds; ++i) {
    whole.add(median_of(options, [&] { static_cast<void>(analysis::analyze(set)); }));
    change.add(median_of(options, [&] { static_cast<void>(analysis::admit(set, after)); }));
  }
}

void run(const Options& options) {
  Report report("admission",
                "Response times of all jobs of components on 2 CPUs, each 60 % loaded, computed "
                "by one thread.",
                options);
  const int count = options.choose(500, 50);
  const std::string text = std::to_string(count) + " components";
  const analysis::TaskSet harmonic =
      components(count, {1000, 2000, 5000, 10'000, 20'000, 50'000, 100'000}, {});
  measure(report, options, text + ", harmonic periods", harmonic);
  measure(report, options, text + ", periods that share no factor",
          components(count, {3011, 7013, 11'003, 17'011, 29'009, 47'017, 97'001}, kBareMetal));
  Figure& factor = report.figure(text + ": largest factor of all execution times", "ms");
  for (int i = 0; i < options.rounds; ++i) {
    factor.add(timed([&] { static_cast<void>(analysis::largest_factor(harmonic)); }));
  }
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) { bench::run(bench::parse(argc, argv)); }
