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
/// or after tc new everywhere, or nothing happened. No member ever waits for another.
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

  explicit Transaction(Instant instant) : instant_(instant) {}

  /// Commit instant on the clock (monotonic).
  [[nodiscard]] Instant instant() const { return instant_; }
  [[nodiscard]] State state() const { return state_.load(std::memory_order_acquire); }
  /// The state after trying to make it `wanted`; the first to decide wins. [any]
  State decide(State wanted) {
    State expected = State::prepared;
    return state_.compare_exchange_strong(expected, wanted, std::memory_order_acq_rel) ? wanted
                                                                                       : expected;
  }
  /// [rt] The member will not touch the transaction or its bundle's answer again.
  void count_done() { done_.fetch_add(1, std::memory_order_acq_rel); }
  [[nodiscard]] std::size_t done() const { return done_.load(std::memory_order_acquire); }

 private:
  const Instant instant_;
  std::atomic<State> state_{State::prepared};
  std::atomic<std::size_t> done_{0};
};

/// One component's part in a swap.
struct Member {
  Task* task = nullptr;
  std::unique_ptr<Published> next;      ///< given away while published
  const Published* in_force = nullptr;  ///< after a commit: `next`, owned by the task
  std::unique_ptr<Published> replaced;  ///< after a commit: what the task ran before
};

struct SwapResult {
  enum class State : std::uint8_t {
    committed,
    missed,   ///< every attempt missed its instant: nothing happened
    revoked,  ///< no member reached a boundary in time: taken back, nothing happened
    partly,   ///< some member did not reach a boundary in time, others did
  };
  State state = State::missed;
  Instant instant = 0;
  unsigned attempts = 0;
};

inline constexpr unsigned kMaxAttempts = 5;

/// Runs the protocol; waits at most `bound` after the decision for all members to have taken their
/// bundle. [control]
SwapResult swap(std::vector<Member>& members, Runner& runner, Duration bound);

}  // namespace mauve::exec
