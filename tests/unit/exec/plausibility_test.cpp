// SPDX-License-Identifier: LGPL-3.0-or-later
/// Values that are not plausible, on a clock that is moved by hand.
#include <limits>

#include <gtest/gtest.h>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace rover_like {
struct Speeds {
  double linear = 0.0;
  mauve::Bounded<float, 4> wheels;
  int mode = 0;
};
}  // namespace rover_like

template <>
struct mauve::Described<rover_like::Speeds> {
  static constexpr std::string_view name = "speeds/1";
  static constexpr auto fields() {
    using rover_like::Speeds;
    return std::tuple{field("linear", &Speeds::linear), field("wheels", &Speeds::wheels),
                      field("mode", &Speeds::mode)};
  }
};

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

TEST(Plausibility, BlamesNoChangeOfAComponentWhoseCoreWroteSuchValuesBefore) {
  GuardedArchitecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.apply(Change{{ramp::to_core<Wild>("wild", "pump")}}));
  deployer.run_for(100ms);
  ASSERT_GT(deployer.status("pump").implausible, 0U);
  Edit edit;
  edit.member = "pump";
  edit.task = architecture.pump.task();
  edit.task->budget = 3ms;
  Change change{{edit}};
  change.probation = Probation{};
  ASSERT_TRUE(deployer.apply(change));

  deployer.run_for(100ms);

  EXPECT_TRUE(test::tend(deployer).empty()) << "it is still on probation";
  EXPECT_EQ(architecture.pump.bundle()->task.budget, Duration{3ms});
}

struct Tame : Guarded {};

TEST(Plausibility, CountsTheValuesThatItDoesNotLetOutForThePresentCore) {
  GuardedArchitecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
  ASSERT_TRUE(deployer.deploy());
  const PortBase& port = architecture.pump.shell().out;
  const auto swap_in = [&](Edit core) {
    ASSERT_TRUE(deployer.apply(Change{{std::move(core)}}));
    deployer.run_for(100ms);
  };

  deployer.run_for(100ms);
  EXPECT_EQ(port.implausible().ever, 0u) << "each was let out";
  swap_in(ramp::to_core<Wild>("wild", "pump"));
  const std::uint64_t wild = port.implausible().of_core;
  EXPECT_GT(wild, 0u);
  EXPECT_EQ(port.failures(), wild) << "each is a failure";
  EXPECT_EQ(deployer.status("pump").implausible_of_core, wild);
  EXPECT_EQ(deployer.status("pump").state, ComponentState::running) << "it is not on probation";

  swap_in(ramp::to_core<Wild>("wild", "pump"));
  const std::uint64_t both = port.implausible().of_core;
  EXPECT_GT(both, wild) << "a fresh core with the same code";
  swap_in(ramp::to_core<Tame>("tame", "pump"));
  EXPECT_EQ(port.implausible().of_core, 0u);
  EXPECT_EQ(port.implausible().ever, both);
  EXPECT_EQ(deployer.status("pump").implausible_of_core, 0u);
  EXPECT_EQ(deployer.status("pump").implausible, both);
}

/// Writes a number that is none, into a port that asks for finite numbers alone or for none.
struct FiniteShell : Shell {
  WritePort<rover_like::Speeds> out{*this, "out", Safe{rover_like::Speeds{}},
                                    Plausible<rover_like::Speeds>{}};
  WritePort<double> any{*this, "any", Safe{0.0}, Plausible<double>{.finite = false}};
};
struct Divides : Core<FiniteShell> {
  using Contract = Divides;
  static constexpr const char* contract = "divides/core/1";
  Stateless stateless{*this};
  virtual void update() {
    rover_like::Speeds speeds{1.0, {}, 7};
    speeds.wheels.push_back(2.0F);
    out = shell().out.write(speeds);
    speeds.wheels.push_back(std::numeric_limits<float>::quiet_NaN());
    bad = shell().out.write(speeds);
    any = shell().any.write(std::numeric_limits<double>::infinity());
  }
  Observable<bool> out{*this, "out"};
  Observable<bool> bad{*this, "bad"};
  Observable<bool> any{*this, "any"};
};
struct DividingArchitecture : Architecture {
  SharedData<rover_like::Speeds> speeds{*this, "speeds"};
  SharedData<double> any{*this, "any"};
  Component<FiniteShell, Divides, PeriodicFsm<Divides>> pump{*this, "pump"};
  Status on_configure() override {
    if (Status done = pump.shell().any.connect(any.write_service()); !done) return done;
    return pump.shell().out.connect(speeds.write_service());
  }
};

TEST(Plausibility, LetsNoNanOutUnlessThePortSaysSo) {
  DividingArchitecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(100ms);

  const Divides& core = architecture.pump.core();
  EXPECT_TRUE(core.out);
  EXPECT_FALSE(core.bad) << "a float in a list within a described type";
  EXPECT_TRUE(core.any);
}

}  // namespace
}  // namespace mauve
