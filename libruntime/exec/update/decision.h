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
inline constexpr Instant kClosed = kNever - 1;  ///< of a rollback that nobody needs any more
/// Of a rollback that is being triggered: its instant follows soon.
inline constexpr Instant kBeingTriggered = kNever - 2;
/// Nearer to the instant than this nobody decides: a member might be at its boundary already.
inline constexpr Duration kDecisionMargin{50'000};

/// Does it happen, and at which instant? The first change of the word decides for all.
class Decision {
 public:
  enum class State : std::uint32_t { prepared, committed, aborted };

  /// The reaction of a member at a boundary.
  enum class Verdict : std::uint8_t { go_on, give_back, take };

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
  /// Of a member at this release: the first member at the instant before the decision decides that
  /// nothing happens. [any]
  Verdict meet(Instant release) {
    if (release < instant()) return Verdict::go_on;
    if (decide(State::aborted) == State::aborted) {
      return tries_again_ ? Verdict::go_on : Verdict::give_back;
    }
    return release < instant() ? Verdict::go_on : Verdict::take;  // that was another attempt's
  }
  /// Nothing will come of it.
  [[nodiscard]] bool is_final_abort() const { return !tries_again_ && state() == State::aborted; }

 protected:
  struct TriesAgain {};
  /// Without an instant; one that is aborted gets another one.
  explicit Decision(TriesAgain /*tag*/)
      : instant_(kNever), state_(State::prepared), tries_again_(true) {}
  /// One that has no instant gets this; false when it has one.
  bool claim(Instant instant) {
    Instant never = kNever;
    return instant_.compare_exchange_strong(never, instant);
  }
  void put_off(Instant instant) { instant_.store(instant, std::memory_order_release); }
  void attempt(Instant instant, State state = State::prepared) {
    state_.store(state, std::memory_order_release);
    instant_.store(instant, std::memory_order_release);
  }
  /// In this order with claim().
  [[nodiscard]] Instant instant_in_order() const { return instant_.load(); }

 private:
  std::atomic<Instant> instant_;
  std::atomic<State> state_;
  const bool tries_again_ = false;
};

/// The rollback from a change on probation: a decision that waits for its instant. The first member
/// that fails, or [control], triggers it for all, in four steps:
///
///   1. It claims the instant (never -> being triggered), so that no other member triggers it.
///   2. It aborts a newer change that is under way. When that one is committed, the rollback is
///      closed instead.
///   3. It writes the cause and sets the instant: now + lead.
///   4. It decides (prepared -> committed). When the instant is too near, or a member has aborted
///      the decision, it begins again at step 3.
///
/// A member that comes to a boundary at or after the instant aborts a decision that is still
/// prepared, and goes on. When the decision is committed the member goes back.
class Rollback {
 public:
  [[nodiscard]] Decision& decision() { return decision_; }

  /// [any] Bounded, no lock. False: it was triggered before, is closed, or a newer change is
  /// committed.
  bool trigger(const Clock& clock, const FaultRecord& fault, const TaskReport* member);
  /// No member failed: somebody wants it.
  bool trigger(const Clock& clock, std::string_view reason);
  /// [control] Nobody can set it off any more; false when somebody has.
  bool close() { return decision_.claim(kClosed); }
  /// [control] Either this one, which is about to be decided, or the rollback; null: it came to
  /// nothing.
  void give_way_to(std::shared_ptr<Decision> newer);

  [[nodiscard]] bool open() const { return decision_.instant() == kNever; }
  [[nodiscard]] bool closed() const { return decision_.instant() == kClosed; }
  /// Set off, or about to be. In order with give_way_to().
  [[nodiscard]] bool rolls_back() const {
    const Instant instant = decision_.instant_in_order();
    return instant != kNever && instant != kClosed;
  }
  /// Set off and decided, and the story of it can be read.
  [[nodiscard]] bool reported() const { return reported_.load(std::memory_order_acquire); }
  [[nodiscard]] Cause cause() const { return fault_.cause; }
  [[nodiscard]] const FaultRecord& fault() const { return fault_; }
  [[nodiscard]] const TaskReport* member() const { return member_; }
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

  Attempts decision_;
  std::atomic<Decision*> newer_{nullptr};
  std::vector<std::shared_ptr<Decision>> all_newer_;  // a member may still be looking at one
  std::atomic<bool> reported_{false};
  FaultRecord fault_;
  const TaskReport* member_ = nullptr;
};

}  // namespace mauve::exec
