// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugins that were built with headers of different days do not meet in one component.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "unit/plugin/zoo.h"

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace mauve::plugin::test {
namespace {

using ::testing::HasSubstr;

/// A component of plugin "line" that runs; cores for it come from plugin "line_core".
class ContractOfTwoPlugins : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.put("line.so", "line.so");
    ASSERT_TRUE(catalog_.load("line"));
    const ComponentType type = *catalog_.component("line/unit");
    const auto unit = std::make_shared<ComponentBase>("unit", type, *catalog_.core("line/main"));
    ASSERT_TRUE(unit->made()) << to_string(unit->made().error());
    const auto out = std::make_shared<SharedDataBase>("out", data_type<double>());
    architecture_.own(out);
    architecture_.own(unit);
    ASSERT_TRUE(unit->connect("out", out->write_service(), nullptr));
    ASSERT_TRUE(deployer_.deploy());
    deployer_.run_for(30ms);
  }
  void TearDown() override { deployer_.shutdown(); }

  /// Puts this build of the cores in force, and swaps one of them in.
  Result<Receipt> swap_to(std::string_view build, const std::string& core,
                          StatePolicy state = StatePolicy::keep) {
    folder_.put("line_" + std::string(build) + "/line_core.so", "line_core.so");
    if (catalog_.find("line_core") == nullptr) {
      EXPECT_TRUE(catalog_.load("line_core"));
    } else {
      EXPECT_TRUE(catalog_.reload("line_core"));
    }
    Edit edit;
    edit.member = "unit";
    edit.core = *catalog_.core("line_core/" + core);
    edit.state = state;
    Result<Receipt> done = deployer_.apply(Change{{edit}});
    deployer_.run_for(30ms);
    return done;
  }
  void expect_still_runs(std::uint64_t generation) {
    const std::uint64_t before = deployer_.status("unit").releases;
    deployer_.run_for(30ms);
    EXPECT_GT(deployer_.status("unit").releases, before);
    EXPECT_EQ(deployer_.generation(), generation);
  }
  std::int64_t count() {
    const CoreBase& core = architecture_.find_component("unit")->core();
    return *core.find_observable("count")->value().get_if<std::int64_t>();
  }

  PluginDir folder_;
  Catalog catalog_{folder_.list()};
  Architecture architecture_;
  Deployer deployer_{architecture_, {.simulated = true}};
};

TEST_F(ContractOfTwoPlugins, AcceptsACoreThatWasBuiltWithTheSameHeader) {
  const auto done = swap_to("same", "other");

  ASSERT_TRUE(done) << to_string(done.error());
  expect_still_runs(2);
}

TEST_F(ContractOfTwoPlugins, RefusesACoreThatSeesThePortsInAnotherOrder) {
  const auto done = swap_to("ports", "other");

  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::type_mismatch);
  EXPECT_EQ(done.error().at, "unit.core");
  EXPECT_THAT(done.error().message, HasSubstr("different headers of contract line/core/1"));
  EXPECT_THAT(done.error().message, HasSubstr("port extra lies at byte "));
  EXPECT_THAT(done.error().hint, HasSubstr("rebuild both plugins with the same header"));
  expect_still_runs(1);
}

TEST_F(ContractOfTwoPlugins, RefusesACoreWithOneVirtualFunctionMore) {
  const auto done = swap_to("functions", "other");

  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("the contract class has "));
  EXPECT_THAT(done.error().message, HasSubstr(" virtual functions"));
  expect_still_runs(1);
}

TEST_F(ContractOfTwoPlugins, RefusesACoreThatSeesThePropertiesOfTheContractInAnotherOrder) {
  const auto done = swap_to("properties", "other");

  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("than the core in force: property "));
  EXPECT_THAT(done.error().message, HasSubstr(" lies at byte "));
  expect_still_runs(1);
}

TEST_F(ContractOfTwoPlugins, HandsAnUndescribedStateOverWithinOneBuild) {
  ASSERT_TRUE(swap_to("same", "counting"));
  const std::int64_t before = count();

  const auto again = swap_to("same", "counting");  // reloaded: the same bytes, mapped again

  ASSERT_TRUE(again) << to_string(again.error());
  EXPECT_GT(count(), before);
}

TEST_F(ContractOfTwoPlugins, RefusesAnUndescribedStateOfAnotherBuild) {
  ASSERT_TRUE(swap_to("same", "counting"));
  const std::int64_t before = count();

  for (const char* build : {"rebuilt", "other_state"}) {
    const auto done = swap_to(build, "counting");
    ASSERT_FALSE(done) << build;
    EXPECT_EQ(done.error().code, Errc::type_mismatch);
    EXPECT_THAT(done.error().message, HasSubstr("line::Sum"));
    EXPECT_THAT(done.error().message, HasSubstr("has no description"));
    EXPECT_THAT(done.error().hint, HasSubstr("type_name"));
    EXPECT_THAT(done.error().hint, HasSubstr("--state drop"));
    expect_still_runs(2);
  }
  EXPECT_GT(count(), before);

  ASSERT_TRUE(swap_to("other_state", "counting", StatePolicy::drop));
  EXPECT_LE(count(), 4);
}

TEST_F(ContractOfTwoPlugins, HandsOverAStateOfAnotherBuildForWhichItsAuthorVouches) {
  ASSERT_TRUE(swap_to("vouched", "counting"));
  const std::int64_t before = count();

  const auto done = swap_to("vouched_rebuilt", "counting");

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_GT(count(), before);
}

TEST_F(ContractOfTwoPlugins, SaysThatOnlyTheNameOfAStateWithoutFieldsWasCompared) {
  ASSERT_TRUE(swap_to("vouched", "counting"));
  for (const char* build : {"vouched", "vouched_rebuilt", "vouched_other_state"}) {
    const auto done = swap_to(build, "counting");
    ASSERT_TRUE(done) << to_string(done.error());
    ASSERT_EQ(done->notes.size(), 1u) << build;
    EXPECT_THAT(done->notes[0], HasSubstr("unit: the state line_sum/1 (16 B) is kept as it is"));
    EXPECT_THAT(done->notes[0], HasSubstr("only its name and size were compared"));
  }
}

TEST_F(ContractOfTwoPlugins, TreatsEmptyFieldsOfAStateLikeANameAlone) {
  ASSERT_TRUE(swap_to("opaque", "counting"));

  const auto done = swap_to("opaque_other_state", "counting");

  ASSERT_TRUE(done) << to_string(done.error());
  ASSERT_EQ(done->notes.size(), 1u);
  EXPECT_THAT(done->notes[0], HasSubstr("only its name and size were compared"));
}

TEST_F(ContractOfTwoPlugins, SaysBeforeAChangeThatTheFieldsOfAStateAreNotCompared) {
  ASSERT_TRUE(swap_to("vouched", "counting"));
  folder_.put("line_vouched_rebuilt/line_core.so", "line_core.so");
  ASSERT_TRUE(catalog_.reload("line_core"));
  Edit edit;
  edit.member = "unit";
  edit.core = *catalog_.core("line_core/counting");
  auto prepared = deployer_.prepare(Change{{edit}});

  ASSERT_TRUE(prepared) << to_string(prepared.error());
  const Receipt foreseen = deployer_.foresee(*prepared);

  ASSERT_EQ(foreseen.notes.size(), 1u);
  EXPECT_THAT(foreseen.notes[0], HasSubstr("only its name and size were compared"));
  EXPECT_EQ(deployer_.generation(), 2u);
}

TEST_F(ContractOfTwoPlugins, ComparesTheFieldsOfADescribedStateOfEqualSize) {
  ASSERT_TRUE(swap_to("described", "counting"));
  const std::int64_t before = count();
  const auto rebuilt = swap_to("described_rebuilt", "counting");
  ASSERT_TRUE(rebuilt) << to_string(rebuilt.error());
  EXPECT_THAT(rebuilt->notes, ::testing::IsEmpty());
  EXPECT_GT(count(), before);

  const auto done = swap_to("described_other_state", "counting");

  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::type_mismatch);
  EXPECT_THAT(done.error().message, HasSubstr("line_sum/1 (layout "));
  EXPECT_THAT(done.error().message, HasSubstr("which the new core cannot convert"));
  expect_still_runs(3);
}

}  // namespace
}  // namespace mauve::plugin::test
