// SPDX-License-Identifier: LGPL-3.0-or-later
/// The code that runs is the code of now, and code that is gone is really gone.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "model/job/guard.h"
#include "rt/thread/run_guarded.h"
#include "unit/plugin/zoo.h"

namespace mauve::plugin::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Reload : public ::testing::Test {
 protected:
  Reload() { folder_.put("1/good.so", "good.so"); }

  PluginDir folder_;
  Catalog catalog_{folder_.list()};
};

std::size_t mappings_of(const std::string& plugin) {
  std::ifstream maps("/proc/self/maps");
  std::size_t count = 0;
  for (std::string line; std::getline(maps, line);) {
    if (line.find("memfd:mauve:" + plugin + "-") != std::string::npos) ++count;
  }
  return count;
}

TEST_F(Reload, RunsTheNewCodeOfAFileRebuiltAtTheSamePath) {
  ASSERT_TRUE(catalog_.load("good"));
  EXPECT_EQ(number(*make_core(catalog_, "good/number")) % 100, 1);
  folder_.put("2/good.so", "good.so");

  const Result<Unmapped> reloaded = catalog_.reload("good");

  ASSERT_TRUE(reloaded) << to_string(reloaded.error());
  EXPECT_TRUE(reloaded->unmapped) << reloaded->reason;
  EXPECT_EQ(number(*make_core(catalog_, "good/number")) % 100, 2);
}

TEST_F(Reload, StartsWithFreshStaticDataEveryTime) {
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(catalog_.load("good"));
    EXPECT_EQ(number(*make_core(catalog_, "good/number")), 101);
    EXPECT_EQ(number(*make_core(catalog_, "good/number")), 201);
    const Result<Unmapped> unloaded = catalog_.unload("good");
    ASSERT_TRUE(unloaded) << to_string(unloaded.error());
    EXPECT_TRUE(unloaded->unmapped) << unloaded->reason;
  }
}

/// Code whose thread runs on must not be unmapped under it.
TEST_F(Reload, KeepsTheCodeOfAThreadThatWasLeftRunning) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "a sanitizer has a pthread_create() of its own";
  const mauve::test::TempDir files;
  const auto file = files.write("lingers", "");
  setenv("ZOO_LINGERS", file.c_str(), 1);
  folder_.put("lingering.so", "lingering.so");
  ASSERT_TRUE(catalog_.load("lingering"));
  EXPECT_TRUE(call_hook("lingering", "constructor",
                        [&] { return make_core(catalog_, "lingering/number").reset(), ok(); }));
  unsetenv("ZOO_LINGERS");

  const Result<Unmapped> unloaded = catalog_.unload("lingering");

  ASSERT_TRUE(unloaded) << to_string(unloaded.error());
  EXPECT_FALSE(unloaded->unmapped);
  EXPECT_THAT(unloaded->reason, HasSubstr("left 1 thread running"));
  EXPECT_GT(mappings_of("lingering"), 0U);
  std::filesystem::remove(file);  // the thread reads code that is still there, and ends
}

TEST_F(Reload, FindsNothingOfAPluginThatWasUnloaded) {
  ASSERT_TRUE(catalog_.load("good"));
  EXPECT_GT(mappings_of("good"), 0U);

  ASSERT_TRUE(catalog_.unload("good"));

  EXPECT_EQ(mappings_of("good"), 0U);
  EXPECT_EQ(dlopen((folder_ / "good.so").c_str(), RTLD_NOW | RTLD_NOLOAD), nullptr);
  EXPECT_FALSE(catalog_.core("good/number"));
}

TEST_F(Reload, SurvivesThatTheFileIsCutOffWhileItsCodeRuns) {
  ASSERT_TRUE(catalog_.load("good"));
  const std::shared_ptr<CoreBase> core = make_core(catalog_, "good/number");

  std::ofstream(folder_ / "good.so", std::ios::trunc) << "cut";

  EXPECT_EQ(number(*core), 101);
  EXPECT_FALSE(catalog_.reload("good"));
  EXPECT_EQ(number(*core), 201);
  EXPECT_TRUE(catalog_.core("good/number"));
}

TEST_F(Reload, LeavesOldInstancesOnTheOldCodeAndSaysWho) {
  ASSERT_TRUE(catalog_.load("good"));
  std::shared_ptr<CoreBase> core = make_core(catalog_, "good/number");
  core->adopt("counter.core");
  folder_.put("2/good.so", "good.so");

  const Result<Unmapped> reloaded = catalog_.reload("good");

  ASSERT_TRUE(reloaded);
  EXPECT_FALSE(reloaded->unmapped);
  EXPECT_THAT(reloaded->reason, HasSubstr("counter.core (good/number)"));
  EXPECT_EQ(number(*core) % 100, 1);
  EXPECT_EQ(number(*make_core(catalog_, "good/number")) % 100, 2);
  const std::size_t both = mappings_of("good");
  core.reset();
  EXPECT_LT(mappings_of("good"), both);
}

TEST_F(Reload, KeepsOnlyTheBuildWhoseDataTypeIsUsedHoweverOftenItIsReloaded) {
  ASSERT_TRUE(catalog_.load("good"));
  const auto type = catalog_.type("zoo_number/1");
  ASSERT_TRUE(type);
  folder_.put("2/good.so", "good.so");

  const Result<Unmapped> first = catalog_.reload("good");
  ASSERT_TRUE(first);
  EXPECT_FALSE(first->unmapped);
  EXPECT_TRUE(first->types_only) << first->reason;
  EXPECT_EQ(first->reason, "still used by data type zoo_number/1");
  const std::size_t two_builds = mappings_of("good");
  for (int round = 0; round < 3; ++round) {
    const Result<Unmapped> again = catalog_.reload("good");
    ASSERT_TRUE(again);
    EXPECT_TRUE(again->unmapped) << again->reason;
    EXPECT_EQ(mappings_of("good"), two_builds) << round;
  }
}

TEST_F(Reload, RefusesToUnloadWhatIsInUseAndNamesTheUsers) {
  ASSERT_TRUE(catalog_.load("good"));
  std::shared_ptr<CoreBase> core = make_core(catalog_, "good/number");
  core->adopt("counter.core");
  const auto type = catalog_.type("zoo_number/1");
  ASSERT_TRUE(type);

  const Result<Unmapped> unloaded = catalog_.unload("good");

  ASSERT_FALSE(unloaded);
  EXPECT_EQ(unloaded.error().code, Errc::wrong_state);
  EXPECT_THAT(unloaded.error().message, HasSubstr("counter.core (good/number)"));
  EXPECT_THAT(unloaded.error().message, HasSubstr("data type zoo_number/1"));
  EXPECT_TRUE(catalog_.core("good/number"));
}

TEST_F(Reload, KeepsTheCodeUntilTheLastObjectIsGoneInAnyOrder) {
  std::shared_ptr<CoreBase> core;
  std::shared_ptr<FsmBase> fsm;
  std::shared_ptr<const DataType> type;
  {
    Catalog catalog(folder_.list());
    ASSERT_TRUE(catalog.load("good"));
    core = make_core(catalog, "good/number");
    fsm = catalog.fsm("good/pace")->make();
    type = *catalog.type("zoo_number/1");
  }

  EXPECT_EQ(number(*core), 101);
  core.reset();
  EXPECT_EQ(type->name, "zoo_number/1");
  type.reset();
  EXPECT_TRUE(fsm->configure());
  EXPECT_GT(mappings_of("good"), 0U);
  fsm.reset();
  EXPECT_EQ(mappings_of("good"), 0U);
}

TEST_F(Reload, HandsAStateOverWithoutKeepingTheOldCode) {
  ASSERT_TRUE(catalog_.load("good"));
  std::shared_ptr<CoreBase> old_core = make_core(catalog_, "good/number");
  static_cast<zoo::NumberCore&>(*old_core).state->value = 77;
  folder_.put("2/good.so", "good.so");
  Result<LoadedPlugin> fresh = catalog_.prepare_load("good");
  ASSERT_TRUE(fresh) << to_string(fresh.error());
  const std::shared_ptr<CoreBase> core = fresh->cores.at("good/number").make();

  ASSERT_TRUE(core->declared_state()->fits(*old_core->declared_state()));
  core->declared_state()->exchange(*old_core->declared_state());
  Result<std::shared_ptr<Library>> retired = catalog_.commit(*std::move(fresh));
  old_core.reset();
  const Unmapped gone = Library::release(*std::move(retired));

  EXPECT_TRUE(gone.unmapped) << gone.reason;
  EXPECT_EQ(static_cast<zoo::NumberCore&>(*core).state->value, 77);
  EXPECT_EQ(number(*core), 102);
}

TEST_F(Reload, ChangesNothingBeforeTheCommit) {
  ASSERT_TRUE(catalog_.load("good"));
  folder_.put("2/good.so", "good.so");

  {
    const Result<LoadedPlugin> prepared = catalog_.prepare_load("good");
    ASSERT_TRUE(prepared);
    EXPECT_EQ(number(*prepared->cores.at("good/number").make()) % 100, 2);
    EXPECT_EQ(number(*make_core(catalog_, "good/number")) % 100, 1);
  }

  EXPECT_EQ(catalog_.find("good")->info().serial + 1,
            catalog_.prepare_load("good")->info().serial - 1);
  EXPECT_EQ(number(*make_core(catalog_, "good/number")) % 100, 1);
}

TEST_F(Reload, TakesThePageFaultsOfNewCodeBeforeItsFirstJob) {
#if defined(MAUVE_SANITIZE_ADDRESS_UNDEFINED) || defined(MAUVE_SANITIZE_THREAD)
  GTEST_SKIP() << "a sanitizer touches memory of its own in every call";
#endif
  if (madvise(nullptr, 0, 22 /* MADV_POPULATE_READ */) != 0) {
    GTEST_SKIP() << "this kernel (before 5.14) cannot populate pages on request";
  }
  const auto faults = [] {
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    return usage.ru_minflt + usage.ru_majflt;
  };
  ASSERT_TRUE(catalog_.load("good"));
  const std::shared_ptr<CoreBase> core = make_core(catalog_, "good/number");
  static_cast<void>(faults());

  const long before = faults();
  const int first = number(*core);
  const long after = faults();

  EXPECT_EQ(first, 101);
  EXPECT_EQ(after, before);
}

TEST_F(Reload, PreparesOnOneThreadWhileAnotherLooksNamesUp) {
  ASSERT_TRUE(catalog_.load("good"));

  std::thread factory([&] {
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(catalog_.prepare_load("good"));
  });
  for (int i = 0; i < 200; ++i) EXPECT_NE(make_core(catalog_, "good/number"), nullptr);
  factory.join();
}

TEST_F(Reload, RefusesToMakeAnythingFromATypeOfBefore) {
  ASSERT_TRUE(catalog_.load("good"));
  const CoreType old = *catalog_.core("good/number");
  ASSERT_TRUE(catalog_.reload("good"));

  EXPECT_THROW(old.make(), std::runtime_error);
  const CoreType present = *catalog_.core("good/number");
  Result<std::shared_ptr<Library>> removed = catalog_.remove("good");
  ASSERT_TRUE(removed);
  EXPECT_THROW(present.make(), std::runtime_error) << "though its code is still mapped";
  EXPECT_TRUE(Library::release(*std::move(removed)).unmapped);
  EXPECT_THROW(old.make(), std::runtime_error);
}

TEST_F(Reload, KeepsTheOldPluginWhenTheNewOneIsRefused) {
  ASSERT_TRUE(catalog_.load("good"));
  folder_.put("wrong_abi.so", "good.so");

  const Result<Unmapped> reloaded = catalog_.reload("good");

  ASSERT_FALSE(reloaded);
  EXPECT_EQ(reloaded.error().code, Errc::abi_mismatch);
  EXPECT_EQ(number(*make_core(catalog_, "good/number")), 101);
}

TEST(ReloadOfAResidentPlugin, SaysThatTheOldCodeStaysButRunsTheNew) {
  const PluginDir folder;
  folder.put("resident.so", "resident.so");
  Catalog catalog(folder.list());
  ASSERT_TRUE(catalog.load("resident"));
  EXPECT_THAT(catalog.find("resident")->info().warnings, ElementsAre(HasSubstr("nodelete")));
  EXPECT_EQ(number(*make_core(catalog, "resident/number")), 103);

  const Result<Unmapped> reloaded = catalog.reload("resident");

  ASSERT_TRUE(reloaded);
  EXPECT_FALSE(reloaded->unmapped);
  EXPECT_THAT(reloaded->reason, HasSubstr("dynamic linker keeps it"));
  EXPECT_EQ(number(*make_core(catalog, "resident/number")), 103);
}

TEST(ReloadInfo, StatesVersionCompilerBuildIdAndFile) {
  const PluginDir folder;
  folder.put("1/good.so", "good.so");
  Catalog catalog(folder.list());
  ASSERT_TRUE(catalog.load("good"));

  const PluginInfo& info = catalog.find("good")->info();

  EXPECT_EQ(info.name, "good");
  EXPECT_EQ(info.version, kVersion);
  EXPECT_EQ(info.compiler, __VERSION__);
  EXPECT_EQ(info.build_id.size(), 40U);
  EXPECT_EQ(info.file, (folder / "good.so").string());
  EXPECT_THAT(info.warnings, IsEmpty());
}

}  // namespace
}  // namespace mauve::plugin::test
