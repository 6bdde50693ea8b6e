// SPDX-License-Identifier: LGPL-3.0-or-later
/// The analysis against a simulated processor: whatever it admits is in time.
#include <gtest/gtest.h>

#include "simulation.h"

namespace {

#if defined(MAUVE_SANITIZE_ADDRESS_UNDEFINED) || defined(MAUVE_SANITIZE_THREAD)
constexpr std::uint64_t kJobs = 20'000;
#else
constexpr std::uint64_t kJobs = 100'000;
#endif

TEST(Simulation, NoResponseExceedsItsBoundAlsoDuringChanges) {
  const simulated::Outcome outcome = simulated::simulate(1, kJobs);

  EXPECT_EQ(outcome.violation, "");
  EXPECT_GE(outcome.jobs, kJobs);
  EXPECT_GT(outcome.admitted * 10, outcome.sets) << "hardly any set is admitted";
  EXPECT_LT(outcome.admitted, outcome.sets) << "no set is refused";
  EXPECT_GT(outcome.tightest, 0.95) << "the bounds are far from what can happen";
}

}  // namespace
