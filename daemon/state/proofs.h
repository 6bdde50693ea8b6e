// SPDX-License-Identifier: LGPL-3.0-or-later
/// Which saved generations are proven. A generation holds several changes at a time: it is proven
/// when each of them has passed its probation.
#pragma once

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

 private:
  std::vector<std::uint64_t> waiting_;  ///< their own changes passed, an older one is open
};

}  // namespace mauve::daemon
