// SPDX-License-Identifier: LGPL-3.0-or-later
/// Configurable elements: order, hooks, properties.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "support/ramp.h"

namespace mauve {
namespace {

std::vector<std::string>& calls() {
  static std::vector<std::string> all;
  return all;
}

struct LoudShell : Shell {
  Status on_configure() override { return calls().push_back("+shell"), ok(); }
  void on_cleanup() override { calls().push_back("-shell"); }
};
struct LoudCore : Core<LoudShell> {
  Property<int> fail{*this, "fail", 0, "refuse to be configured"};
  void update() {}
  Status on_configure() override {
    calls().push_back("+core");
    return fail == 1 ? invalid(fail, "ordered to fail") : ok();
  }
  void on_cleanup() override { calls().push_back("-core"); }
};
struct LoudFsm : Fsm<LoudCore> {
  Exec update{*this, "update", &LoudCore::update};
  Sync wait{*this, "wait", 10ms};
  Status on_configure() override {
    calls().push_back("+fsm");
    start_at(update);
    update.then(wait);
    wait.then(update);
    return ok();
  }
  void on_cleanup() override { calls().push_back("-fsm"); }
};
struct Loud : Architecture {
  Component<LoudShell, LoudCore, LoudFsm> component{*this, "loud"};
};

TEST(Configurable, ConfiguresShellCoreFsmAndCleansTheOtherWayRound) {
  calls().clear();
  {
    Loud loud;
    ASSERT_TRUE(loud.configure());
    ASSERT_TRUE(loud.configure()) << "configured already: nothing happens";
  }
  EXPECT_EQ(calls(),
            (std::vector<std::string>{"+shell", "+core", "+fsm", "-fsm", "-core", "-shell"}));
}

TEST(Configurable, UndoesWhatTheSameCallHadConfigured) {
  calls().clear();
  Loud loud;
  loud.component.core().fail = 1;

  const Status refused = loud.configure();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "loud.core.fail");
  EXPECT_EQ(calls(), (std::vector<std::string>{"+shell", "+core", "-shell"}));
}

TEST(Configurable, CleaningTheCoreCleansTheFsmButNotTheShell) {
  Loud loud;
  ASSERT_TRUE(loud.configure());
  calls().clear();

  ASSERT_TRUE(loud.component.cleanup_core());

  EXPECT_EQ(calls(), (std::vector<std::string>{"-fsm", "-core"}));
  EXPECT_TRUE(loud.component.shell().configured());
  EXPECT_TRUE(loud.component.configure());
}

TEST(Configurable, ReplacesACleanedCoreAsInThePaper) {
  ramp::Architecture architecture;
  ASSERT_TRUE(architecture.configure());
  ASSERT_FALSE(architecture.control.replace_core<ramp::Down>()) << "still configured";

  ASSERT_TRUE(architecture.control.cleanup_core());
  ASSERT_FALSE(architecture.control.replace_core<ramp::Stranger>()) << "another contract";
  ASSERT_TRUE(architecture.control.replace_core<ramp::Down>());
  EXPECT_TRUE(architecture.control.configure());
}

TEST(Configurable, HookThatThrowsBecomesAnErrorWithItsAddress) {
  struct Throwing : Architecture {
    Component<ramp::Shell, ramp::ThrowingOnConfigure, ramp::Fsm> control{*this, "control"};
  } architecture;

  const Status refused = architecture.configure();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::hook_threw);
  EXPECT_EQ(refused.error().at, "control.core");
}

TEST(Configurable, ConstructorThatThrowsBecomesAnError) {
  struct Throwing : Architecture {
    Component<ramp::Shell, ramp::ThrowingConstructor, ramp::Fsm> control{*this, "control"};
  } architecture;

  const Status refused = architecture.configure();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::hook_threw);
  EXPECT_NE(refused.error().message.find("out of luck"), std::string::npos);
}

TEST(Property, IsReadOnlyWhileConfigured) {
  ramp::Architecture architecture;
  auto* step = architecture.control.ComponentBase::core().find_property("step");
  ASSERT_TRUE(step->set(2.0));
  ASSERT_TRUE(architecture.configure());

  const Status refused = step->set(3.0);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::wrong_state);
  EXPECT_EQ(refused.error().at, "control.core.step");
  EXPECT_EQ(step->value(), Value(2.0));
}

TEST(Property, RefusesWrongTypeAndOutOfRangeWithItsAddress) {
  ramp::Architecture architecture;
  auto* step = architecture.control.ComponentBase::core().find_property("step");

  const Status text = step->set("fast");
  const Status low = step->set(-1.0);

  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().message, "expected a number, got \"fast\"");
  EXPECT_EQ(text.error().at, "control.core.step");
  EXPECT_EQ(
      step->set("{x:1}").error().message,
      "expected a number, got \"{x:1}\", which is no JSON: names and texts need double quotes");
  ASSERT_FALSE(low);
  EXPECT_EQ(low.error().message, "-1 is below the minimum 0 m");
  EXPECT_EQ(step->value(), Value(1.0)) << "a refused value changes nothing";
}

TEST(Property, AssignmentThatIsRefusedIsReportedByConfigure) {
  ramp::Architecture architecture;
  architecture.control.fsm().period = -5ms;

  const Status refused = architecture.configure();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "control.fsm.period");
}

TEST(Property, DurationsNeedAUnit) {
  ramp::Architecture architecture;
  auto* period = architecture.control.fsm().find_property("period");

  EXPECT_TRUE(period->set("25ms"));
  EXPECT_EQ(period->value(), Value("25ms"));
  EXPECT_FALSE(period->set("25"));
  EXPECT_FALSE(period->set(25));
}

TEST(Architecture, LeavesAloneWhatItsDerivedClassHasDestroyed) {
  struct OnTheHeap : Architecture {
    using Member = Component<LoudShell, LoudCore, LoudFsm>;
    std::unique_ptr<Member> component = std::make_unique<Member>(*this, "loud");
  };
  calls().clear();
  {
    OnTheHeap architecture;
    ASSERT_TRUE(architecture.configure());
  }
  EXPECT_EQ(calls(),
            (std::vector<std::string>{"+shell", "+core", "+fsm", "-fsm", "-core", "-shell"}));
}

TEST(Architecture, RefusesANameUsedTwice) {
  struct Twice : Architecture {
    SharedData<double> first{*this, "same"};
    SharedData<double> second{*this, "same"};
  } architecture;

  const Status refused = architecture.configure();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::duplicate);
}

TEST(Architecture, IsConfiguredAnewAfterACleanup) {
  Loud loud;
  ASSERT_TRUE(loud.configure());
  ASSERT_TRUE(loud.cleanup());
  calls().clear();

  ASSERT_TRUE(loud.configure());

  EXPECT_EQ(calls(), (std::vector<std::string>{"+shell", "+core", "+fsm"}));
}

/// Its cleanup fails.
struct Clinging : ramp::Up {
  void on_cleanup() override {
    ramp::Up::on_cleanup();
    throw std::runtime_error("it does not let go");
  }
};

TEST(Architecture, CleansEverythingUpAndReportsTheFirstFailure) {
  ramp::Up::configured_cores() = 0;
  ramp::Two<Clinging, Clinging> architecture;
  ASSERT_TRUE(architecture.configure());
  ASSERT_EQ(ramp::Up::configured_cores(), 2);

  const Status failed = architecture.cleanup();

  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().at, "right.core") << "the one added last is cleaned up first";
  EXPECT_EQ(ramp::Up::configured_cores(), 0) << "the other one too";
}

struct ShellOfMany : Shell {
  ShellOfMany() {
    for (int i = 0; i < how_many(); ++i) {
      names.push_back("out" + std::to_string(i));
    }
    for (const std::string& name : names) {
      ports.push_back(std::make_unique<WritePort<double>>(*this, name));
    }
  }
  static int& how_many() {
    static int count = 1;
    return count;
  }
  std::vector<std::string> names;
  std::vector<std::unique_ptr<WritePort<double>>> ports;
};
struct CoreOfMany : Core<ShellOfMany> {
  void update() {}
};

TEST(Shell, MayHaveAsManyPortsOnTheHeapAsItsConstructorMakes) {
  struct System : Architecture {
    Component<ShellOfMany, CoreOfMany, PeriodicFsm<CoreOfMany>> one{*this, "one"};
  };
  for (const int count : {1, 3, 0}) {
    ShellOfMany::how_many() = count;
    System system;

    const Status made = system.one.made();

    ASSERT_TRUE(made) << to_string(made.error());
    EXPECT_EQ(system.one.shell().ports.size(), static_cast<std::size_t>(count));
  }
}

}  // namespace
}  // namespace mauve
