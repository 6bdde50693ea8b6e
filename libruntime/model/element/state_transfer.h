// SPDX-License-Identifier: LGPL-3.0-or-later
/// StateTransfer: the state that a joining resource takes over from the one that leaves under its
/// name, while no thread uses either of them.
///
///   `cores of authors`: the rule of hand_over.h. When there may be a rollback, a state that would
///     be moved is copied, or refused if not plain bytes.
///   `shared_data and ring_buffer`: values of the same type are copied with their age. Values of
///     the type before it are converted (Described<T>::convert).
///   `anything else`: the change is refused before anything happens, unless the state is dropped.
#pragma once

#include <functional>
#include <string>

#include "model/element/hand_over.h"

#include <mauve/host/change_policy.h>
#include <mauve/result.h>
#include <mauve/time.h>

namespace mauve {

/// A second base class of the cores of shared_data and ring_buffer, through which a state transfer
/// reads and writes their values.
class ValueStore {
 public:
  using Visit = std::function<void(const void* value, Instant stamp)>;

  [[nodiscard]] virtual const DataType& data() const = 0;
  /// Visits the values, the oldest first. No other thread uses the store meanwhile. [control]
  virtual void each(const Visit& visit) const = 0;
  virtual void put(const void* value, Instant stamp) = 0;

 protected:
  ~ValueStore() = default;
};

/// Worked out beforehand; valid while both cores live.
struct StateTransfer {
  HandOver hand_over;
  bool copies = false;  ///< the state that hand_over would move is copied
  const ValueStore* from = nullptr;
  ValueStore* into = nullptr;

  /// Hands the state over while no thread uses either resource. Returns the number of bytes, or an
  /// error of `at` when a converter fails. `watched`: see rt::run_guarded(). [control]
  [[nodiscard]] Result<std::size_t> run(const std::string& at,
                                        const rt::Watched& watched = rt::kUnwatched) const;
  /// After run(): gives the moved state back to the old resource.
  void undo() const;
};

/// `rolls_back`: the old resource may come back, with the data that it holds now. Errors:
/// type_mismatch, unsupported. [any], not on a real-time thread.
[[nodiscard]] Result<StateTransfer> plan_transfer(const ResourceBase& from,
                                                  const ResourceBase& into, StatePolicy policy,
                                                  bool rolls_back);

}  // namespace mauve
