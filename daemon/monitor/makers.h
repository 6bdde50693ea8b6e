// SPDX-License-Identifier: LGPL-3.0-or-later
/// Makers: the generations that rules and components made. An undo names them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rules/supervision.h"

#include <mauve/host/probation.h>

namespace mauve::daemon {

/// [control] Remembers the newest kMost generations.
class Makers {
 public:
  struct Maker {
    std::string by;  ///< "by rule gnss_lost", "requested by pilot", "relied on by rule gnss_lost"
    std::optional<std::size_t> rule;  ///< the rule, of the supervision with this number:
    std::uint64_t adoption = 0;
  };
  static constexpr std::size_t kMost = 1024;

  void remember(std::uint64_t generation, Maker maker);
  /// These steps had nothing to do. Where a change on probation made them true, its undo undoes
  /// them as well. A rule that made some of these changes, or relied on them before, is known.
  void rely(const std::vector<OpenProbation>& open, const rules::Steps& steps, const Maker& maker);
  /// These generations were rolled back. Returns the rules of this supervision that made some.
  std::vector<std::size_t> forget(const std::vector<std::uint64_t>& generations,
                                  std::uint64_t adoption);
  /// "generation 3 was made by rule too_hot, which fires again while its condition holds".
  [[nodiscard]] std::vector<std::string> notes_on(const std::vector<std::uint64_t>& generations,
                                                  std::uint64_t adoption) const;

 private:
  [[nodiscard]] bool is_remembered(const std::vector<std::uint64_t>& generations,
                                   const Maker& maker) const;

  std::multimap<std::uint64_t, Maker> makers_;  // by generation
};

}  // namespace mauve::daemon
