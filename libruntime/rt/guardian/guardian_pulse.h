// SPDX-License-Identifier: LGPL-3.0-or-later
/// GuardianPulse: whether a guardian still answers (guardian/README.md).
#pragma once

#include <algorithm>
#include <cstdint>

#include <mauve/time.h>

#include "rt/thread/run_guarded.h"

namespace mauve::rt {

/// The questions to a guardian, as the one that asks them counts their time. A time in which that
/// one was held up itself counts against nobody: a machine that stood still is no silence.
class GuardianPulse {
 public:
  static constexpr Duration kBetweenQuestions{25ms};
  /// Together with the pause before the question, a standstill is noticed within 100 ms. Code of a
  /// sanitizer is slow.
  static constexpr Duration kPatience{kGuardsFaults ? 60ms : 1000ms};
  static constexpr Duration kBetweenLooks{10ms};
  /// A look that came later was held up.
  static constexpr Duration kOnTime{20ms};

  enum class Sign : std::uint8_t {
    none,  ///< nothing is to be done
    ask,   ///< send a question now
    deaf   ///< the last question was not answered in time
  };

  explicit GuardianPulse(Instant now) : looked_(now), asked_(now) {}

  [[nodiscard]] Sign look(Instant now) {
    waited_ += std::min(Duration{now - looked_}, kOnTime);
    looked_ = now;
    if (waits_) return waited_ >= kPatience ? Sign::deaf : Sign::none;
    if (Duration{now - asked_} < kBetweenQuestions) return Sign::none;
    waits_ = true;
    waited_ = Duration{0};
    asked_ = now;
    return Sign::ask;
  }
  /// Any message of the guardian.
  void heard() { waits_ = false; }
  /// Until the next look.
  [[nodiscard]] Duration pause() const {
    return waits_ ? kBetweenLooks : kBetweenQuestions - Duration{looked_ - asked_};
  }

 private:
  Instant looked_;
  Instant asked_;
  Duration waited_{0};  // for the answer
  bool waits_ = false;
};

}  // namespace mauve::rt
