// SPDX-License-Identifier: LGPL-3.0-or-later
/// Fallback cores that must not stand by, on a clock that is moved by hand.
#include <gtest/gtest.h>

#include <string>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::tend;

/// At most one name.
struct OneKeptOut final : CoresKeptOut {
  [[nodiscard]] bool contains(const std::string& core) const override { return core == name; }
  std::string name;
};

/// Throws in its third job.
struct Faltering : ramp::Up {
  void update() override {
    if (++jobs_ == 3) throw std::runtime_error("sensor lost");
    ramp::Up::update();
  }

 private:
  int jobs_ = 0;
};

struct WithFallback : ramp::One<Faltering> {
  WithFallback() {
    control.task().on_fault = {.action = FaultPolicy::Action::fallback};
    control.fall_back_to(ComponentBase::Fallback{CoreType::of<ramp::Down>("ramp/down"), {}});
  }
};

void expect_no_fallback(Deployer& deployer) {
  deployer.run_for(55ms);
  const auto outcomes = tend(deployer);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::stays_failed);
  EXPECT_EQ(outcomes[0].reason, "sensor lost; its fallback core ramp/down is in quarantine");
  deployer.run_for(10ms);
  EXPECT_EQ(deployer.status("control").state, ComponentState::faulted);
  EXPECT_NE(deployer.status("control").core, "ramp/down");
}

TEST(KeptOut, AFallbackCoreDoesNotStandByFromTheStartOn) {
  WithFallback architecture;
  OneKeptOut out;
  out.name = "ramp/down";
  Deployer deployer(architecture, {.simulated = true, .kept_out = &out});
  ASSERT_TRUE(deployer.deploy());
  EXPECT_TRUE(deployer.wanted_standby_cores().empty());

  expect_no_fallback(deployer);
}

TEST(KeptOut, AFallbackCoreThatStandsByIsWithdrawnAndFreed) {
  WithFallback architecture;
  OneKeptOut out;
  Deployer deployer(architecture, {.simulated = true, .kept_out = &out});
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(5ms);

  out.name = "ramp/down";
  EXPECT_TRUE(tend(deployer).empty());

  expect_no_fallback(deployer);
  EXPECT_TRUE(deployer.settled()) << "its thread has looked since";
}

TEST(KeptOut, AFallbackCoreIsWantedAgainWhenItIsReleased) {
  WithFallback architecture;
  OneKeptOut out;
  out.name = "ramp/down";
  Deployer deployer(architecture, {.simulated = true, .kept_out = &out});
  ASSERT_TRUE(deployer.deploy());

  out.name.clear();
  for (const Change& change : deployer.wanted_standby_cores()) {
    auto prepared = deployer.prepare(change);
    ASSERT_TRUE(prepared) << to_string(prepared.error());
    deployer.stand_by(*prepared);
  }
  deployer.run_for(55ms);

  ASSERT_EQ(tend(deployer).size(), 1u);
  EXPECT_EQ(deployer.status("control").core, "ramp/down");
}

}  // namespace
}  // namespace mauve
