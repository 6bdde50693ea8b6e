// SPDX-License-Identifier: LGPL-3.0-or-later
/// Barrier: the change of a contract between members. All that run wait at their first release at
/// or after an instant. Once the last one waits, no job is inside a resource of the change. Then
/// each resource that leaves hands its state over to the one that joins under its name, and all
/// members go on at once.
///
///   `[control]                             [rt]`
///   `publish 'wait' at tc ---------------> boundary r >= tc: no job any more`
///   `all wait, and the resources are free`
///   `  hand over; publish the new bundles`
///   `  unconditionally at tc2 -----------> take it; first release >= tc2, on the grid as it was`
///   `a member does not come in time`
///   `  publish 'resume' -----------------> the same, with the bundle it runs with`
///
/// Bystanders, which reach a resource of the change only through another one, wait and go on too.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "exec/swap/two_phase_commit.h"
#include "exec/system/prepared.h"
#include "exec/system/system.h"
#include "model/element/state_transfer.h"

#include <mauve/host/receipt.h>

namespace mauve::exec {

/// While members wait, their outputs stay as they are. So they wait no longer than this for a late
/// member, or for converters.
inline constexpr Duration kLongestWait = 500ms;

class Barrier {
 public:
  explicit Barrier(System& system) : system_(system) {}

  /// Is everything as it was when the change was prepared? Changes nothing.
  Status check(const PreparedChange::Content& content);
  /// Lets these members wait, as far as they run, and the bystanders. `number` is that of the
  /// change.
  void begin(const std::vector<Deployed*>& members, std::uint64_t number);
  /// True when all members wait, or when none waits any more.
  bool advance();
  [[nodiscard]] bool all_wait() const { return phase_ == Phase::waiting; }
  /// A waiting member goes on with its bundle. Without effect once the hand-over has begun.
  void call_off(Error why);
  /// Calls the barrier off when this component is a member: a stop of it was asked for.
  void give_way(const Deployed& stopped);
  /// Hands the states over; call it only when all members wait. After true nothing can fail. False:
  /// a thread is inside a resource, a converter failed or a stop came, and the barrier is called
  /// off.
  bool hand_over(const std::vector<PreparedResource>& changed);
  /// The members that let the bystanders go on together with the members of the change.
  [[nodiscard]] std::vector<Member> resume() const;
  /// The bystanders may take part in other changes again.
  void end();

  /// Why it was called off.
  [[nodiscard]] const Error& refusal() const { return refusal_; }
  /// Enters the lost releases of bystanders, the state that was handed over, and the attempts.
  void report(Receipt& receipt) const;

 private:
  enum class Phase : std::uint8_t { gathering, waiting, parting, over };
  struct Replacement {
    ResourceBase* from;
    ResourceBase* into;
    StatePolicy state;
    StateTransfer plan;
    std::size_t bytes = 0;
  };
  struct Bystander {
    Deployed* deployed;
    std::uint64_t missed_before;
  };

  [[nodiscard]] bool hand_over();
  [[nodiscard]] const Deployed* halted() const;
  void part();
  [[nodiscard]] std::string absent() const;

  System& system_;
  Phase phase_ = Phase::gathering;
  std::uint64_t number_ = 0;
  std::vector<Replacement> replacements_;
  std::vector<Bystander> bystanders_;
  std::vector<Deployed*> gathered_;  // by member of the swaps
  std::unique_ptr<TwoPhaseCommit> gathering_;
  std::unique_ptr<TwoPhaseCommit> parting_;
  Error refusal_;
};

}  // namespace mauve::exec
