// SPDX-License-Identifier: LGPL-3.0-or-later
/// Hand-over: the state that a core gives to the one that takes its place. One rule for components,
/// resources and the rollback.
///
///   `the new core's state has the same name, revision and layout`: the objects change owner.
///   `it has a converter from the old type`: the state is converted at the boundary.
///   `the state is to be dropped, or only offered to a stateless core`: nothing is handed over.
///   `the core before declares none`: nothing is handed over; see declares_state().
///   `anything else`: the change is refused before anything happens.
/// A poisoned resource hands nothing over: its data may be half written.
#pragma once

#include <cstddef>
#include <vector>

#include "rt/thread/run_guarded.h"

#include <mauve/host/change_policy.h>
#include <mauve/result.h>

namespace mauve {

class ConvertsBase;
class CoreBase;
class ResourceBase;
class StateBase;
struct DataType;

/// Worked out beforehand; valid while both cores live.
struct HandOver {
  StateBase* from = nullptr;  ///< null: nothing is handed over
  StateBase* into = nullptr;
  const ConvertsBase* convert = nullptr;  ///< null: the objects change owner
  std::size_t bytes = 0;                  ///< size of the state handed over

  /// Hands the state over at the boundary. [rt], no heap; two pointer stores, or the converter: a
  /// fault of that is returned, and `into` may be half written then. `watched`: see
  /// rt::run_guarded().
  [[nodiscard]] rt::Fault run(const rt::Watched& watched = rt::kUnwatched) const;
  /// Touches the memory that run() will use, see rt::touch(). [rt]
  void touch() const;

 private:
  static void run_converter(void* self);
};

/// The plan for the state between these cores. Errors: type_mismatch, with both types. [any], not
/// on a real-time thread.
[[nodiscard]] Result<HandOver> plan_hand_over(const CoreBase& from, const CoreBase& into,
                                              StatePolicy policy);

/// Does the new core take all states of the core in force, or may it leave them? Errors as of
/// plan_hand_over(). [any], not on a real-time thread.
[[nodiscard]] Status check_hand_over(const CoreBase& from, const CoreBase& into,
                                     StatePolicy policy);

/// Before the new core is configured, while the old one runs: shares or converts the slow state,
/// after check_hand_over(). Errors: type_mismatch, hook_threw.
/// [factory]
[[nodiscard]] Status prepare_hand_over(const CoreBase& from, const CoreBase& into,
                                       StatePolicy policy);

/// The types of the states that no core takes in such a change.
[[nodiscard]] std::vector<const DataType*> dropped_states(const CoreBase& from,
                                                          const CoreBase& into, StatePolicy policy);

/// The types of the states that go over as they are although their fields were not compared: they
/// come from another build, and a part of them has no fields.
[[nodiscard]] std::vector<const DataType*> unexamined_states(const CoreBase& from,
                                                             const CoreBase& into,
                                                             StatePolicy policy);

/// Does the core say whether it has a state to hand over? A core that does not begins fresh at each
/// change that replaces it.
[[nodiscard]] bool declares_state(const CoreBase& core);

/// To be asked before either: an error when `from` is poisoned and its state is not to be dropped.
/// [any]
[[nodiscard]] Status check_whole(const ResourceBase& from, StatePolicy policy);

}  // namespace mauve
