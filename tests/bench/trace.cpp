// SPDX-License-Identifier: LGPL-3.0-or-later
/// The cost of tracing: one event of a core, a state, and a job that does some work, with tracing
/// on and off in turn.
#include <memory>
#include <string>

#include "bench/support/checked.h"
#include "bench/support/machine.h"
#include "bench/support/report.h"
#include "bench/support/stepped_clock.h"

#include <mauve/detail/job.h>
#include <mauve/host/architecture.h>
#include <mauve/trace.h>

#include "exec/task/task.h"
#include "exec/update/task_update.h"
#include "rt/ring/trace_ring.h"

namespace bench {
namespace {

using mauve::TraceMode;
using mauve::exec::Task;
using mauve::exec::TaskUpdate;

constexpr int kPriority = 50;
constexpr Duration kWait{1'000'000'000};

/// As long as it is ordered to, without looking at a clock.
struct Working final : mauve::Core<mauve::EmptyShell> {
  mauve::Stateless stateless{*this};
  mauve::TraceEvent event{*this, "event"};
  int turns = 0;
  bool records = false;
  volatile double value = 1;

  void update() {
    for (int i = 0; i < turns; ++i) value = value * 1.0000001 + 1e-9;
    if (records) event(value);
  }
};

/// A task as the deployer makes it, driven by hand on the clock of the machine.
class Driven {
 public:
  Driven() {
    must(architecture_.configure());
    auto first = std::make_unique<TaskUpdate>();
    first->bundle = component_.bundle();
    first->mode = mauve::Mode::run;
    first->bound = std::chrono::seconds(10);
    task_.begin(std::move(first), clock_.now());
  }
  Working& core() const { return component_.core(); }
  /// Nanoseconds for one job.
  double job(int jobs) {
    clock_.set(task_.next_release());
    const Instant start = now();
    for (int i = 0; i < jobs; ++i) {
      task_.serve();
      task_.run_release();
      clock_.step(kWait);
    }
    return static_cast<double>(now() - start) / jobs;
  }

 private:
  mauve::Architecture architecture_;
  mauve::Component<mauve::EmptyShell, Working, mauve::PeriodicFsm<Working>> component_{
      architecture_, "working"};
  SteppedClock clock_;
  Task task_{"working", clock_};
};

struct Pair {
  double on;
  double off;
};

/// Medians of short batches, traced and not traced in turn.
Pair measure(Driven& driven, int jobs, const Options& options) {
  std::vector<double> on;
  std::vector<double> off;
  const int priority = fifo_or_none(kPriority);
  for (int batch = 0; batch < options.choose(200, 10); ++batch) {
    const OnCpu here(mauve::rt::usable_cpus().back(), priority);
    mauve::set_trace_mode(TraceMode::jobs);
    on.push_back(driven.job(jobs));
    mauve::set_trace_mode(TraceMode::off);
    off.push_back(driven.job(jobs));
  }
  return {median(on), median(off)};
}

/// Nanoseconds for one turn of a loop.
template <typename Body>
double each(int turns, Body&& body) {
  const Instant start = now();
  for (int i = 0; i < turns; ++i) body(i);
  return static_cast<double>(now() - start) / turns;
}

void events(Figure& on, Figure& off, Figure& is_direct) {
  constexpr int kTurns = 20'000;
  static mauve::rt::TraceRing ring;
  static Working core;
  mauve::this_job().trace = &ring;
  const OnCpu here(mauve::rt::usable_cpus().back(), fifo_or_none(kPriority));
  const auto nothing = [](int i) { core.value = i; };
  const auto event = [](int i) {
    core.value = i;
    core.event(i);
  };
  const double loop = each(kTurns, nothing);
  mauve::set_trace_mode(TraceMode::jobs);
  on.add(each(kTurns, event) - loop);
  is_direct.add(each(kTurns, [](int i) { ring.push(mauve::TraceKind::wait, i, 1, 0, i); }));
  mauve::set_trace_mode(TraceMode::off);
  off.add(each(kTurns, event) - loop);
  mauve::this_job().trace = nullptr;
}

void run(const Options& options) {
  Report report("trace",
                "Cost of tracing. An event of a core is read from the clock and written into the "
                "ring of its thread; a job is a release, one state and a wait, which makes four "
                "records, against the same job while tracing is off (raw).",
                options);
  Figure& on = report.figure("an event of a core", "ns", at_most(15));
  Figure& is_direct = report.figure("an event whose time is at hand", "ns", at_most(15));
  Figure& off = report.figure("an event while tracing is off", "ns", at_most(1));
  Figure& empty = report.figure("a job that does nothing, traced", "ns", above_raw(60));
  Figure& some = report.figure("a job of some 5 us, traced", "ns", times_raw(1.02));
  Figure& more = report.figure("a job of some 50 us, traced", "ns", times_raw(1.02));
  Driven driven;
  const auto add = [&](Figure& figure, int turns, int jobs) {
    driven.core().turns = turns;
    const Pair pair = measure(driven, jobs, options);
    figure.add(pair.on, pair.off);
  };
  for (int i = 0; i < options.rounds; ++i) {
    tie_ticks();
    events(on, off, is_direct);
    add(empty, 0, 2000);
    add(some, 1000, 100);
    add(more, 10'000, 20);
  }
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) { bench::run(bench::parse(argc, argv)); }
