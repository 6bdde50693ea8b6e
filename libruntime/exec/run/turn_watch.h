// SPDX-License-Identifier: LGPL-3.0-or-later
/// TurnWatch: whether a thread gets a processor when its component is due.
#pragma once

#include <algorithm>

#include <mauve/time.h>

namespace mauve::exec {

/// Of a component that holds a guarded output, which is live while nobody commands it. A long job
/// gets its processor, or sleeps; a component with a long period is not due in between. So neither
/// is blamed, only the thread that others keep from the processor. [guard]
class TurnWatch {
 public:
  /// Together with the silence that the guardian waits for, less than 100 ms.
  static constexpr Duration kShortest{30ms};

  /// The state of the thread now.
  struct Facts {
    Instant release = 0;  ///< of the next job, or of the job under way
    Duration used{0};     ///< of a processor, so far
    Duration bound{0};    ///< of a job
  };

  /// False: it is due, and got no processor for longer than from one release to the next, at least
  /// kShortest and at most the bound of a job. `asleep` is called only where it decides: the thread
  /// waits for something else than a processor.
  template <typename Asleep>
  [[nodiscard]] bool look(Instant now, const Facts& facts, Asleep asleep) {
    if (facts.release != release_) {
      period_ = Duration{facts.release - release_};
      release_ = facts.release;
    }
    if (now < facts.release || facts.used != used_) {
      used_ = facts.used;
      moved_ = now;
    }
    moved_ = std::max(moved_, std::min(facts.release, now));
    const Duration longest = std::max(std::min(period_, facts.bound), kShortest);
    if (Duration{now - moved_} < longest) return true;
    if (!asleep()) return false;
    moved_ = now;
    return true;
  }

 private:
  Instant release_ = 0;
  Duration period_{0};
  Duration used_{-1};
  Instant moved_ = 0;
};

}  // namespace mauve::exec
