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
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <mauve/detail/job.h>
#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/job_cost.h>

namespace mauve {

/// The far ends of all ports of one shell: a value to read, a place to write to, an answer to give.
class PortBench {
 public:
  /// Connects each port of plain data.
  explicit PortBench(Shell& shell) : shell_(shell) {
    for (PortBase* port : shell.ports()) {
      const Signature& signature = port->signature();
      ends_.emplace_back();
      if (signature.data == nullptr || !signature.data->flat) continue;
      ends_.back() = std::make_unique<SharedDataBase>(std::string(port->name()), *signature.data);
      static_cast<void>(port->connect(signature.kind == PortKind::read
                                          ? ends_.back()->read_service()
                                          : ends_.back()->write_service()));
    }
  }

  /// The port reads this value from now on; the value is written now.
  template <typename T>
  void give(const ReadPort<T>& port, const T& value) {
    ends_[port.index()]->write_service().write(&value);
  }
  /// Before configure: the port finds older values stale, as with `max_age` in a file.
  template <typename T>
  void max_age(ReadPort<T>& port, Duration age) {
    shell_.initial_bindings()[port.index()] = nullptr;
    static_cast<void>(port.connect(ends_[port.index()]->read_service(), age));
  }
  /// The last value that the core wrote; empty when it never did.
  template <typename T>
  [[nodiscard]] std::optional<T> written(const WritePort<T>& port) {
    T value{};
    Cursor cursor{ends_[port.index()]->read_service().attach(), 0, 0};
    const DataStatus status = ends_[port.index()]->read_service().read(&value, cursor);
    ends_[port.index()]->read_service().detach(cursor.slot);
    return has_value(status) ? std::optional<T>(value) : std::nullopt;
  }
  /// Before configure: `function` answers the calls of this port.
  template <typename R, typename... P>
  void answer(CallPort<R(P...)>& port, std::function<R(P...)> function) {
    answers_.push_back(std::make_unique<Answer<R, P...>>(std::move(function)));
    static_cast<void>(port.connect(*answers_.back()));
  }

 private:
  static SharedDataBase& nowhere() {
    static SharedDataBase resource("test_kit", data_type<double>());
    return resource;
  }
  template <typename R, typename... P>
  class Answer final : public ServiceBase {
   public:
    explicit Answer(std::function<R(P...)> function)
        : ServiceBase(nowhere().interface(), "answer", Signature::call<R, P...>()),
          function_(std::move(function)) {}
    bool invoke(void* result, void* const* arguments) override {
      return call(result, arguments, std::index_sequence_for<P...>{});
    }

   private:
    template <std::size_t... I>
    bool call(void* result, void* const* arguments, std::index_sequence<I...>) {
      *static_cast<R*>(result) = function_(*static_cast<std::remove_cvref_t<P>*>(arguments[I])...);
      return true;
    }
    std::function<R(P...)> function_;
  };

  Shell& shell_;
  std::vector<std::unique_ptr<SharedDataBase>> ends_;  // by port index; null: not of this kind
  std::vector<std::unique_ptr<ServiceBase>> answers_;
};

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
  /// The heap and kernel use of the jobs of the last run_for(); page faults are those of the
  /// simulation too.
  [[nodiscard]] const JobCost& cost() const { return cost_; }

 private:
  Component<ShellT, CoreT, FsmT> component_{*this, "component"};
  PortBench ports_{component_.shell()};
  JobCost cost_;
  Deployer deployer_{*this, {.realtime = Realtime::off, .simulated = true}};
};

}  // namespace mauve
