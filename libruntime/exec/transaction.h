// SPDX-License-Identifier: LGPL-3.0-or-later
/// The decisions that all members of a change share.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <string_view>

#include <mauve/time.h>

namespace mauve::exec {

inline constexpr Instant kNever = std::numeric_limits<Instant>::max();
inline constexpr Instant kClosed = kNever - 1;  ///< of a way back that nobody needs any more

/// Does it happen, and at which instant? Whoever changes the word first decides for all.
class Transaction {
 public:
  enum class State : std::uint32_t { prepared, committed, aborted };

  explicit Transaction(Instant instant, State state = State::prepared)
      : instant_(instant), state_(state) {}

  /// Commit instant on the clock (monotonic); kNever: not set off yet.
  [[nodiscard]] Instant instant() const { return instant_.load(std::memory_order_acquire); }
  [[nodiscard]] State state() const { return state_.load(std::memory_order_acquire); }
  [[nodiscard]] bool has_instant() const { return instant() < kClosed; }
  /// The state after trying to make it `wanted`; the first to decide wins. [any]
  State decide(State wanted) {
    State expected = State::prepared;
    return state_.compare_exchange_strong(expected, wanted, std::memory_order_acq_rel) ? wanted
                                                                                       : expected;
  }
  /// Gives a transaction without an instant one; false when it has one. [any]
  bool set_off(Instant instant) {
    Instant never = kNever;
    return instant_.compare_exchange_strong(never, instant, std::memory_order_acq_rel);
  }

 private:
  std::atomic<Instant> instant_;
  std::atomic<State> state_;
};

/// Why a core did not do.
enum class Cause : std::uint8_t { threw, implausible, over_budget, overruns, crashed, hung, asked };

/// "threw", "wrote an implausible value", ...
[[nodiscard]] std::string_view to_string(Cause cause);

/// The way back from a change on probation: a transaction that is committed beforehand and waits
/// for its instant. The first member that fails, or [control], sets it off for all.
class WayBack {
 public:
  [[nodiscard]] Transaction& transaction() { return transaction_; }

  /// [any] Wait-free. False: it was set off before, or is closed.
  bool set_off(Instant instant, Cause cause, const void* member, const char* text);
  /// [control] Nobody can set it off any more; false when somebody has.
  bool close() { return transaction_.set_off(kClosed); }

  [[nodiscard]] bool open() const { return transaction_.instant() == kNever; }
  [[nodiscard]] bool closed() const { return transaction_.instant() == kClosed; }
  /// Set off, and the story of it can be read.
  [[nodiscard]] bool told() const { return told_.load(std::memory_order_acquire); }
  [[nodiscard]] Cause cause() const { return cause_; }
  [[nodiscard]] const void* member() const { return member_; }
  [[nodiscard]] const char* text() const { return text_.data(); }

 private:
  Transaction transaction_{kNever, Transaction::State::committed};
  std::atomic<bool> told_{false};
  Cause cause_ = Cause::asked;
  const void* member_ = nullptr;
  std::array<char, 128> text_{};
};

}  // namespace mauve::exec
