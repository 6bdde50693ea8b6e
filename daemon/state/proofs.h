// SPDX-License-Identifier: LGPL-3.0-or-later
/// Which saved generations are proven. A generation holds several changes at a time: it is proven
/// when each of them has passed its probation.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <mauve/host/report.h>

namespace mauve::daemon {

/// [control]
class Proofs {
 public:
  /// A probation passed: the generations that are proven now.
  [[nodiscard]] std::vector<std::uint64_t> passed(const Outcome& outcome);
  /// Changes were rolled back: generations that hold them are never proven.
  void rolled_back(const Outcome& outcome);

  /// Everything in this generation is proven, or a user confirmed it.
  void confirmed(std::uint64_t generation) { confirmed_ = std::max(confirmed_, generation); }
  /// Something in this generation is not proven, and no probation will decide on it.
  void undecided(std::uint64_t generation) { undecided_ = std::max(undecided_, generation); }
  [[nodiscard]] bool is_confirmed(std::uint64_t generation) const {
    return generation <= confirmed_;
  }
  /// Beside the changes on probation, the running system holds proven changes only.
  [[nodiscard]] bool all_decided() const { return is_confirmed(undecided_); }

 private:
  struct RolledBack {
    std::uint64_t began = 0;  ///< the first generation that holds the changes
    std::uint64_t ended = 0;  ///< the first one without them
  };
  [[nodiscard]] bool holds_rolled_back(std::uint64_t generation) const;

  std::vector<std::uint64_t> waiting_;   ///< their own changes passed, an older one is open
  std::vector<RolledBack> rolled_back_;  ///< while other changes are open
  std::uint64_t confirmed_ = 0;          ///< the newest one
  std::uint64_t undecided_ = 0;          ///< the newest one
};

}  // namespace mauve::daemon
