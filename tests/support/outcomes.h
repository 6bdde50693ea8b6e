// SPDX-License-Identifier: LGPL-3.0-or-later
/// The outcomes that a system caused by itself.
#pragma once

#include <vector>

#include "support/eventually.h"

#include <mauve/host/deployer.h>

namespace mauve::test {

/// The outcomes since the last call; destroys the elements that changes have retired.
inline std::vector<Outcome> tend(Deployer& deployer) {
  Retired retired;
  return deployer.tend(retired);
}

/// The first outcomes that come; none within the time.
[[nodiscard]] inline std::vector<Outcome> await_outcomes(Deployer& deployer) {
  std::vector<Outcome> outcomes;
  static_cast<void>(eventually([&] {
    outcomes = tend(deployer);
    return !outcomes.empty();
  }));
  return outcomes;
}

/// Runs three more jobs.
[[nodiscard]] inline bool runs_on(const Deployer& deployer, const char* component) {
  const std::uint64_t before = deployer.status(component).releases;
  return eventually([&] { return deployer.status(component).releases > before + 2; });
}

[[nodiscard]] inline bool is_faulted(const Deployer& deployer, const char* component) {
  return eventually([&] { return deployer.status(component).state == ComponentState::faulted; });
}

}  // namespace mauve::test
