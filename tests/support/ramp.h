// SPDX-License-Identifier: LGPL-3.0-or-later
/// A small component for tests: a ramp that adds `step` each job and writes its value; the value is
/// the state that survives swaps. Its clock and counts show the jobs that ran, with their times.
#pragma once

#include <atomic>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/plugin.h>

namespace ramp {

struct Position {
  double value = 0;
};

struct Shell : mauve::Shell {
  mauve::ReadPort<double> speed{*this, "speed", 1.0, mauve::Need::optional};
  mauve::WritePort<double> out{*this, "out", mauve::Safe{-1.0}};
};

/// The contract.
class RampCore : public mauve::Core<Shell> {
 public:
  using Contract = RampCore;
  static constexpr const char* contract = "ramp/core/1";
  virtual void update() = 0;
};

using Fsm = mauve::PeriodicFsm<RampCore>;

/// Adds `step`.
class Up : public RampCore {
 public:
  mauve::Property<double> step{
      *this, "step", 1.0, "added each job", {.unit = "m", .min = 0, .max = 10}};
  mauve::State<Position> state{*this};
  mauve::Observable<int> jobs{*this, "jobs", 0, "jobs run"};

  void update() override {
    state->value += step;
    ++jobs;
    shell().out.write(state->value);
  }
  mauve::Status on_configure() override {
    ++configured_cores();
    return step == 7.0 ? mauve::invalid(step, "must not be seven") : mauve::ok();
  }
  void on_cleanup() override { --configured_cores(); }

  /// Cores configured and not cleaned up, in this process.
  static std::atomic<int>& configured_cores() {
    static std::atomic<int> count{0};
    return count;
  }
};

/// Subtracts 1.
class Down : public RampCore {
 public:
  mauve::State<Position> state{*this};
  void update() override {
    state->value -= 1.0;
    shell().out.write(state->value);
  }
};

/// Declares neither state nor statelessness.
class Forgetful : public RampCore {
 public:
  mauve::Property<double> step{*this, "step", 1.0, "added each job", {.unit = "m"}};
  void update() override { shell().out.write(value_ += step); }

 private:
  double value_ = 0;
};

struct ThrowingOnConfigure : Up {
  mauve::Status on_configure() override { throw std::runtime_error("no such device"); }
};
struct ThrowingConstructor : Up {
  ThrowingConstructor() { throw std::runtime_error("out of luck"); }
};
struct ThrowingInJob : Up {
  void update() override {
    if (state->value > 3) throw std::runtime_error("sensor lost");
    Up::update();
  }
};

/// Of another contract.
class Stranger : public mauve::Core<Shell> {
 public:
  using Contract = Stranger;
  static constexpr const char* contract = "stranger/core/1";
  void update() {}
};

/// One ramp with this core at 10 ms, its output in `position`.
template <typename Core>
struct One : mauve::Architecture {
  mauve::SharedData<double> position{*this, "position"};
  mauve::Component<Shell, Core, Fsm> control{*this, "control"};

  mauve::Status on_configure() override {
    return control.shell().out.connect(position.write_service());
  }
};

/// And one whose speed may come from `speed`.
struct Architecture : One<Up> {
  mauve::SharedData<double> speed{*this, "speed"};
};

/// `left`, which a test is about, and `right`, which is well; both at 10 ms.
template <typename Left, typename Right = Up>
struct Two : mauve::Architecture {
  mauve::SharedData<double> left_position{*this, "left_position"};
  mauve::SharedData<double> right_position{*this, "right_position"};
  mauve::Component<Shell, Left, Fsm> left{*this, "left"};
  mauve::Component<Shell, Right, Fsm> right{*this, "right"};

  mauve::Status on_configure() override {
    if (auto done = left.shell().out.connect(left_position.write_service()); !done) return done;
    return right.shell().out.connect(right_position.write_service());
  }
};

/// At 5 ms; when `left` fails, it counts down.
template <typename Left, typename Right = Up>
struct FallingBack : Two<Left, Right> {
  using Action = mauve::FaultPolicy::Action;

  explicit FallingBack(Action action = Action::fallback) {
    this->left.task().on_fault.action = action;
    this->left.fall_back_to(
        mauve::ComponentBase::Fallback{mauve::CoreType::of<Down>("ramp/down"), {}});
    this->left.fsm().period = std::chrono::milliseconds(5);
    this->right.fsm().period = std::chrono::milliseconds(5);
  }
};

/// Another core for one component.
template <typename Core>
mauve::Edit to_core(std::string type_name, std::string component = "control") {
  mauve::Edit edit;
  edit.member = std::move(component);
  edit.core = mauve::CoreType::of<Core>(std::move(type_name));
  return edit;
}

inline double read(mauve::SharedDataBase& data) {
  double value = 0;
  mauve::Cursor cursor;
  cursor.slot = data.read_service().attach();
  static_cast<void>(data.read_service().read(&value, cursor));
  data.read_service().detach(cursor.slot);
  return value;
}

}  // namespace ramp
