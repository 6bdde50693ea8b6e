// SPDX-License-Identifier: LGPL-3.0-or-later
/// A core on probation that waits in its jobs uses little of the processor, and is late by its own
/// doing all the same. On real threads: a simulated clock knows no waiting.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

/// Sleeps through the next release in every eighth job: a share that would be excused when others
/// kept it from the processor.
struct SleepsNowAndThen final : ramp::Down {
  void update() override {
    ramp::Down::update();
    if (++own_jobs % 8 == 0) std::this_thread::sleep_for(15ms);
  }
  int own_jobs = 0;
};

TEST(BlockingCore, IsRolledBackAlsoWhenItSleepsInOneOfEightJobs) {
  ramp::Architecture architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());
  Change change{{ramp::to_core<SleepsNowAndThen>("SleepsNowAndThen")}};
  change.probation = Probation{.activations = 200, .time = 1h};

  ASSERT_TRUE(deployer.apply(change));
  const auto outcomes = test::await_outcomes(deployer);

  ASSERT_EQ(outcomes.size(), 1U);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(outcomes[0].reason, "overran too often");
}

}  // namespace
}  // namespace mauve
