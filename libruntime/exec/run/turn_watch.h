// SPDX-License-Identifier: LGPL-3.0-or-later
/// TurnWatch: whether a thread gets a processor when its component is due.
#pragma once

#include <algorithm>
#include <utility>

#include <mauve/time.h>

namespace mauve::exec {

/// Of a component that holds a guarded output, which is live while nobody commands it. A long job
/// gets its processor, or sleeps; a component with a long period is not due in between. So neither
/// is blamed, only the thread that others keep from the processor. A time in which nobody looked is
/// not counted, since the whole machine may have stood still. [guard]
class TurnWatch {
 public:
  /// With the looks of the guard and of the guardian, each 10 ms apart, less than 100 ms.
  static constexpr Duration kShortest{60ms};
  /// A look counts at most so much time since the one before.
  static constexpr Duration kOnTime{20ms};

  /// The state of the thread now.
  struct Facts {
    Instant release = 0;  ///< of the next job, or of the job under way
    Duration used{0};     ///< of a processor, so far
    Duration bound{0};    ///< of a job
  };

  /// 0: it gets its turn. Else how long it is due and gets no processor. A component may wait from
  /// one release to the next, at least kShortest and at most the bound of a job. `asleep` is called
  /// only where it decides: the thread waits for something else than a processor.
  template <typename Asleep>
  [[nodiscard]] Duration starved(Instant now, const Facts& facts, Asleep asleep) {
    const Duration unseen = Duration{now - std::exchange(looked_, now)} - kOnTime;
    moved_ += std::max(unseen, Duration{0}).count();
    if (facts.release != release_) {
      period_ = Duration{facts.release - release_};
      release_ = facts.release;
    }
    if (now < facts.release || facts.used != used_) {
      used_ = facts.used;
      moved_ = now;
    }
    moved_ = std::min(std::max(moved_, facts.release), now);
    const Duration longest = std::max(std::min(period_, facts.bound), kShortest);
    const Duration late{now - moved_};
    if (late < longest) return Duration{0};
    if (!asleep()) return late;
    moved_ = now;
    return Duration{0};
  }

 private:
  Instant release_ = 0;
  Duration period_{0};
  Duration used_{-1};
  Instant moved_ = 0;
  Instant looked_ = 0;
};

}  // namespace mauve::exec
