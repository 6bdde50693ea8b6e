// SPDX-License-Identifier: LGPL-3.0-or-later
#include "simulation.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "analysis/admission.h"
#include "scheduler.h"

namespace simulated {
namespace {

namespace analysis = mauve::analysis;
using analysis::Graph;
using analysis::Part;
using analysis::Presence;
using namespace std::chrono_literals;

constexpr std::uint64_t kJobsOfASet = 500;

/// A task as the analysis and the simulation see it.
struct Pair {
  analysis::Task before;
  analysis::Task after;
  Presence presence = Presence::always;
  bool changes = false;
};

class Sets {
 public:
  explicit Sets(std::uint64_t seed) : random_(seed) {}

  /// Nothing when the analysis refuses it.
  [[nodiscard]] std::vector<Task> make() {
    overheads_ = random_.chance(50) ? analysis::no_overheads() : analysis::Overheads{};
    with_change_ = random_.chance(60);
    const std::size_t count = 2 + random_.below(5);
    const std::int64_t load = random_.between(30, 130);
    pairs_.clear();
    for (std::size_t i = 0; i < count; ++i) pairs_.push_back(pair(i, count, load));
    const analysis::Report report = judge();
    return report.passes() ? tasks(report) : std::vector<Task>{};
  }
  [[nodiscard]] const analysis::Overheads& overheads() const { return overheads_; }
  /// All releases of the last set made are at its multiples.
  [[nodiscard]] Time grid() const {
    Time grid = 0;
    for (const Pair& pair : pairs_) {
      grid = std::gcd(grid, pair.before.offset.count());
      for (const Graph* graph : {&pair.before.graph, &pair.after.graph}) {
        for (const analysis::Edge& edge : graph->edges) {
          grid = std::gcd(grid, edge.separation.count());
        }
      }
    }
    return grid;
  }
  Random& random() { return random_; }

 private:
  Graph graph(mauve::Duration period, mauve::Duration work, bool is_new) {
    std::vector<std::string> names{"a"};
    if (random_.chance(50)) names.push_back(is_new && random_.chance(50) ? "c" : "b");
    if (is_new && random_.chance(30)) names.front() = "d";
    const analysis::Machine machine = random_systems::machine(random_, names, period, work);
    const mauve::Duration deadline = random_.chance(50) ? period : 0ns;
    return analysis::to_graph(machine, {deadline, 0ns}).value();
  }

  Pair pair(std::size_t number, std::size_t count, std::int64_t load) {
    constexpr std::array<int, 8> periods{1, 2, 4, 5, 8, 10, 20, 50};
    const std::size_t which = random_.below(periods.size());
    const mauve::Duration period = std::chrono::milliseconds(periods[which]);
    const mauve::Duration share = period * load / 100 / static_cast<std::int64_t>(count);
    const mauve::Duration work = random_.time(share / 2, share * 3 / 2);
    Pair pair;
    analysis::Task& task = pair.before;
    task.name = "task" + std::to_string(number);
    task.cpu = 0;
    task.priority = 50 - static_cast<int>(random_.chance(85) ? which : random_.below(8));
    if (random_.chance(50)) task.offset = std::chrono::milliseconds(random_.between(0, 20));
    if (random_.chance(15)) task.jitter = random_.time(0ns, period / 10);
    for (int i = 0; i < 2; ++i) {
      if (!random_.chance(50)) continue;
      const std::string resource = std::to_string(2 * random_.below(2) + static_cast<unsigned>(i));
      task.sections.push_back({resource, random_.time(0ns, work / 4)});
    }
    task.graph = graph(period, work, false);
    pair.after = task;
    if (!with_change_) return pair;
    const std::int64_t dice = random_.between(1, 100);
    pair.changes = dice > 30 && dice <= 70;
    if (dice > 70) pair.presence = dice > 85 ? Presence::before : Presence::after;
    if (pair.changes)
      pair.after.graph = graph(period, random_.time(share / 2, share * 3 / 2), true);
    pair.after.version = pair.changes ? 1 : 0;
    return pair;
  }

  [[nodiscard]] analysis::Report judge() const {
    analysis::TaskSet before{{}, overheads_};
    analysis::TaskSet after{{}, overheads_};
    for (const Pair& pair : pairs_) {
      if (pair.presence != Presence::after) before.tasks.push_back(pair.before);
      if (pair.presence != Presence::before) after.tasks.push_back(pair.after);
    }
    return with_change_ ? analysis::admit(before, after) : analysis::analyze(after);
  }

  using Bounds = std::map<std::string, Time>;

  /// By the names of the jobs; a job that the analysis does not know must not come.
  static std::vector<Time> bounds(const Bounds& known, const Graph& graph, Part part) {
    std::vector<Time> result;
    for (analysis::Vertex vertex : graph.vertices) {
      vertex.part = part;
      const auto found = known.find(analysis::name(vertex));
      result.push_back(found == known.end() ? -1 : found->second);
    }
    return result;
  }
  static Version version(const Bounds& known, const Graph& graph, Part part, Part first) {
    return {graph, bounds(known, graph, part), bounds(known, graph, first)};
  }

  Task task(const Pair& pair, const Bounds& known, Time change, Time back) const {
    const analysis::Task& seen = pair.before;
    Task task{seen.name, seen.priority, seen.offset.count(), seen.jitter.count(), {}, {}, {}};
    for (const analysis::Section& section : seen.sections) {
      task.sections.push_back({std::stoul(section.resource), section.length.count()});
    }
    const Version steady = version(known, seen.graph, Part::steady, Part::steady);
    if (pair.changes) {
      task.versions = {version(known, seen.graph, Part::before, Part::before),
                       version(known, pair.after.graph, Part::after, Part::first_after),
                       version(known, seen.graph, Part::back, Part::first_back)};
    } else if (pair.presence == Presence::always) {
      task.versions = {steady};
    } else if (pair.presence == Presence::before) {
      task.versions = {steady, Version{}, steady};
    } else {
      task.versions = {Version{}, steady, Version{}};
    }
    task.starts = {0, change, back};
    return task;
  }

  std::vector<Task> tasks(const analysis::Report& report) {
    const Time common = random_instant();
    const Time common_back = common + random_instant();
    std::map<std::string, Bounds> known;
    for (const analysis::TaskReport& task : report.tasks) {
      for (const analysis::JobReport& job : task.jobs) {
        known[task.name][analysis::name(job.job)] = job.response.count();
      }
    }
    std::vector<Task> result;
    for (const Pair& pair : pairs_) {
      const Time change = pair.changes ? random_instant() : common;
      const Time back = pair.changes ? change + random_instant() : common_back;
      result.push_back(task(pair, known[pair.before.name], change, back));
    }
    return result;
  }

  /// Up to 200 ms.
  Time random_instant() { return grid() * random_.between(1, 1 + 200'000'000 / grid()); }

  Random random_;
  analysis::Overheads overheads_;
  bool with_change_ = false;
  std::vector<Pair> pairs_;
};

}  // namespace

Outcome simulate(std::uint64_t seed, std::uint64_t jobs) {
  Outcome outcome;
  Sets sets(seed);
  while (outcome.jobs < jobs && outcome.violation.empty()) {
    ++outcome.sets;
    std::vector<Task> tasks = sets.make();
    if (tasks.empty()) continue;
    ++outcome.admitted;
    const Result result =
        run(std::move(tasks), sets.overheads(), sets.grid(), kJobsOfASet, sets.random());
    outcome.jobs += result.jobs;
    outcome.tightest = std::max(outcome.tightest, result.tightest);
    if (!result.violation.empty()) {
      outcome.violation = "set " + std::to_string(outcome.sets) + ": " + result.violation;
    }
  }
  return outcome;
}

}  // namespace simulated
