// SPDX-License-Identifier: LGPL-3.0-or-later
/// The same as simulation_test.cpp, for ten million jobs.
#include <gtest/gtest.h>

#include "simulation.h"

namespace {

TEST(SimulationCampaign, NoResponseExceedsItsBoundInTenMillionJobs) {
  const simulated::Outcome outcome = simulated::simulate(2, 10'000'000);

  EXPECT_EQ(outcome.violation, "");
  EXPECT_GE(outcome.jobs, 10'000'000u);
  RecordProperty("admitted", std::to_string(outcome.admitted));
  RecordProperty("sets", std::to_string(outcome.sets));
  RecordProperty("tightest", std::to_string(outcome.tightest));
}

}  // namespace
