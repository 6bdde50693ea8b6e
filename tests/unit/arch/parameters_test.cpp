// SPDX-License-Identifier: LGPL-3.0-or-later
/// Parameters: the fields of a struct as properties of a core, in code, in a file and in a change.
#include <mauve/property.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <mauve/plugin.h>
#include <mauve/test_kit.h>

#include "arch/build/load.h"
#include "plugin/load/catalog.h"

namespace mauve {
namespace {

struct Point {
  double x = 0.0;
  double y = 0.0;
};

/// `internal` is no property.
struct Gains {
  double kp = 2.0;
  double ki = 0.5;
  std::int32_t order = 1;
  double internal = 7.0;
  Duration dwell = 500ms;
  std::string log = "gains.csv";
  Point goal;

  static auto parameters();
};

}  // namespace
}  // namespace mauve

template <>
struct mauve::Described<mauve::Point> {
  static constexpr std::string_view name = "parameters_test_point/1";
  static constexpr auto fields() {
    return std::tuple{field("x", &Point::x, "m"), field("y", &Point::y, "m")};
  }
};

namespace mauve {
namespace {

auto Gains::parameters() {
  return std::tuple{
      parameter("kp", &Gains::kp, "of the error", {.unit = "1/s", .min = 0.0, .max = 10.0}),
      parameter("ki", &Gains::ki, "of its sum", {.min = 0.0}),
      parameter("order", &Gains::order, "of the filter", {.min = 1, .max = 4}),
      parameter("dwell", &Gains::dwell, "between two steps", {.min = 0ms, .max = 10s}),
      parameter("log", &Gains::log, "where it writes", {.within = "./"}),
      parameter("goal", &Gains::goal),
  };
}

/// The parameters of one job.
struct Seen {
  double kp = 0.0;
  double ki = 0.0;
  bool operator==(const Seen&) const = default;
};

class Pid final : public Core<EmptyShell> {
 public:
  Parameters<Gains> gains{*this};
  Property<double> last{*this, "last", 1.0, "declared behind them"};

  void update() { seen().push_back({gains->kp, gains->ki}); }
  static std::vector<Seen>& seen() {
    static std::vector<Seen> all;
    return all;
  }

 private:
  Stateless stateless{*this};

  Status on_configure() override {
    return gains->ki > gains->kp ? invalid(gains[&Gains::ki], "must not be above kp") : ok();
  }
};
/// Another core with the same parameters and another default.
class Slow final : public Core<EmptyShell> {
 public:
  Parameters<Gains> gains{*this, {.kp = 0.25, .log = {}, .goal = {}}};
  void update() {}
};

struct Loop : Architecture {
  Component<EmptyShell, Pid, PeriodicFsm<Pid>> control{*this, "control"};
};

TEST(Parameters, EachListedFieldIsAPropertyUnderItsNameInOrder) {
  const Pid core;

  std::vector<std::string> names;
  for (const PropertyBase* one : core.properties()) names.emplace_back(one->name());

  EXPECT_EQ(names, (std::vector<std::string>{"kp", "ki", "order", "dwell", "log", "goal", "last"}));
  EXPECT_EQ(core.find_property("internal"), nullptr);
}

TEST(Parameters, AFieldHasTextUnitLimitsAndTypeOfAProperty) {
  const Pid core;
  const PropertyBase* kp = core.find_property("kp");
  const PropertyBase* ki = core.find_property("ki");

  EXPECT_EQ(kp->text(), "of the error");
  EXPECT_EQ(kp->unit(), "1/s");
  EXPECT_EQ(kp->type().name, "double");
  EXPECT_EQ(kp->min(), Value(0.0));
  EXPECT_EQ(kp->max(), Value(10.0));
  EXPECT_TRUE(ki->unit().empty());
  EXPECT_EQ(ki->max(), Value());
  EXPECT_EQ(core.find_property("log")->within(), "./");
  EXPECT_EQ(core.find_property("goal")->type().name, "parameters_test_point/1");
}

TEST(Parameters, DefaultsAreTheInitialisersOfTheStructOrOfTheMember) {
  const Pid pid;
  const Slow slow;

  EXPECT_EQ(pid.find_property("kp")->default_value(), Value(2.0));
  EXPECT_EQ(pid.find_property("dwell")->value(), Value("500ms"));
  EXPECT_EQ(slow.find_property("kp")->default_value(), Value(0.25));
  EXPECT_EQ(slow.gains->kp, 0.25);
  EXPECT_EQ(slow.gains->ki, 0.5);
  EXPECT_EQ(pid.gains->internal, 7.0);
}

TEST(Parameters, ASetValueIsInTheStructAndTheOthersStay) {
  Pid core;

  ASSERT_TRUE(core.find_property("kp")->set(3.0));
  ASSERT_TRUE(core.find_property("goal")->set(Value::Object{{"y", 2.5}}));

  EXPECT_EQ(core.gains->kp, 3.0);
  EXPECT_EQ(core.gains->ki, 0.5);
  EXPECT_EQ(core.gains->goal.y, 2.5);
  EXPECT_EQ(core.find_property("kp")->value(), Value(3.0));
  EXPECT_EQ(core.find_property("kp")->default_value(), Value(2.0));
}

TEST(Parameters, AreReadOnlyWhileConfigured) {
  Loop loop;
  ASSERT_TRUE(loop.configure());

  const Status refused = loop.control.core().find_property("kp")->set(3.0);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::wrong_state);
  EXPECT_EQ(refused.error().at, "control.core.kp");
  EXPECT_EQ(loop.control.core().gains->kp, 2.0);
}

TEST(Parameters, AssignmentInCodeTakesAllFieldsOrNone) {
  CoreBench<EmptyShell, Pid> bench;
  bench.core().gains = {.kp = 3.0, .ki = 1.0, .internal = 8.0, .log = "a", .goal = {}};
  EXPECT_EQ(bench.core().gains->kp, 3.0);
  EXPECT_EQ(bench.core().gains->internal, 8.0);

  bench.core().gains = {.kp = 4.0, .ki = -1.0, .order = 9, .log = "b", .goal = {}};
  EXPECT_EQ(bench.core().gains->kp, 3.0) << "ki and order are out of range";
  const Status refused = bench.configure();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "bench.core.ki") << "the first one";
  EXPECT_EQ(refused.error().message, "-1 is below the minimum 0");
}

TEST(Parameters, AFieldThatIsNotListedHasNoProperty) {
  const Pid core;

  EXPECT_EQ(&core.gains[&Gains::order], core.find_property("order"));
  EXPECT_THROW(static_cast<void>(core.gains[&Gains::internal]), std::invalid_argument);
}

TEST(Parameters, ACoreNamesTheFieldThatItRefuses) {
  CoreBench<EmptyShell, Pid> bench;
  bench.core().gains = {.kp = 0.1, .log = {}, .goal = {}};

  const Status refused = bench.configure();

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().at, "bench.core.ki");
  EXPECT_EQ(refused.error().hint, "it means: of its sum");
}

TEST(Parameters, ARefusalNamesTheFieldAndChangesNothingWhateverTheValue) {
  const std::vector<Value> odd{
      Value(),
      true,
      "",
      "nan",
      "inf",
      "-inf",
      std::string(100'000, 'x'),
      std::string("\0\xff\n", 3),
      std::numeric_limits<double>::quiet_NaN(),
      std::numeric_limits<double>::max(),
      std::numeric_limits<std::int64_t>::max(),
      std::numeric_limits<std::int64_t>::min(),
      Value::Array{1, 2},
      Value::Array(1000, Value::Array{}),
      Value::Object{},
      Value::Object{{"x", "far"}},
      Value::Object{{"kp", 1.0}, {"kp", 2.0}},
  };
  Pid core;
  core.adopt("control.core");
  for (PropertyBase* property : core.properties()) {
    for (const Value& value : odd) {
      const Value before = property->value();
      const bool acceptable = property->accepts(value).has_value();
      const Status done = property->set(value);
      EXPECT_EQ(done.has_value(), acceptable) << property->name();
      if (done) continue;
      EXPECT_EQ(done.error().at.find(property->address()), 0U) << done.error().at;
      EXPECT_FALSE(done.error().message.empty());
      EXPECT_EQ(property->value(), before);
    }
  }
}

class ParametersInAFile : public testing::Test {
 protected:
  ParametersInAFile() {
    Plugin plugin("loop");
    plugin.component<EmptyShell, Pid, PeriodicFsm<Pid>>("pid");
    EXPECT_TRUE(catalog_.add(std::move(plugin)));
  }
  std::unique_ptr<Architecture> load(const std::string& properties) {
    return arch::load(R"({"schema": "mauve/architecture/1", "name": "loop", "plugins": ["loop"],
      "components": {"control": {"type": "loop/pid", "properties": {)" +
                          properties + "}}}}",
                      catalog_, problems_);
  }

  plugin::Catalog catalog_;
  arch::Problems problems_;
};

TEST_F(ParametersInAFile, AreSetByTheNameOfTheField) {
  const auto architecture =
      load(R"("core.kp": 4, "core.dwell": "20ms", "core.goal": {"x": 1}, "core.last": 2)");

  ASSERT_NE(architecture, nullptr);
  const auto& core = dynamic_cast<const Pid&>(architecture->find_component("control")->core());
  EXPECT_EQ(core.gains->kp, 4.0);
  EXPECT_EQ(core.gains->dwell, 20ms);
  EXPECT_EQ(core.gains->goal.x, 1.0);
  EXPECT_EQ(core.gains->ki, 0.5);
}

TEST_F(ParametersInAFile, AreRefusedWithTheirPlaceInTheFile) {
  EXPECT_EQ(load(R"("core.kp": 11, "core.internal": 1)"), nullptr);

  const auto problems = problems_.sorted();
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_NE(to_string(problems[0], "f").find("core.kp: 11 is above the maximum 10 1/s"),
            std::string::npos)
      << to_string(problems[0], "f");
  EXPECT_NE(to_string(problems[1], "f").find("internal"), std::string::npos);
}

class ParametersInAChange : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(deployer_.deploy());
    deployer_.run_for(50ms);
    Pid::seen().clear();
  }
  Result<Receipt> set(std::vector<std::pair<std::string, Value>> properties) {
    Edit edit;
    edit.member = "control";
    edit.properties = std::move(properties);
    return deployer_.apply({.edits = {edit}});
  }

  Loop loop_;
  Deployer deployer_{loop_, {.simulated = true}};
};

TEST_F(ParametersInAChange, SeveralChangeBetweenTwoJobsAndTheOthersStay) {
  deployer_.run_for(20ms);
  const Result<Receipt> done = set({{"core.kp", 6.0}, {"core.ki", 3.0}});
  deployer_.run_for(20ms);

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(Pid::seen(), (std::vector<Seen>{{2.0, 0.5}, {2.0, 0.5}, {6.0, 3.0}, {6.0, 3.0}}));
  EXPECT_EQ(deployer_.status("control").missed, 0U);
  ASSERT_TRUE(set({{"core.ki", 1.0}}));
  deployer_.run_for(10ms);
  EXPECT_EQ(Pid::seen().back(), (Seen{6.0, 1.0})) << "kp stays as it was set";
}

TEST_F(ParametersInAChange, AllAreRefusedWithOneThatIs) {
  const Result<Receipt> limit = set({{"core.kp", 6.0}, {"core.order", 5}});
  const Result<Receipt> core = set({{"core.ki", 3.0}});
  deployer_.run_for(10ms);

  ASSERT_FALSE(limit);
  EXPECT_EQ(limit.error().at, "control.core.order");
  ASSERT_FALSE(core);
  EXPECT_EQ(core.error().at, "control.core.ki");
  EXPECT_EQ(Pid::seen(), (std::vector<Seen>{{2.0, 0.5}}));
  EXPECT_EQ(deployer_.generation(), 1U);
}

}  // namespace
}  // namespace mauve
