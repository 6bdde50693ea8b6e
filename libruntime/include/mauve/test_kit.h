// SPDX-License-Identifier: LGPL-3.0-or-later
/// Test kit for authors of cores: ports with values set by hand, a clock moved by hand, no threads.
///
///   mauve::CoreBench<ControlShell, PotentialField> bench;
///   bench.core().gain = 0.3;
///   ASSERT_TRUE(bench.configure());
///   bench.give(bench.shell().pose, Pose2D{1, 2, 0});
///   bench.core().advance();
///   EXPECT_GT(bench.written(bench.shell().command)->linear, 0);
///
/// Code of a real-time thread calls neither heap nor kernel:
///   EXPECT_EQ(bench.cost([&] { bench.core().advance(); }).heap_calls, 0U);
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include <mauve/detail/job.h>
#include <mauve/detail/port_bench.h>
#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/job_cost.h>

namespace mauve {

/// One core with its shell; its methods are called by the test, on the thread of the test.
/// @snippet api_examples.cpp CoreBench
template <typename ShellT, typename CoreT>
class CoreBench {
 public:
  CoreBench() {
    base(shell_).adopt("bench.shell");
    base(core_).adopt("bench.core");
    base(core_).bind(shell_);
  }
  ~CoreBench() {
    static_cast<void>(base(core_).cleanup());
    static_cast<void>(base(shell_).cleanup());
    this_job().start = 0;
    this_job().step = {};
  }

  [[nodiscard]] ShellT& shell() { return shell_; }  ///< of the core
  [[nodiscard]] CoreT& core() { return core_; }     ///< under test

  /// Shell, then core; the ports are connected from now on.
  Status configure() {
    Shell& shell = base(shell_);
    bindings_ = std::move(shell.initial_bindings());
    shell.initial_bindings().assign(bindings_.size(), nullptr);
    shell.use(&bindings_);
    if (Status done = shell.configure(); !done) return done;
    return base(core_).configure();
  }
  /// The port reads this value from now on.
  template <typename T>
  void give(const ReadPort<T>& port, const T& value) {
    ports_.give(port, value);
  }
  /// Before configure(): the port finds older values stale, as with `max_age` in a file.
  template <typename T>
  void max_age(ReadPort<T>& port, Duration age) {
    ports_.max_age(port, age);
  }
  /// The last value written; empty: none.
  template <typename T>
  [[nodiscard]] std::optional<T> written(const WritePort<T>& port) {
    return ports_.written(port);
  }
  /// Before configure(): `function` answers the calls of this port.
  template <typename R, typename... P>
  void answer(CallPort<R(P...)>& port, std::function<R(P...)> function) {
    ports_.answer(port, std::move(function));
  }
  /// Moves the clock that ages of read values are measured with; it starts at one second. The next
  /// calls of the core find this time as their time_step().
  void advance(Duration by) {
    this_job().start = (now_ += by.count());
    this_job().step = by;
  }
  /// The heap and kernel use of `code`, such as a call of the core. The first call of a function
  /// may cost more than later ones, since it touches its memory for the first time.
  template <typename Code>
  JobCost cost(Code&& code) {
    return cost_of(std::forward<Code>(code));
  }

 private:
  // A name that the author has declared too is another method.
  static Shell& base(Shell& shell) { return shell; }
  static CoreBase& base(CoreBase& core) { return core; }

  Instant now_ = this_job().start = 1'000'000'000;
  ShellT shell_;
  PortBench ports_{shell_};
  CoreT core_;
  Bindings bindings_;
};

/// One component with its state machine, on simulated time and without threads.
/// @snippet api_examples.cpp ComponentBench
template <typename ShellT, typename CoreT, typename FsmT>
class ComponentBench : public Architecture {
 public:
  [[nodiscard]] ShellT& shell() { return component_.shell(); }  ///< of the component
  /// In force.
  [[nodiscard]] CoreT& core() { return static_cast<CoreT&>(component_.ComponentBase::core()); }
  [[nodiscard]] FsmT& fsm() { return component_.fsm(); }    ///< of the component
  [[nodiscard]] PortBench& ports() { return ports_; }       ///< the services of its ports
  [[nodiscard]] Deployer& deployer() { return deployer_; }  ///< for changes
  /// Counts, state, times.
  [[nodiscard]] ComponentStatus status() const { return deployer_.status("component"); }

  /// Configures and releases at T0 of the simulated clock.
  Status deploy() { return deployer_.deploy(); }
  /// Runs all jobs that are released in this time, on the calling thread.
  void run_for(Duration duration) {
    cost_ = cost_of([&] { deployer_.run_for(duration); }, true);
  }
  /// Exchanges the core for a new one of its class, as a reload does: properties, observables and
  /// state continue, all else of the core begins anew. After deploy().
  Status renew() {
    const Result<Receipt> done = deployer_.swap_core<CoreT>("component");
    return done ? ok() : Status(done.error());
  }
  /// The values of the write ports with a described type, and of the observables of the core.
  [[nodiscard]] BenchOutputs outputs() const {
    BenchOutputs all = ports_.written();
    for (const ObservableBase* one : component_.ComponentBase::core().observables()) {
      all.emplace_back("core." + std::string(one->name()), to_string(one->value()));
    }
    return all;
  }
  /// The heap and kernel use of the jobs of the last run_for(); page faults are those of the
  /// simulation too.
  [[nodiscard]] const JobCost& cost() const { return cost_; }

 private:
  Component<ShellT, CoreT, FsmT> component_{*this, "component"};
  PortBench ports_{component_.shell()};
  JobCost cost_;
  Deployer deployer_{*this, {.realtime = Realtime::off, .simulated = true}};
};

/// The ready test of a core: a swap with itself changes no output. Two benches are prepared and
/// driven alike, with the number of the step; the core of one of them is renewed before each step.
/// Returns "" if all outputs() are alike after each step, else a sentence with the first that
/// differs. `prepare` deploys the bench, and both functions return nothing.
/// @snippet api_examples.cpp difference_when_renewed
template <typename BenchT, typename Prepare, typename Step>
[[nodiscard]] std::string difference_when_renewed(int steps, Prepare&& prepare, Step&& step) {
  BenchT lasting;
  BenchT renewed;
  prepare(lasting);
  prepare(renewed);
  for (int i = 0; i < steps; ++i) {
    if (const Status done = renewed.renew(); !done) return to_string(done.error());
    step(lasting, i);
    step(renewed, i);
    const BenchOutputs wanted = lasting.outputs();
    const BenchOutputs found = renewed.outputs();
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (wanted[k].second == found[k].second) continue;
      return wanted[k].first + " is " + wanted[k].second + " in step " + std::to_string(i) +
             ", and " + found[k].second +
             " after a swap of the core with itself: keep what it is "
             "made of in the mauve::State";
    }
  }
  return {};
}

}  // namespace mauve
