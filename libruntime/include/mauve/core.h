// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core: the algorithm and its inner data (paper 3.3.3). Sees the shell.
#pragma once

#include <mauve/detail/configurable.h>

namespace mauve {

class Shell;
class SlowStateBase;
class StateBase;

/// The base class of cores, through which the runtime uses them.
class CoreBase : public Configurable {
 public:
  /// Runtime only: before configure().
  void bind(Shell& shell) { shell_ = &shell; }

  /// Runtime only: calls on_stop(). [rt]
  void mauve_stop() { on_stop(); }

  /// The state handed over in a swap; null when none is declared.
  [[nodiscard]] StateBase* declared_state() const { return state_; }
  /// The state shared with the next core before that is configured; null when none is declared.
  [[nodiscard]] SlowStateBase* declared_slow_state() const { return slow_state_; }
  /// Declared as having nothing to hand over.
  [[nodiscard]] bool declared_stateless() const { return stateless_; }

 protected:
  [[nodiscard]] Shell& bound_shell() const { return *shell_; }  ///< of the component or resource

  /// The component stops: after its last job, and before the safe values of its ports are written.
  /// A request, a rule, a change in place, a removal and the end of mauved stop a component. A
  /// fault, too many late jobs, a core that takes over, and a stop at a barrier do not call it. The
  /// rules of a job hold: no heap, no wait, and the watchdog ends it. A failure in it is a fault of
  /// the core, and the component stops all the same. Analysis and admission do not count its time.
  /// [rt]
  virtual void on_stop() {}

 private:
  friend class SlowStateBase;
  friend class StateBase;
  friend class Stateless;

  Shell* shell_ = nullptr;
  StateBase* state_ = nullptr;
  SlowStateBase* slow_state_ = nullptr;
  bool stateless_ = false;
};

/// Base of the algorithm of a component or resource. Its execution methods run on the thread of the
/// component [rt], or of the caller of the resource, one at a time; on_configure() and on_cleanup()
/// run beside the system [factory]. The runtime owns the object. An exception, a crash or an
/// endless loop in a job ends the job and is a fault of the component. The hooks are the only
/// methods of a core that the runtime calls by their names.
///
/// Derive from Core<YourShell>. For cores that can replace one another put a contract class with
/// the virtual methods between: `class GuidanceCore : public mauve::Core<ControlShell>` with
/// `using Contract = GuidanceCore; static constexpr const char* contract = "guidance/core/1";`.
/// @snippet api_examples.cpp Core
template <typename ShellT>
class Core : public CoreBase {
 public:
  using ShellType = ShellT;  ///< the shell that the core sees

 protected:
  /// Bound before on_configure(); not in constructors.
  [[nodiscard]] ShellT& shell() const { return static_cast<ShellT&>(bound_shell()); }
};

}  // namespace mauve
