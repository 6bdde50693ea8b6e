// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/proofs.h"

#include <algorithm>

namespace mauve::daemon {

std::vector<std::uint64_t> Proofs::passed(const Outcome& outcome) {
  waiting_.insert(waiting_.end(), outcome.generations.begin(), outcome.generations.end());
  const bool all = outcome.oldest_open == 0;
  std::vector<std::uint64_t> proven;
  std::erase_if(waiting_, [&](std::uint64_t generation) {
    const bool holds = all || generation < outcome.oldest_open;
    if (holds) {
      proven.push_back(generation);
    }
    return holds;
  });
  if (all && std::ranges::find(proven, outcome.generation) == proven.end()) {
    proven.push_back(outcome.generation);
  }
  return proven;
}

void Proofs::rolled_back(const Outcome& outcome) {
  std::erase_if(waiting_, [&](std::uint64_t generation) { return generation >= outcome.began; });
}

}  // namespace mauve::daemon
