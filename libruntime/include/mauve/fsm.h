// SPDX-License-Identifier: LGPL-3.0-or-later
/// Clock-based state machines: when a component runs which function (paper 3.4, Listing 3).
#pragma once

#include <string_view>
#include <type_traits>
#include <vector>

#include <mauve/core.h>
#include <mauve/detail/configurable.h>
#include <mauve/detail/declared.h>
#include <mauve/detail/method.h>
#include <mauve/property.h>
#include <mauve/time.h>

namespace mauve {

class FsmBase;

/// One state: an execution state runs a core method, a synchronization state waits until the
/// component's clock has advanced by a duration.
class FsmState {
 public:
  /// Whether a state runs code or waits.
  enum class Kind : std::uint8_t { execution, synchronization };

  /// A transition: followed when its guard is true; the first true one wins.
  struct Transition {
    Method<bool()> guard;   ///< a method of the core
    FsmState* target;       ///< the next state
    std::string_view name;  ///< of the guard, for pictures and tables; empty: the author gave none
  };

  /// Registers itself. Authors declare Exec and Sync.
  FsmState(FsmBase& fsm, std::string_view name, Kind kind);
  FsmState(const FsmState&) = delete;
  FsmState& operator=(const FsmState&) = delete;
  virtual ~FsmState() = default;

  [[nodiscard]] std::string_view name() const { return name_; }  ///< the same word as the member
  [[nodiscard]] Kind kind() const { return kind_; }              ///< execution or synchronization
  [[nodiscard]] std::size_t index() const { return index_; }     ///< in the order of declaration
  [[nodiscard]] std::uint32_t trace_name() const { return trace_name_; }  ///< see trace_name_id()
  /// In the order in which they are asked.
  [[nodiscard]] const std::vector<Transition>& transitions() const { return transitions_; }
  [[nodiscard]] FsmState* successor() const { return successor_; }  ///< when no guard is true

  /// The successor when no guard is true.
  FsmState& then(FsmState& target) {
    successor_ = &target;
    return *this;
  }

  /// Execution: runs the method. [rt]
  virtual void run(CoreBase& /*core*/) {}
  /// Synchronization: how far the clock advances.
  [[nodiscard]] virtual Duration duration() const { return Duration{0}; }

  /// The state after this one: guards in order, then the default. [rt]
  [[nodiscard]] FsmState& next(CoreBase& core) const {
    for (const Transition& transition : transitions_) {
      if (transition.guard(core)) return *transition.target;
    }
    return *successor_;
  }

 protected:
  /// Adds a transition after those that were added before.
  void add(std::string_view name, Method<bool()> guard, FsmState& target) {
    transitions_.push_back({guard, &target, name});
  }

 private:
  friend class FsmBase;

  std::string_view name_;
  Kind kind_;
  std::size_t index_;
  std::uint32_t trace_name_;
  std::vector<Transition> transitions_;
  FsmState* successor_ = nullptr;
};

/// The base class of state machines, through which the runtime uses them.
class FsmBase : public Configurable {
 public:
  /// In the order of declaration.
  [[nodiscard]] const std::vector<FsmState*>& states() const { return states_; }
  [[nodiscard]] FsmState* initial() const { return initial_; }      ///< the state of the first job
  [[nodiscard]] FsmState* find_state(std::string_view name) const;  ///< null: there is none
  /// Greatest common divisor of all waits: the grid on which the component may be started.
  [[nodiscard]] Duration grid() const;
  /// The shortest wait: the bound of every wait for a resource.
  [[nodiscard]] Duration shortest_wait() const;

 protected:
  /// In on_configure(): the state of the first job.
  void start_at(FsmState& state) { initial_ = &state; }
  /// After on_configure(): initial state set, every state has a successor, all reachable, no wait
  /// of zero, no cycle of execution states (it would never wait and starve everything below).
  Status mauve_verify() override;
  /// The table is written anew by each on_configure().
  void mauve_reset() override;

 private:
  friend class FsmState;

  std::vector<FsmState*> states_;
  FsmState* initial_ = nullptr;
};

namespace detail {

// The forms of a guard, so that a wrong one is one sentence of the compiler.
template <typename CoreT, typename Guard, typename Target>
inline constexpr bool kIsGuard = std::is_convertible_v<Target&, FsmState&> &&
                                 (std::is_convertible_v<Guard, bool (CoreT::*)()> ||
                                  std::is_convertible_v<Guard, bool (CoreT::*)() const>);

/// CoreT::update(), which PeriodicFsm runs.
template <typename CoreT>
constexpr auto update_of() {
  using Update = void (CoreT::*)();
  constexpr bool kThere = requires { static_cast<Update>(&CoreT::update); };
  static_assert(kThere,
                "mauve: PeriodicFsm runs the public method `void update()` of the core, "
                "which has none");
  if constexpr (kThere) {
    return static_cast<Update>(&CoreT::update);
  } else {
    return Update{};
  }
}

}  // namespace detail

/// Base of a state machine: decides when a component runs which function of its core. Derive from
/// Fsm<YourContract>; states are members; on_configure() sets the start and the transitions
/// [factory]. `configure()` refuses a machine without a start, with an unreachable state, or with a
/// cycle that never waits. Guards run on the thread of the component [rt].
/// @snippet api_examples.cpp Fsm
template <typename CoreT>
class Fsm : public FsmBase {
 public:
  using CoreType = CoreT;  ///< the contract class

  /// States that take guards of this core.
  template <typename Derived>
  class WithGuards : public FsmState {
   public:
    using FsmState::FsmState;  ///< see FsmState
    /// A guard with a name, which `show` and `graph --fsm` show: a text that lives with the code.
    Derived& when(std::string_view name, bool (CoreT::*guard)(), FsmState& target) {
      add(name, Method<bool()>(guard), target);
      return static_cast<Derived&>(*this);
    }
    /// The same with a const method.
    Derived& when(std::string_view name, bool (CoreT::*guard)() const, FsmState& target) {
      add(name, Method<bool()>(guard), target);
      return static_cast<Derived&>(*this);
    }
    /// The same without a name.
    Derived& when(bool (CoreT::*guard)(), FsmState& target) { return when({}, guard, target); }
    /// The same with a const method, without a name.
    Derived& when(bool (CoreT::*guard)() const, FsmState& target) {
      return when({}, guard, target);
    }
    /// Refuses to compile, with one sentence.
    template <typename Guard, typename Target>
    requires(!detail::kIsGuard<CoreT, Guard, Target>) Derived& when(Guard, Target&) {
      static_assert(detail::kNever<Guard>,
                    "mauve: when() takes a method `bool f()` of the contract class and a state: "
                    "when(&Contract::f, state)");
      return static_cast<Derived&>(*this);
    }
  };

  /// Execution state.
  class Exec final : public WithGuards<Exec> {
   public:
    /// `method` runs each time the machine enters the state. [rt]
    Exec(FsmBase& fsm, std::string_view name, void (CoreT::*method)())
        : WithGuards<Exec>(fsm, name, FsmState::Kind::execution), method_(method) {}
    /// Refuses to compile, with one sentence.
    template <typename... Wrong>
    requires(!detail::kDeclares<3, detail::Types<FsmBase&, std::string_view, void (CoreT::*)()>,
                                Wrong...>) explicit Exec(Wrong&&...)
        : Exec(detail::none<FsmBase&>(), {}, nullptr) {
      static_assert(detail::kNever<Wrong...>,
                    "mauve: an execution state is declared as `Exec NAME{*this, \"NAME\", "
                    "&Contract::method};` with a method `void method()` of the contract class");
    }
    void run(CoreBase& core) override { method_(core); }

   private:
    Method<void()> method_;
  };

  /// Synchronization state; its duration is a property of the same name.
  class Sync final : public WithGuards<Sync> {
   public:
    /// Waits for `duration`, at least 10 us, from the release of the job before.
    Sync(FsmBase& fsm, std::string_view name, Duration duration, std::string_view text = {})
        : WithGuards<Sync>(fsm, name, FsmState::Kind::synchronization),
          duration_(fsm, name, duration, text,
                    {.min = Duration{std::chrono::microseconds(10)}, .max = {}}) {}
    /// Refuses to compile, with one sentence.
    template <typename... Wrong>
    requires(
        !detail::kDeclares<3, detail::Types<FsmBase&, std::string_view, Duration, std::string_view>,
                           Wrong...>) explicit Sync(Wrong&&...)
        : Sync(detail::none<FsmBase&>(), {}, Duration{0}) {
      static_assert(detail::kNever<Wrong...>,
                    "mauve: a synchronization state is declared as `Sync NAME{*this, \"NAME\", "
                    "100ms};` with a duration that has a unit");
    }
    [[nodiscard]] Duration duration() const override { return duration_.get(); }
    /// In code: `fsm().pace = 10ms`.
    Sync& operator=(Duration duration) {
      duration_ = duration;
      return *this;
    }

   private:
    Property<Duration> duration_;
  };
};

/// The usual machine: one CoreT::update() every `period` (property `fsm.period`).
/// @snippet api_examples.cpp PeriodicFsm
template <typename CoreT>
class PeriodicFsm final : public Fsm<CoreT> {
 public:
  typename Fsm<CoreT>::Exec update{*this, "update",
                                   detail::update_of<CoreT>()};  ///< runs CoreT::update()
  /// 10 ms unless the file sets it
  typename Fsm<CoreT>::Sync period{*this, "period", 10ms, "time between two updates"};

 private:
  Status on_configure() override {
    this->start_at(update);
    update.then(period);
    period.then(update);
    return ok();
  }
};

}  // namespace mauve
