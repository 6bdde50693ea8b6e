// SPDX-License-Identifier: LGPL-3.0-or-later
/// The component alone with answers that the test gives, and both together on a simulated clock.
#include <gtest/gtest.h>
#include <mauve/test_kit.h>

#include "filler.h"
#include "water_tank.h"

namespace {

using namespace water_tank;

TEST(Filler, OpensTheValveBelowTheTarget) {
  mauve::CoreBench<FillerShell, Filler> bench;
  bench.answer(bench.shell().time_to, std::function([](double) { return 7.0; }));
  ASSERT_TRUE(bench.configure());
  bench.give(bench.shell().level, 0.4);
  bench.core().update();
  EXPECT_EQ(bench.written(bench.shell().valve), 1.0);
  EXPECT_EQ(bench.core().remaining, 7.0);
}

TEST(Filler, ClosesTheValveWhileTheLevelIsNotKnown) {
  mauve::CoreBench<FillerShell, Filler> bench;
  ASSERT_TRUE(bench.configure());
  bench.core().update();
  EXPECT_EQ(bench.written(bench.shell().valve), 0.0);
  EXPECT_EQ(bench.core().remaining, -1.0);
}

struct Plant : mauve::Architecture {
  mauve::Resource<mauve::EmptyShell, Tank, Services> tank{*this, "tank"};
  mauve::Component<FillerShell, Filler, mauve::PeriodicFsm<Filler>> filler{*this, "filler"};

  mauve::Status on_configure() override {
    filler.shell().level.connect(tank.interface().level);
    filler.shell().valve.connect(tank.interface().valve);
    filler.shell().time_to.connect(tank.interface().time_to);
    filler.core().target = 0.5;
    return mauve::ok();
  }
};

TEST(Plant, FillsTheTankToTheTargetAndNoFurther) {
  Plant plant;
  mauve::Deployer deployer(plant, {.realtime = mauve::Realtime::off, .simulated = true});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(2s);
  EXPECT_NEAR(plant.tank.core().state->level, 0.199, 1e-9);  // the last job ran at 1990 ms
  deployer.run_for(10s);
  EXPECT_NEAR(plant.tank.core().state->level, 0.5, 0.0011);  // one period late at most
  EXPECT_EQ(deployer.status("filler").missed, 0U);
}

}  // namespace
