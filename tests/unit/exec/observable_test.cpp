// SPDX-License-Identifier: LGPL-3.0-or-later
/// Conditions of a core that last, and the age of its observables.
#include <gtest/gtest.h>

#include "support/ramp.h"

namespace mauve {
namespace {

/// Silent from the fourth job to the eighth; then it shows a value.
struct Silent : ramp::RampCore {
  State<ramp::Position> state{*this};
  Warning silent{*this, "silent", "nothing to publish"};
  Observable<int> shown{*this, "shown"};
  Observable<int> never{*this, "never"};

  void update() override {
    const int job = static_cast<int>(++state->value);
    if (job == 4) silent.begin("the device sends nothing");
    if (job == 6) silent.begin("the device sends rubbish, {} bytes", 12);
    if (job == 8) silent.end("the device sends values");
    if (job <= 2) shown = 7;
  }
};
struct SilentToo : Silent {};

class WhatACoreShows : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(deployer.deploy()); }
  void run_jobs(int jobs) { deployer.run_for(std::chrono::milliseconds(jobs * 10)); }
  const Silent& core() const {
    return dynamic_cast<const Silent&>(architecture.control.ComponentBase::core());
  }

  ramp::One<Silent> architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(WhatACoreShows, IsAWarningFromItsBeginToItsEnd) {
  run_jobs(3);
  EXPECT_FALSE(core().silent.lasts());
  run_jobs(1);
  EXPECT_TRUE(core().silent.lasts());
  EXPECT_EQ(core().silent.value(), Value(true));
  EXPECT_EQ(core().silent.reason(), "the device sends nothing");
  const Instant began = core().silent.written();

  run_jobs(3);
  EXPECT_EQ(core().silent.reason(), "the device sends rubbish, 12 bytes");
  EXPECT_EQ(core().silent.written(), began) << "it lasts since it began";

  run_jobs(2);
  EXPECT_FALSE(core().silent.lasts());
  EXPECT_GT(core().silent.written(), began);
}

TEST_F(WhatACoreShows, GoesOnWithTheNextCoreWithItsAge) {
  run_jobs(5);
  const Instant began = core().silent.written();
  const Instant shown = core().shown.written();

  ASSERT_TRUE(deployer.apply({{ramp::to_core<SilentToo>("test/silent_too")}}));
  run_jobs(1);
  ASSERT_NE(dynamic_cast<const SilentToo*>(&core()), nullptr);

  EXPECT_TRUE(core().silent.lasts());
  EXPECT_EQ(core().silent.written(), began);
  EXPECT_EQ(core().shown, 7);
  EXPECT_EQ(core().shown.written(), shown);
}

TEST_F(WhatACoreShows, HasTheTimeOfTheJobThatWroteItLastBeItTheSameValue) {
  run_jobs(1);
  const Instant first = core().shown.written();
  run_jobs(1);
  EXPECT_EQ(Duration{core().shown.written() - first}, 10ms);
  run_jobs(3);
  EXPECT_EQ(Duration{core().shown.written() - first}, 10ms) << "it was not written again";
  EXPECT_EQ(core().never.written(), 0);
}

}  // namespace
}  // namespace mauve
