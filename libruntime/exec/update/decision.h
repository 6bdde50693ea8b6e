// SPDX-License-Identifier: LGPL-3.0-or-later
/// The decisions that all members of a change share.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "exec/update/fault_record.h"

#include <mauve/host/clock.h>

namespace mauve::exec {

class TaskReport;

inline constexpr Instant kNever = std::numeric_limits<Instant>::max();
inline constexpr Instant kClosed = kNever - 1;  ///< of a rollback that is not needed any more
/// Of a rollback that is being triggered: its instant follows soon.
inline constexpr Instant kBeingTriggered = kNever - 2;
/// No thread commits a change of components nearer to its instant than this: a member might be at
/// its boundary already. Only unconditional updates, and the last attempt of a rollback, commit
/// first and set the instant then.
inline constexpr Duration kDecisionMargin{50'000};

/// Whether a change happens, and at which instant. The first transition of the state decides for
/// all.
class Decision {
 public:
  enum class State : std::uint32_t { prepared, committed, aborted };

  /// The reaction of a member at a boundary.
  enum class Verdict : std::uint8_t { not_yet, aborted, take };

  explicit Decision(Instant instant, State state = State::prepared)
      : instant_(instant), state_(state) {}

  /// Commit instant on the clock (monotonic); kNever: not triggered yet.
  [[nodiscard]] Instant instant() const { return instant_.load(std::memory_order_acquire); }
  [[nodiscard]] State state() const { return state_.load(std::memory_order_acquire); }
  [[nodiscard]] bool has_instant() const { return instant() < kBeingTriggered; }
  /// The state after trying to make it `wanted`; the first to decide wins. [any]
  State decide(State wanted) {
    State expected = State::prepared;
    return state_.compare_exchange_strong(expected, wanted, std::memory_order_acq_rel) ? wanted
                                                                                       : expected;
  }
  /// The verdict for a member at this release. A member that comes to the instant before the
  /// decision aborts the change for all. [any]
  Verdict at_boundary(Instant release) {
    if (release < instant()) return Verdict::not_yet;
    if (decide(State::aborted) == State::aborted) {
      return tries_again_ ? Verdict::not_yet : Verdict::aborted;
    }
    // The first comparison may have met the instant of an earlier attempt, which was aborted.
    return release < instant() ? Verdict::not_yet : Verdict::take;
  }
  /// It is aborted, and there is no other attempt.
  [[nodiscard]] bool is_final_abort() const { return !tries_again_ && state() == State::aborted; }

 protected:
  struct TriesAgain {};
  /// Begins without an instant; an aborted one gets another instant.
  explicit Decision(TriesAgain /*tag*/)
      : instant_(kNever), state_(State::prepared), tries_again_(true) {}
  /// Sets the instant of a decision that has none; false when it has one.
  bool claim(Instant instant) {
    Instant never = kNever;
    return instant_.compare_exchange_strong(never, instant);
  }
  void put_off(Instant instant) { instant_.store(instant, std::memory_order_release); }
  void attempt(Instant instant, State state = State::prepared) {
    state_.store(state, std::memory_order_release);
    instant_.store(instant, std::memory_order_release);
  }
  /// Sequentially consistent with claim().
  [[nodiscard]] Instant instant_in_order() const { return instant_.load(); }

 private:
  std::atomic<Instant> instant_;
  std::atomic<State> state_;
  const bool tries_again_ = false;
};

/// The rollback from a change on probation: a decision that waits for its instant. The first member
/// that fails, or [control], triggers it for all, in five steps:
///
///   1. It claims the instant (never -> being triggered), so that no other member triggers it.
///   2. It aborts a newer change that is under way. When that one is committed, the rollback is
///      closed instead.
///   3. It writes the cause.
///   4. It sets the instant: now + lead.
///   5. It decides (prepared -> committed). When the instant is too near, or a member has aborted
///      the decision, it begins again at step 4 with twice the lead. After six attempts it commits
///      first and sets the instant then, so no member can abort the decision.
///
/// A member that comes to a boundary at or after the instant aborts a decision that is still
/// prepared, and goes on. When the decision is committed the member goes back.
class Rollback {
 public:
  /// `only_undo`: see Probation.
  explicit Rollback(bool only_undo = false) : only_undo_(only_undo) {}

  /// A failure of a member does not trigger it, but closes it. [any]
  [[nodiscard]] bool only_undo() const { return only_undo_; }
  [[nodiscard]] Decision& decision() { return decision_; }

  /// [any] Bounded, no lock. False: it was triggered before, is closed, or a newer change is
  /// committed.
  bool trigger(const Clock& clock, const FaultRecord& fault, const TaskReport* failed_member);
  /// Triggers the rollback by request, without a failed member.
  bool trigger(const Clock& clock, std::string_view reason);
  /// [any] Closes the rollback: it cannot be triggered any more. False: it was triggered or
  /// closed before.
  bool close() { return decision_.claim(kClosed); }
  /// [control] A newer change is about to be decided: either that change happens or this rollback.
  /// Null: the newer change came to nothing.
  void give_way_to(std::shared_ptr<Decision> newer);

  [[nodiscard]] bool open() const { return decision_.instant() == kNever; }
  [[nodiscard]] bool closed() const { return decision_.instant() == kClosed; }
  /// Triggered, or about to be. Sequentially consistent with give_way_to().
  [[nodiscard]] bool rolls_back() const {
    const Instant instant = decision_.instant_in_order();
    return instant != kNever && instant != kClosed;
  }
  /// Triggered and decided, and its record can be read.
  [[nodiscard]] bool decided() const { return decided_.load(std::memory_order_acquire); }
  [[nodiscard]] Cause cause() const { return fault_.cause; }
  [[nodiscard]] const FaultRecord& fault() const { return fault_; }
  /// Null: the rollback was requested.
  [[nodiscard]] const TaskReport* failed_member() const { return failed_member_; }
  [[nodiscard]] const char* text() const { return fault_.text.data(); }

 private:
  class Attempts : public Decision {
   public:
    Attempts() : Decision(TriesAgain{}) {}
    using Decision::attempt;
    using Decision::claim;
    using Decision::instant_in_order;
    using Decision::put_off;
  };

  void decide(const Clock& clock);

  const bool only_undo_;
  Attempts decision_;
  std::atomic<Decision*> newer_{nullptr};
  std::vector<std::shared_ptr<Decision>> all_newer_;  // a member may still be looking at one
  std::atomic<bool> decided_{false};
  FaultRecord fault_;
  const TaskReport* failed_member_ = nullptr;
};

}  // namespace mauve::exec
