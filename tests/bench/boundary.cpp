// SPDX-License-Identifier: LGPL-3.0-or-later
/// The time that the runtime adds to each state and to each job, against calls of the same core
/// methods one after the other. Releases run back to back: each wait moves the clock forward
/// instead of sleeping.
#include <deque>
#include <memory>
#include <string>

#include "bench/support/checked.h"
#include "bench/support/machine.h"
#include "bench/support/report.h"
#include "bench/support/stepped_clock.h"

#include <mauve/host/architecture.h>

#include "exec/task/task.h"
#include "exec/update/decision.h"
#include "exec/update/task_update.h"

namespace bench {
namespace {

using mauve::exec::Task;
using mauve::exec::TaskUpdate;

constexpr std::size_t kStates = 100;
constexpr int kPriority = 50;
/// So long that no batch of jobs is late at its end.
constexpr Duration kWait{1'000'000'000};

/// The contract: methods that a compiler cannot see through.
struct Stepping : mauve::Core<mauve::EmptyShell> {
  using Contract = Stepping;
  static constexpr const char* contract = "stepping/core/1";
  virtual void step() = 0;
  virtual bool at_end() = 0;
};

struct Counting final : Stepping {
  mauve::Stateless stateless{*this};
  volatile std::uint64_t steps = 0;  // a loop of calls is not one addition
  [[gnu::noinline]] void step() override { steps = steps + 1; }
  [[gnu::noinline]] bool at_end() override { return steps == 0; }
};

/// `States` execution states in a row, then one wait. With `Guards`, each state has a transition
/// that is asked and not followed.
template <std::size_t States, bool Guards>
struct Chain : mauve::Fsm<Stepping> {
  Chain() {
    for (std::size_t i = 0; i < States; ++i) {
      const std::string& name = names.emplace_back("step" + std::to_string(i));
      states.push_back(std::make_unique<Exec>(*this, name, &Stepping::step));
    }
  }
  mauve::Status on_configure() override {
    start_at(*states.front());
    for (std::size_t i = 0; i < States; ++i) {
      mauve::FsmState& next = i + 1 < States ? static_cast<mauve::FsmState&>(*states[i + 1]) : wait;
      if (Guards) states[i]->when(&Stepping::at_end, wait);
      states[i]->then(next);
    }
    wait.then(*states.front());
    return mauve::ok();
  }

  std::deque<std::string> names;  // a state does not copy its name
  std::vector<std::unique_ptr<Exec>> states;
  Sync wait{*this, "wait", kWait};
};

/// How a component is looked after.
enum class Watch {
  none,        ///< but a budget
  undeclared,  ///< no budget: what a job uses is measured
  full,        ///< a change on probation, a bound for the guard, and a standby core standing by
};

/// A task as the deployer makes it, driven by hand.
template <typename FsmT>
class Driven {
 public:
  explicit Driven(Watch watch = Watch::none) {
    if (watch != Watch::undeclared) component_.task().budget = std::chrono::seconds(1);
    must(architecture_.configure());
    task_.begin(bundle(mauve::Mode::run), clock_.now());
    if (watch == Watch::full) look_after();
  }
  /// Nanoseconds for one job, over `jobs` of them.
  double job(int jobs) {
    const std::uint64_t before = task_.counters().releases;
    clock_.set(task_.next_release());
    const Instant start = now();
    for (int i = 0; i < jobs; ++i) {
      task_.serve();
      task_.run_release();
      clock_.step(kWait);
    }
    const Instant end = now();
    must_hold(task_.counters().releases == before + static_cast<std::uint64_t>(jobs),
              "some releases were no jobs");
    return static_cast<double>(end - start) / jobs;
  }
  [[nodiscard]] Stepping& core() const { return component_.core(); }

 private:
  [[nodiscard]] std::unique_ptr<TaskUpdate> bundle(mauve::Mode mode) {
    auto made = std::make_unique<TaskUpdate>();
    made->bundle = component_.bundle();
    made->mode = mode;
    made->bound = std::chrono::seconds(10);
    made->decision = &decided_;
    return made;
  }
  /// As after a change whose probation has begun; the guard would sleep until the bound.
  void look_after() {
    auto forth = bundle(mauve::Mode::keep);
    forth->back = bundle(mauve::Mode::keep);
    forth->back->decision = &rollback_.decision();
    forth->back->rollback = &rollback_;
    clock_.set(task_.next_release());
    task_.mailbox().publish(*forth.release());
    task_.run_release();
    must_hold(task_.mailbox().stand_by(*bundle(mauve::Mode::keep).release()),
              "there is no standby core");
  }

  mauve::exec::Decision decided_{0, mauve::exec::Decision::State::committed};
  mauve::exec::Rollback rollback_;
  mauve::Architecture architecture_;
  mauve::Component<mauve::EmptyShell, Counting, FsmT> component_{architecture_, "stepping"};
  SteppedClock clock_;
  Task task_{"stepping", clock_};
};

/// The same calls without a runtime.
double raw_calls(Stepping& core, std::size_t states, bool guards, int jobs) {
  const Instant start = now();
  for (int i = 0; i < jobs; ++i) {
    for (std::size_t state = 0; state < states; ++state) {
      core.step();
      if (guards && core.at_end()) break;
    }
  }
  return static_cast<double>(now() - start) / jobs;
}

struct Pair {
  double ours;
  double raw;
};

/// Medians of short batches, ours and raw in turn, on one CPU that is ours for that time.
template <typename FsmT>
Pair measure(Driven<FsmT>& driven, std::size_t states, bool guards, const Options& options) {
  const int jobs = static_cast<int>(10'000 / states);
  const int priority = fifo_or_none(kPriority);
  std::vector<double> ours;
  std::vector<double> raw;
  for (int batch = 0; batch < options.choose(100, 10); ++batch) {
    const OnCpu here(mauve::rt::usable_cpus().back(), priority);
    ours.push_back(driven.job(jobs));
    raw.push_back(raw_calls(driven.core(), states, guards, jobs));
  }
  return {median(ours), median(raw)};
}

void run(const Options& options) {
  Report report("boundary",
                "Cost of running core methods through a task, against calling them in a loop. A "
                "state is an execution state, its transition and its statistics; a job is a "
                "release, one state, a "
                "wait that is armed but not slept, and all clock readings and counters. With all "
                "watched: a change on probation, a bound for the guard, and a standby core. "
                "Without a budget each job asks the system what it used. Traced as always: four "
                "records a job, two a state.",
                options);
  Figure& state = report.figure("a state of 100 in a row", "ns", above_raw(100));
  Figure& guarded = report.figure("a state with one guard asked", "ns", above_raw(100));
  Figure& job = report.figure("a job of one state, without its sleep", "ns", above_raw(100));
  Figure& watched = report.figure("a state of 100 in a row, fully watched", "ns", above_raw(100));
  Figure& watched_guarded =
      report.figure("a state with one guard, fully watched", "ns", above_raw(100));
  Figure& watched_job = report.figure("a job of one state, fully watched", "ns", above_raw(100));
  Figure& undeclared_job = report.figure("a job of one state, no budget", "ns", above_raw(1000));
  Driven<Chain<kStates, false>> chain;
  Driven<Chain<kStates, true>> guarded_chain;
  Driven<Chain<1, false>> single;
  Driven<Chain<kStates, false>> watched_chain(Watch::full);
  Driven<Chain<kStates, true>> watched_guarded_chain(Watch::full);
  Driven<Chain<1, false>> watched_single(Watch::full);
  Driven<Chain<1, false>> undeclared_single(Watch::undeclared);
  const auto add = [&options](Figure& figure, auto& driven, std::size_t states, bool guards) {
    const Pair jobs = measure(driven, states, guards, options);
    figure.add(jobs.ours / static_cast<double>(states), jobs.raw / static_cast<double>(states));
  };
  for (int i = 0; i < options.rounds; ++i) {
    tie_ticks();
    add(state, chain, kStates, false);
    add(guarded, guarded_chain, kStates, true);
    add(job, single, 1, false);
    add(watched, watched_chain, kStates, false);
    add(watched_guarded, watched_guarded_chain, kStates, true);
    add(watched_job, watched_single, 1, false);
    add(undeclared_job, undeclared_single, 1, false);
  }
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) { bench::run(bench::parse(argc, argv)); }
