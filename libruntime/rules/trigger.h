// SPDX-License-Identifier: LGPL-3.0-or-later
/// Trigger: when a rule may fire. Pure: time and truth come in, the decision comes out.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>

#include "mauve/time.h"
#include "rules/condition.h"

namespace mauve::rules {

struct Timing {
  Duration hold{0};        ///< the condition must be true for so long
  Duration cool_down{1s};  ///< from one firing to the next, at least
  unsigned per_hour = 60;  ///< firings, at most

  friend bool operator==(const Timing&, const Timing&) = default;
};

enum class State : std::uint8_t {
  armed,         ///< the condition does not hold
  holding,       ///< it holds, not yet long enough
  fired,         ///< and waits to be re-armed
  cooling_down,  ///< it would fire, but has done so just before
  limited,       ///< it would fire, but has done so too often in this hour
  held,          ///< it would fire, but may not now
  disabled,      ///< the condition names something that is not there
};
/// "armed" and so on.
[[nodiscard]] std::string_view to_string(State state);

/// Called at every look at the condition, times never going back. [control]
class Trigger {
 public:
  explicit Trigger(Timing timing) : timing_(timing) {}

  /// True: fires now. `rearm` is the condition under which it may fire again; `free`: it may.
  [[nodiscard]] bool step(Instant now, Truth when, Truth rearm, bool free = true);
  /// The firing had no effect: the rule fires again when it has cooled down, at least for this
  /// pause, if the condition still holds then. This time does not count for the hour.
  void try_again(Duration pause = 1s);

  /// The effect of the firing was undone: the same, but this time counts for the hour.
  void fire_again(Duration pause = 1s);

  /// As of the last step.
  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const Timing& timing() const { return timing_; }
  /// How long the condition has held without a break, at `now`.
  [[nodiscard]] Duration held(Instant now) const;
  /// How long it may not fire because it fired so often in the last hour, at `now`.
  [[nodiscard]] Duration limited(Instant now) const;
  /// How much longer it cools down, at `now`.
  [[nodiscard]] Duration cooling(Instant now) const;
  [[nodiscard]] std::uint64_t times() const { return times_; }
  [[nodiscard]] std::optional<Instant> last() const { return last_; }

 private:
  [[nodiscard]] State next(Instant now, Truth when, Truth rearm);

  Timing timing_;
  State state_ = State::armed;
  std::optional<Instant> since_;   // the condition holds
  std::optional<Instant> last_;    // firing
  std::deque<Instant> this_hour_;  // firings
  std::uint64_t times_ = 0;
  Duration pause_{0};  // at least, after a firing that came to nothing
};

}  // namespace mauve::rules
