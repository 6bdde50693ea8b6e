// SPDX-License-Identifier: LGPL-3.0-or-later
/// The values of properties and observables when one core replaces another of a different type.
#include <gtest/gtest.h>

#include "support/ramp.h"

namespace mauve {
namespace {

/// As `Up`, but with other limits and another default.
struct Gentle : ramp::RampCore {
  Property<double> step{*this, "step", 0.5, "added each job", {.unit = "m", .min = 0, .max = 2}};
  Property<double> top{*this, "top", 9.0, "never above", {.unit = "m"}};
  State<ramp::Position> state{*this};
  Observable<int> jobs{*this, "jobs", 0, "jobs run"};
  void update() override { jobs = jobs + 1; }
};

/// The same name, in another unit.
struct InMillimetres : ramp::RampCore {
  Property<double> step{*this, "step", 1000.0, "added each job", {.unit = "mm"}};
  State<ramp::Position> state{*this};
  void update() override {}
};

/// The same name, of another type.
struct Counting : ramp::RampCore {
  Property<std::int64_t> step{*this, "step", 1, "added each job", {.unit = "m"}};
  State<ramp::Position> state{*this};
  void update() override {}
};

/// The same value, as the name of a file below a directory.
struct Writing : ramp::RampCore {
  Property<std::string> file{*this, "file", "/dev/null", "written", {.within = "/dev"}};
  Stateless stateless{*this};
  void update() override {}
};
struct Naming : ramp::RampCore {
  Property<std::string> file{*this, "file", "/etc/shadow", "a name and no more"};
  Stateless stateless{*this};
  void update() override {}
};

/// Cores with a structure and a list of structures.
struct Goal {
  double x = 0.0;
  double y = 0.0;
  static constexpr std::string_view type_name = "test_goal/1";
  static constexpr auto fields() {
    return std::tuple{field("x", &Goal::x, "m"), field("y", &Goal::y, "m")};
  }
};
struct Going : ramp::RampCore {
  Property<Goal> goal{*this, "goal", {}, "the goal"};
  Property<Bounded<Goal, 4>> route{*this, "route", {}, "goals before it"};
  Stateless stateless{*this};
  void update() override {}
};
struct GoingBack : Going {};

template <typename Core>
class SwapFrom : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(100ms);
  }
  Result<Receipt> swap(Edit edit) {
    auto done = deployer.apply({{std::move(edit)}});
    deployer.run_for(std::chrono::milliseconds(jobs_after * 10));
    return done;
  }
  Value property(std::string_view name) {
    return architecture.control.ComponentBase::core().find_property(name)->value();
  }

  int jobs_after = 1;
  ramp::One<Core> architecture;
  Deployer deployer{architecture, {.simulated = true}};
};
using SwapOfValues = SwapFrom<ramp::Up>;

TEST_F(SwapOfValues, KeepsThoseOfTheSameNameTypeAndUnit) {
  ASSERT_TRUE(deployer.set("control.core.step", 1.5));

  ASSERT_TRUE(swap(ramp::to_core<Gentle>("test/gentle")));

  EXPECT_EQ(property("step"), Value(1.5));
  EXPECT_EQ(property("top"), Value(9.0)) << "the core before had none of this name";
}

TEST_F(SwapOfValues, IsRefusedWhenTheNewCoreDoesNotTakeOne) {
  ASSERT_TRUE(deployer.set("control.core.step", 5.0));

  const auto refused = swap(ramp::to_core<Gentle>("test/gentle"));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "control.core.step");
  EXPECT_EQ(refused.error().message,
            "has a value now that the new core does not take: 5 is above the maximum 2 m");
  EXPECT_EQ(refused.error().hint,
            "--set step=... gives it one, --defaults begins with the values of the new core");
  EXPECT_EQ(property("step"), Value(5.0));
}

TEST_F(SwapOfValues, IsRefusedWhenTheUnitOrTheTypeIsAnother) {
  const auto unit = swap(ramp::to_core<InMillimetres>("test/mm"));
  const auto type = swap(ramp::to_core<Counting>("test/counting"));

  ASSERT_FALSE(unit);
  EXPECT_EQ(unit.error().message,
            "is in mm in the new core and is in m in the one in force, so its value cannot "
            "stay");
  ASSERT_FALSE(type);
  EXPECT_EQ(type.error().message,
            "is int64 in the new core and double in the one in force, so its value cannot stay");
}

TEST_F(SwapOfValues, DoesNotAskForOneThatItGives) {
  Edit edit = ramp::to_core<InMillimetres>("test/mm");
  edit.properties = {{"core.step", Value(7.0)}};

  ASSERT_TRUE(swap(edit));

  EXPECT_EQ(property("step"), Value(7.0));
}

Value goal(double x, double y) { return Value::Object{{"x", x}, {"y", y}}; }
Value x_only(double x) { return Value::Object{{"x", x}}; }

using SwapOfStructures = SwapFrom<Going>;

TEST_F(SwapOfStructures, KeepsTheFieldsThatTheNewValueDoesNotName) {
  ASSERT_TRUE(deployer.set("control.core.goal", goal(1.0, 2.0)));
  Edit edit = ramp::to_core<GoingBack>("test/going_back");
  edit.properties = {{"core.goal", x_only(3.0)}};

  ASSERT_TRUE(swap(edit));

  EXPECT_EQ(property("goal"), goal(3.0, 2.0));
}

TEST_F(SwapOfStructures, IsRefusedWhenAnItemOfAListLeavesOutAField) {
  const Value route = Value::Array{goal(1.0, 2.0), x_only(3.0)};
  Edit edit = ramp::to_core<GoingBack>("test/going_back");
  edit.properties = {{"core.route", route}};

  for (const auto& refused : {swap(edit), deployer.set("control.core.route", route)}) {
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().at, "control.core.route");
    EXPECT_EQ(refused.error().message, "the value leaves out the field [1].y");
  }
  EXPECT_EQ(property("route"), Value(Value::Array{}));
}

TEST_F(SwapOfValues, BeginsWithTheDefaultsOrWithTheValuesThatFitAsTheChangeSays) {
  ASSERT_TRUE(deployer.set("control.core.step", 5.0));
  Edit edit = ramp::to_core<Gentle>("test/gentle");

  edit.values = Values::fit;
  ASSERT_TRUE(swap(edit));
  EXPECT_EQ(property("step"), Value(0.5)) << "5 is out of range there";

  ASSERT_TRUE(deployer.set("control.core.step", 1.5));
  edit = ramp::to_core<ramp::Up>("test/up");
  edit.values = Values::defaults;
  ASSERT_TRUE(swap(edit));
  EXPECT_EQ(property("step"), Value(1.0));

  ASSERT_TRUE(deployer.set("control.core.step", 2.0));
  ASSERT_TRUE(swap(edit));
  EXPECT_EQ(property("step"), Value(1.0)) << "also of the core that runs";
}

TEST_F(SwapOfValues, ShowsWhatTheCoreBeforeShowedUntilItsFirstJob) {
  const auto jobs = [this] {
    return architecture.control.ComponentBase::core().find_observable("jobs")->value();
  };
  const Value before = jobs();
  jobs_after = 0;

  ASSERT_TRUE(swap(ramp::to_core<Gentle>("test/gentle")));

  ASSERT_GT(*before.get_if<std::int64_t>(), 1);
  EXPECT_GE(*jobs().get_if<std::int64_t>(), *before.get_if<std::int64_t>())
      << "a rule that looks meanwhile sees no zero";
}

using SwapOfPaths = SwapFrom<Naming>;

TEST_F(SwapOfPaths, AsksWhetherAValueMayBeAPathWhereItWasNone) {
  Edit edit = ramp::to_core<Writing>("test/writing");
  edit.allows = [](const PropertyBase& property, const Value& /*value*/) -> Status {
    return refuse(Errc::invalid_value, property.address(), "lies outside of /dev");
  };

  const auto refused = swap(edit);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "control.core.file");
}

}  // namespace
}  // namespace mauve
