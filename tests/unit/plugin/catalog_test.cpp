// SPDX-License-Identifier: LGPL-3.0-or-later
/// Names and what they mean, with plugins that are part of the program.
#include "plugin/load/catalog.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "plugins/number.h"

namespace mauve::plugin::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class One final : public zoo::NumberCore {
  int number() override { return 1; }
};

class Two final : public zoo::NumberCore {
  int number() override { return 2; }
};

class Unrelated final : public Core<zoo::NumberShell> {};

Plugin sample(const std::string& name = "sample") {
  Plugin plugin(name);
  plugin.core<One>("one");
  plugin.core<Unrelated>("unrelated");
  plugin.component<zoo::NumberShell, Two, zoo::NumberFsm>("counter");
  plugin.resource<zoo::NumberShell, One, zoo::NumberInterface>("register");
  plugin.fsm<zoo::NumberFsm>("pace");
  return plugin;
}

class CatalogTest : public ::testing::Test {
 protected:
  CatalogTest() {
    const Status added = catalog_.add(sample());
    EXPECT_TRUE(added);
  }

  Catalog catalog_;
};

TEST_F(CatalogTest, HasCopiesThatGoTheirOwnWay) {
  Catalog copy(catalog_);
  ASSERT_TRUE(copy.add(sample("more")));

  EXPECT_TRUE(copy.core("sample/one"));
  EXPECT_TRUE(copy.core("more/one"));
  EXPECT_FALSE(catalog_.core("more/one"));
}

TEST_F(CatalogTest, MakesWhatIsKnownByName) {
  EXPECT_EQ(static_cast<zoo::NumberCore&>(*catalog_.core("sample/one")->make()).number(), 1);
  EXPECT_EQ(catalog_.component("sample/counter")->default_core, "sample/counter");
  EXPECT_NE(catalog_.component("sample/counter")->shell.make(), nullptr);
  EXPECT_NE(catalog_.resource("sample/register")->interface(), nullptr);
  EXPECT_TRUE(catalog_.fsm("sample/pace")->make()->configure());
}

TEST_F(CatalogTest, SaysHowATypeBecomesKnown) {
  EXPECT_THAT(catalog_.type("nothing/1").error().hint, testing::HasSubstr("plugin.type<T>()"));
}

TEST_F(CatalogTest, FindsTheStateMachineOfAComponentAndTheCoreOfAResource) {
  EXPECT_NE(catalog_.fsm("sample/counter")->make(), nullptr);
  EXPECT_NE(catalog_.core("sample/register")->make(), nullptr);
}

TEST_F(CatalogTest, ListsTheCoresThatFitAContract) {
  const Contract wanted = catalog_.component("sample/counter")->fsm.contract;

  EXPECT_THAT(catalog_.cores_for(wanted),
              ElementsAre("sample/counter", "sample/one", "sample/register"));
}

TEST_F(CatalogTest, SuggestsTheNearestName) {
  const Result<CoreType> core = catalog_.core("sample/oen");

  ASSERT_FALSE(core);
  EXPECT_EQ(core.error().code, Errc::unknown_name);
  EXPECT_EQ(core.error().message, "there is no core \"sample/oen\"");
  EXPECT_EQ(core.error().hint, "did you mean \"sample/one\"?");
}

TEST_F(CatalogTest, SuggestsByTheLastPartOrThePluginOfAName) {
  EXPECT_EQ(catalog_.core("onee").error().hint, "did you mean \"sample/one\"?");
  EXPECT_THAT(catalog_.core("sample/elsewhere").error().hint, HasSubstr("sample/one"));
  EXPECT_EQ(catalog_.core("elsewhere").error().hint, "");
}

TEST_F(CatalogTest, SaysWhenThePluginOfANameIsNotLoaded) {
  const Result<ComponentType> component = catalog_.component("guidance/control");

  ASSERT_FALSE(component);
  EXPECT_THAT(component.error().message, HasSubstr("plugin \"guidance\" is not loaded"));
  EXPECT_EQ(component.error().hint, "load plugin \"guidance\"");
}

TEST_F(CatalogTest, KnowsThePlainTypesWithoutAnyPlugin) {
  for (const char* name : {"bool", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64",
                           "uint64", "float", "double", "duration"}) {
    const auto type = catalog_.type(name);
    ASSERT_TRUE(type) << name;
    EXPECT_EQ((*type)->name, name);
    EXPECT_TRUE((*type)->flat);
  }
  EXPECT_EQ(catalog_.type("duoble").error().hint,
            "did you mean \"double\"? A plugin registers its type: plugin.type<T>()");
}

TEST_F(CatalogTest, KnowsTheDescribedTypesOfPlugins) {
  EXPECT_FALSE(catalog_.type("zoo_number/1"));
  Plugin types("types");
  types.type<zoo::Number>();
  ASSERT_TRUE(catalog_.add(std::move(types)));

  const auto type = catalog_.type("zoo_number/1");

  ASSERT_TRUE(type);
  EXPECT_EQ(type->get(), &data_type<zoo::Number>());
}

TEST_F(CatalogTest, AcceptsTheSameTypeFromTwoPlugins) {
  for (const char* name : {"types", "more_types"}) {
    Plugin types(name);
    types.type<zoo::Number>();
    EXPECT_TRUE(catalog_.add(std::move(types)));
  }
}

TEST_F(CatalogTest, RefusesABuildWithoutADataTypeThatIsInUse) {
  Plugin types("types");
  types.type<zoo::Number>();
  ASSERT_TRUE(catalog_.add(std::move(types)));
  const auto without = LoadedPlugin::of(Library::compiled_in(Plugin("types")));
  ASSERT_TRUE(without);
  EXPECT_TRUE(catalog_.check_types_in_use(*without)) << "no resource uses it";

  const auto used = catalog_.type("zoo_number/1");
  EXPECT_EQ(catalog_.check_types_in_use(*without).error().code, Errc::conflict);

  Plugin more("more_types");
  more.type<zoo::Number>();
  ASSERT_TRUE(catalog_.add(std::move(more)));
  EXPECT_TRUE(catalog_.check_types_in_use(*without)) << "another plugin has the type";
}

TEST_F(CatalogTest, RefusesASecondPluginOfTheSameName) {
  const Status added = catalog_.add(sample());

  ASSERT_FALSE(added);
  EXPECT_EQ(added.error().code, Errc::duplicate);
}

TEST_F(CatalogTest, DoesNotUnloadOrReloadPartsOfTheProgram) {
  EXPECT_EQ(catalog_.unload("sample").error().code, Errc::unsupported);
  EXPECT_EQ(catalog_.reload("sample").error().code, Errc::unsupported);
}

TEST_F(CatalogTest, SuggestsTheNearestPlugin) {
  EXPECT_EQ(catalog_.unload("smaple").error().hint, "did you mean sample?");
  EXPECT_EQ(catalog_.reload("smaple").error().code, Errc::unknown_name);
}

TEST_F(CatalogTest, ListsTheUsersOfAPlugin) {
  const std::shared_ptr<CoreBase> core = catalog_.core("sample/unrelated")->make();
  const Library& library = *catalog_.find("sample")->library();
  EXPECT_THAT(library.users(), ElementsAre("sample/unrelated"));

  core->adopt("here.core");

  EXPECT_THAT(library.users(), ElementsAre("here.core (sample/unrelated)"));
}

TEST(CatalogOfFiles, RefusesToLoadTwice) {
  Catalog catalog({std::string(MAUVE_ZOO) + "/1"});
  ASSERT_TRUE(catalog.load("good"));

  const Status again = catalog.load("good");

  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, Errc::duplicate);
}

}  // namespace
}  // namespace mauve::plugin::test
