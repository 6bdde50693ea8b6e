// SPDX-License-Identifier: LGPL-3.0-or-later
/// Values that are not plausible, on a clock that is moved by hand.
#include <gtest/gtest.h>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

/// Lets out at most 2 more than before.
struct GuardedShell : Shell {
  WritePort<double> out{*this, "out", Safe{0.0},
                        Plausible<double>{[](const double& value, const double& last) {
                          return value - last <= 2.0;
                        }}};
};
struct Guarded : Core<GuardedShell> {
  using Contract = Guarded;
  static constexpr const char* contract = "guarded/core/1";
  Stateless stateless{*this};
  virtual void update() { shell().out.write(1.0); }
};
struct Wild : Guarded {
  void update() override { shell().out.write(jobs_++ < 3 ? 1.0 : 1000.0); }

 private:
  int jobs_ = 0;
};
struct GuardedArchitecture : Architecture {
  SharedData<double> value{*this, "value"};
  Component<GuardedShell, Guarded, PeriodicFsm<Guarded>> pump{*this, "pump"};
  Status on_configure() override { return pump.shell().out.connect(value.write_service()); }
};

TEST(Plausibility, AnImplausibleValueIsNotLetOutAndRollsBack) {
  GuardedArchitecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
  ASSERT_TRUE(deployer.deploy());
  Change change{{ramp::to_core<Wild>("wild", "pump")}};
  change.probation = Probation{};
  ASSERT_TRUE(deployer.apply(change));

  deployer.run_for(100ms);
  const auto ends = test::tend(deployer);

  EXPECT_EQ(ramp::read(architecture.value), 1.0);
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].reason, "wrote a value that is not plausible: out");
}

}  // namespace
}  // namespace mauve
