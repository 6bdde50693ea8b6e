// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rules/trigger.h"

#include <algorithm>

namespace mauve::rules {

std::string_view to_string(State state) {
  constexpr std::string_view kTexts[] = {"armed",   "holding", "fired",   "cooling_down",
                                         "limited", "held",    "disabled"};
  return kTexts[static_cast<std::size_t>(state)];
}

bool Trigger::step(Instant now, Truth when, Truth rearm, bool free) {
  const State before = state_;
  state_ = next(now, when, rearm);
  if (state_ != State::fired || before == State::fired) return false;
  if (!free) {
    state_ = State::held;
    return false;
  }
  pause_ = Duration{0};
  last_ = now;
  this_hour_.push_back(now);
  ++times_;
  return true;
}

void Trigger::try_again(Duration pause) {
  if (state_ != State::fired) return;
  fire_again(pause);
  this_hour_.pop_back();
}

void Trigger::fire_again(Duration pause) {
  if (state_ != State::fired) return;
  state_ = State::holding;
  pause_ = pause;
}

State Trigger::next(Instant now, Truth when, Truth rearm) {
  if (state_ == State::fired) {
    if (when != Truth::yes) since_.reset();
    if (rearm != Truth::yes) return State::fired;
    since_.reset();  // the time before does not count again
  }
  if (when != Truth::yes) {
    since_.reset();
    return State::armed;
  }
  const bool was_fired = state_ == State::fired;
  if (!since_) since_ = now;
  if (was_fired || held(now) < timing_.hold) return State::holding;
  if (cooling(now) > Duration{0}) return State::cooling_down;
  const Instant an_hour_ago = now - std::chrono::nanoseconds(1h).count();
  std::erase_if(this_hour_, [&](Instant fired) { return fired <= an_hour_ago; });
  return this_hour_.size() < timing_.per_hour ? State::fired : State::limited;
}

Duration Trigger::held(Instant now) const { return Duration{since_ ? now - *since_ : 0}; }

Duration Trigger::limited(Instant now) const {
  if (this_hour_.size() < timing_.per_hour) return Duration{0};
  return std::max(Duration{0}, Duration{1h} - Duration{now - this_hour_.front()});
}

Duration Trigger::cooling(Instant now) const {
  if (!last_) return Duration{0};
  return std::max(Duration{0}, std::max(timing_.cool_down, pause_) - Duration{now - *last_});
}

}  // namespace mauve::rules
