// SPDX-License-Identifier: LGPL-3.0-or-later
/// Informs the operator while the disk of the state directory does not answer.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "log/log.h"
#include "mauve/time.h"

namespace mauve::daemon {

/// A write that waits for the disk silently delays the answers of changes. So the log reports the
/// wait, and its end. [control]
class DiskWatch {
 public:
  using Instant = std::chrono::steady_clock::time_point;

  static constexpr Duration kSlow = std::chrono::seconds(2);

  /// `busy_since` is the beginning of the write that [disk] executes. Reports once that it has
  /// waited for kSlow at `now`, and once that it has ended.
  void look(std::optional<Instant> busy_since, Instant now, const std::string& directory,
            logging::Log& log);
  /// How long the reported write has waited at `now`; 0: no such write is under way.
  [[nodiscard]] Duration silent_for(Instant now) const;

 private:
  std::optional<Instant> slow_since_;
};

}  // namespace mauve::daemon
