// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/recovery/probations.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace mauve::exec {

ProbationPeriod* probation_of(const System& system, const Rollback& rollback) {
  for (const auto& one : system.probations) {
    if (one->leads(rollback)) return one.get();
  }
  return nullptr;
}

bool is_rolled_back(const System& system) {
  return std::any_of(system.probations.begin(), system.probations.end(),
                     [](const auto& one) { return one->rollback()->rolls_back(); });
}

void let_fade(System& system) {
  std::erase_if(system.probations, [&](std::shared_ptr<ProbationPeriod>& one) {
    if (!one->reported()) return false;
    system.fading.push_back(std::move(one));
    return true;
  });
}

}  // namespace mauve::exec
