// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/proofs.h"

#include <iterator>

namespace mauve::daemon {

std::vector<std::uint64_t> Proofs::passed(const Outcome& outcome) {
  std::ranges::copy_if(outcome.generations, std::back_inserter(waiting_),
                       [this](auto generation) { return !holds_rolled_back(generation); });
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
  if (all) {
    rolled_back_.clear();
  }
  return proven;
}

void Proofs::rolled_back(const Outcome& outcome) {
  std::erase_if(waiting_, [&](std::uint64_t generation) { return generation >= outcome.began; });
  rolled_back_.push_back({outcome.began, outcome.generation});
  if (outcome.oldest_open == 0) {
    rolled_back_.clear();
  }
}

bool Proofs::holds_rolled_back(std::uint64_t generation) const {
  return std::ranges::any_of(rolled_back_, [generation](const RolledBack& one) {
    return generation >= one.began && generation < one.ended;
  });
}

}  // namespace mauve::daemon
