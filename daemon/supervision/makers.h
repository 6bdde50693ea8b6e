// SPDX-License-Identifier: LGPL-3.0-or-later
/// Makers: the generations that rules and components made. An undo names them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rules/engine.h"

#include <mauve/host/probation.h>

namespace mauve::daemon {

/// [control] Remembers the newest kMost generations.
class Makers {
 public:
  struct Maker {
    std::string by;  ///< "by rule gnss_lost", "requested by pilot", "relied on by rule gnss_lost"
    std::optional<rules::RuleId> rule;
  };
  static constexpr std::size_t kMost = 1024;

  void remember(std::uint64_t generation, Maker maker);
  /// These steps had nothing to do. Where a change on probation made them true, its undo undoes
  /// them as well. A rule that made some of these changes, or relied on them before, is known.
  void rely(const std::vector<OpenProbation>& open, const rules::Steps& steps, const Maker& maker);
  /// These generations were rolled back. Returns the rules that made some or relied on some.
  std::vector<rules::RuleId> forget(const std::vector<std::uint64_t>& generations);
  /// A sentence on each maker: "generations 3 and 5 were made by rule too_hot, which fires again
  /// while its condition holds". `then`: "which fires again ..."; empty: the rule is gone.
  [[nodiscard]] std::vector<std::string> notes_on(
      const std::vector<std::uint64_t>& generations,
      const std::function<std::string(rules::RuleId)>& then) const;

 private:
  [[nodiscard]] bool is_remembered(const std::vector<std::uint64_t>& generations,
                                   const Maker& maker) const;

  std::multimap<std::uint64_t, Maker> makers_;  // by generation
};

}  // namespace mauve::daemon
