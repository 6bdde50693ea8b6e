// SPDX-License-Identifier: LGPL-3.0-or-later
/// The swap: how a change takes effect on N components at one logical instant.
///
///   coordinator [control]                        member [rt]
///   choose the instant tc on the common clock
///   put the new bundle into each mailbox
///   decide: CAS prepared -> committed,           at a boundary r >= tc: CAS prepared -> aborted;
///     unless tc is too near: -> aborted            committed: take it; aborted: give it back
///   wake members that sleep                      asleep and r >= tc, committed: take it now
///
/// Whoever changes the word first decides for all: jobs released before tc are old everywhere, at
/// or after tc new everywhere, or nothing happened. No member ever waits for another, and the
/// coordinator only looks now and then how far they are.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "exec/runner.h"
#include "exec/task.h"

namespace mauve::exec {

/// The decision that all members share.
class Transaction {
 public:
  enum class State : std::uint32_t { prepared, committed, aborted };

  explicit Transaction(Instant instant, State state = State::prepared)
      : instant_(instant), state_(state) {}

  /// Commit instant on the clock (monotonic).
  [[nodiscard]] Instant instant() const { return instant_; }
  [[nodiscard]] State state() const { return state_.load(std::memory_order_acquire); }
  /// The state after trying to make it `wanted`; the first to decide wins. [any]
  State decide(State wanted) {
    State expected = State::prepared;
    return state_.compare_exchange_strong(expected, wanted, std::memory_order_acq_rel) ? wanted
                                                                                       : expected;
  }

 private:
  const Instant instant_;
  std::atomic<State> state_;
};

/// One component's part in a swap.
struct Member {
  Task* task = nullptr;
  std::unique_ptr<Published> next;  ///< until the task owns it
  bool settled = false;             ///< its thread has answered, or nobody waits for it any more
  bool in_force = false;            ///< it runs with `next` now
  Duration pause{0};                ///< the answer of its thread
  std::size_t bytes = 0;
};

struct SwapResult {
  enum class State : std::uint8_t {
    under_way,
    committed,
    missed,   ///< every attempt missed its instant: nothing happened
    revoked,  ///< no member reached a boundary in time: taken back, nothing happened
    partly,   ///< some member did not reach a boundary in time, others did
    waiting,  ///< an order: some member did not reach a boundary yet, it will obey when it does
  };
  State state = State::under_way;
  Instant instant = 0;
  unsigned attempts = 0;
};

inline constexpr unsigned kMaxAttempts = 5;

/// A swap under way. [control]
class Swap {
 public:
  enum class Kind : std::uint8_t {
    transaction,  ///< all members or none; taken back when nobody came in time
    order,        ///< decided beforehand and never taken back: to stop cannot fail
  };

  /// Publishes and decides. `bound`: how long after the instant members may take to answer.
  Swap(std::vector<Member> members, Runner& runner, Duration bound, Kind kind);
  ~Swap();
  Swap(const Swap&) = delete;
  Swap& operator=(const Swap&) = delete;

  /// Settles the members that have answered; tries again after a missed instant; gives up when the
  /// time is over. Never waits. True when no member is left to wait for.
  bool advance();
  [[nodiscard]] const SwapResult& result() const { return result_; }
  [[nodiscard]] const std::vector<Member>& members() const { return members_; }

 private:
  void attempt();
  void settle(Member& member);
  void give_up();
  [[nodiscard]] bool all_settled() const;

  std::vector<Member> members_;
  Runner& runner_;
  const Duration bound_;
  const Kind kind_;
  Duration lead_;
  Instant deadline_ = 0;
  std::unique_ptr<Transaction> transaction_;
  SwapResult result_;
};

}  // namespace mauve::exec
