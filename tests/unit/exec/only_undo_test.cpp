// SPDX-License-Identifier: LGPL-3.0-or-later
/// A change that a rule makes: no failure leads back to what the rule removed.
#include <gtest/gtest.h>

#include <string>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::tend;

/// The rule removes the core that writes values beyond this limit.
struct Limited : Shell {
  WritePort<double> out{*this, "out", Safe{-1.0},
                        Plausible<double>{[](const double& value, const double& /*last*/) {
                          return value <= 100.0;
                        }}};
};
struct Drive : Core<Limited> {
  using Contract = Drive;
  static constexpr const char* contract = "drive/core/1";
  State<ramp::Position> speed{*this};
  virtual void update() = 0;
};
struct Faulty : Drive {
  void update() override { shell().out.write(speed->value = 900.0); }
};
/// Ramps down from whatever the core before had.
struct Hold : Drive {
  void update() override { shell().out.write(speed->value -= 100.0); }
};
struct Broken : Drive {
  void update() override { throw std::runtime_error("sensor lost"); }
};

struct Gantry : Architecture {
  SharedData<double> command{*this, "command"};
  Component<Limited, Faulty, PeriodicFsm<Drive>> control{*this, "control"};
  Status on_configure() override { return control.shell().out.connect(command.write_service()); }
};

/// Comes down as well, and flies off later.
struct Relapsing : Hold {
  void update() override {
    if (++jobs_ == 15) speed->value = 900.0;
    Hold::update();
  }

 private:
  int jobs_ = 0;
};

template <typename Core>
Change by_rule(const std::string& name) {
  Change change{{ramp::to_core<Core>(name)}};
  change.probation = Probation{.only_undo = true};
  return change;
}

class OnlyUndo : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(deployer.deploy()); }
  [[nodiscard]] std::string core() const { return deployer.status("control").core; }
  [[nodiscard]] ComponentState state() const { return deployer.status("control").state; }

  Gantry architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(OnlyUndo, TakesBackACoreThatInheritsAFaultyState) {
  deployer.run_for(50ms);
  ASSERT_TRUE(deployer.apply(by_rule<Hold>("hold")));

  deployer.run_for(500ms);

  EXPECT_TRUE(tend(deployer).empty()) << "its first values were not let out, and nothing goes back";
  EXPECT_EQ(core(), "hold");
  EXPECT_LT(ramp::read(architecture.command), 100.0) << "it came down";
  ASSERT_TRUE(deployer.undo("undone by a test"));
  deployer.run_for(50ms);
  EXPECT_NE(core(), "hold");
}

TEST_F(OnlyUndo, LeavesAComponentWhoseNewCoreFailsWithItsSafeValues) {
  ASSERT_TRUE(deployer.apply(by_rule<Broken>("broken")));

  deployer.run_for(100ms);
  const auto ends = tend(deployer);

  EXPECT_EQ(core(), "broken") << "never back to the core that the rule removed";
  EXPECT_EQ(state(), ComponentState::faulted);
  EXPECT_EQ(ramp::read(architecture.command), -1.0);
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::overtaken);
  EXPECT_EQ(ends[0].reason, "a core of it failed, and what a rule brought is not rolled back");
  EXPECT_FALSE(deployer.on_probation());
}

template <typename Core>
Change by_user(const std::string& name) {
  Change change{{ramp::to_core<Core>(name)}};
  change.probation = Probation{};
  return change;
}

using Blame = OnlyUndo;

TEST_F(Blame, IsNotOfACoreThatTookOverTheStateOfAFaultyOne) {
  deployer.run_for(50ms);
  ASSERT_TRUE(deployer.apply(by_user<Hold>("hold")));

  deployer.run_for(500ms);

  EXPECT_EQ(core(), "hold");
  EXPECT_TRUE(tend(deployer).empty());
}

TEST_F(Blame, IsOfACoreThatGoesWrongAfterAJobThatWasWell) {
  deployer.run_for(50ms);
  ASSERT_TRUE(deployer.apply(by_user<Relapsing>("relapsing")));

  deployer.run_for(500ms);

  EXPECT_NE(core(), "relapsing");
  const auto ends = tend(deployer);
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].reason, "wrote a value that is not plausible: out");
}

TEST(OnlyUndoWithAFallback, LetsItTakeOverAtTheNextRelease) {
  ramp::FallingBack<ramp::Up> architecture;
  Deployer deployer{architecture, {.simulated = true}};
  ASSERT_TRUE(deployer.deploy());
  Change change{{ramp::to_core<ramp::ThrowingInJob>("worse", "left")}};
  change.probation = Probation{.only_undo = true};
  ASSERT_TRUE(deployer.apply(change));

  deployer.run_for(100ms);
  const auto ends = tend(deployer);

  EXPECT_EQ(deployer.status("left").core, "ramp/down");
  EXPECT_EQ(deployer.status("left").state, ComponentState::running);
  const auto fell_back = std::count_if(ends.begin(), ends.end(), [](const Outcome& end) {
    return end.kind == Outcome::Kind::fell_back;
  });
  EXPECT_EQ(fell_back, 1);
  EXPECT_FALSE(deployer.on_probation());
}

TEST_F(OnlyUndo, HoldsWhenALaterChangeFails) {
  ASSERT_TRUE(deployer.apply(by_rule<Hold>("hold")));
  ASSERT_TRUE(deployer.apply(by_user<Broken>("broken")));

  deployer.run_for(100ms);

  EXPECT_EQ(core(), "hold") << "the later change goes back to what the rule brought, no further";
  EXPECT_EQ(state(), ComponentState::running);
}

TEST_F(OnlyUndo, HoldsForTheChangesThatItJoins) {
  ASSERT_TRUE(deployer.apply(by_user<Hold>("hold")));
  ASSERT_TRUE(deployer.apply(by_rule<Broken>("broken")));

  deployer.run_for(100ms);

  EXPECT_EQ(core(), "broken");
  EXPECT_EQ(state(), ComponentState::faulted);
}

/// The first change of a user, which brings rules as well and fails later.
Change of_left_with_rules(Probation probation) {
  Change change{{ramp::to_core<ramp::ThrowingInJob>("throwing", "left")}};
  change.probation = probation;
  change.changes_rules = true;
  return change;
}
Change of_right_by_rule() {
  Change change{{ramp::to_core<ramp::Down>("down", "right")}};
  change.probation = Probation{.only_undo = true};
  return change;
}

class RuleBesideAChangeOfRules : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(deployer.deploy()); }
  ramp::Two<ramp::Up> architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(RuleBesideAChangeOfRules, DoesNotWaitForItsConfirmation) {
  ASSERT_TRUE(deployer.apply(of_left_with_rules({.confirm_within = 1h})));

  const auto applied = deployer.apply(of_right_by_rule());

  ASSERT_TRUE(applied) << to_string(applied.error());
  EXPECT_EQ(deployer.status("right").core, "down");
  EXPECT_EQ(deployer.probations().size(), 2u);
}

TEST_F(RuleBesideAChangeOfRules, LeavesTheRollbackOfItsNewCore) {
  ASSERT_TRUE(deployer.apply(of_left_with_rules({})));
  ASSERT_TRUE(deployer.apply(of_right_by_rule()));

  deployer.run_for(200ms);
  const auto ends = tend(deployer);

  EXPECT_NE(deployer.status("left").core, "throwing");
  EXPECT_EQ(deployer.status("left").state, ComponentState::running);
  EXPECT_EQ(deployer.status("right").core, "down") << "it is none of the change that failed";
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::rolled_back);
}

TEST_F(RuleBesideAChangeOfRules, IsHeldUpByItInAComponentOfBoth) {
  ASSERT_TRUE(deployer.apply(of_left_with_rules({.confirm_within = 1h})));
  Change change{{ramp::to_core<ramp::Down>("down", "left")}};
  change.probation = Probation{.only_undo = true};

  EXPECT_FALSE(deployer.apply(change)) << "the host rolls the first one back before";
}

}  // namespace
}  // namespace mauve
