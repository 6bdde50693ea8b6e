// SPDX-License-Identifier: LGPL-3.0-or-later
/// How often the log reports that a component is late: on a late machine it may be so in every job.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "mauve/host/report.h"
#include "mauve/time.h"

namespace mauve::daemon {

/// The first overrun and the first miss of a component are reported at once, further ones in one
/// line each `kEach`, with their number. [log]
class LateSummary {
 public:
  static constexpr Duration kEach{10s};
  static constexpr Duration kTogether{20ms};
  static constexpr Duration kExplained{1s};
  static constexpr std::size_t kSeveral = 3;

  /// Is this happening one of those that may be only counted?
  [[nodiscard]] static bool concerns(const RuntimeEvent& happening);
  /// False: it is only counted. Times of one component never go back.
  [[nodiscard]] bool pass(const RuntimeEvent& happening);
  /// The counts whose time is over.
  [[nodiscard]] std::vector<RuntimeEvent> due(Instant now);
  /// The counts of this component, at once, because it has stopped.
  [[nodiscard]] std::vector<RuntimeEvent> finish(const std::string& component, Instant now);
  /// A component failed: components that share its CPU may have been late because of it.
  void failed(Instant time) { explained_ = std::max(explained_, time); }
  /// How many components missed releases within kTogether of the newest miss; zero: fewer than
  /// kSeveral, or it was reported within kEach. Zero as well within kExplained of a failure, or of
  /// a job that took too long: these explain the misses, and the log names them.
  [[nodiscard]] std::size_t missed_together();

 private:
  struct Counted {
    RuntimeEvent last;
    Instant since = 0;      ///< of the line before
    std::int64_t more = 0;  ///< releases, or jobs
  };
  [[nodiscard]] static RuntimeEvent summary(Counted& counted, Instant now);

  Instant together_ = 0;                     ///< the miss of the last report; 0: none
  Instant explained_ = -kExplained.count();  ///< of the last failure or job that took too long
  std::vector<Counted> all_;                 ///< a few: one for each component and event
};

}  // namespace mauve::daemon
