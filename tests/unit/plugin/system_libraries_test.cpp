// SPDX-License-Identifier: LGPL-3.0-or-later
/// The libraries that a job or hook may load.
#include "plugin/load/system_libraries.h"

#include <filesystem>
#include <string>

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <link.h>

#include "rt/thread/run_guarded.h"
#include "support/temp_dir.h"

namespace mauve::plugin {
namespace {

/// Small, of the C library, and used by nobody here.
constexpr const char* kOfTheSystem = "libanl.so.1";

struct Loading {
  const char* file;
  void* loaded = nullptr;
};

/// dlopen() in a body; the handle stays open.
rt::Fault load_in_body(Loading& loading) {
  return rt::run_guarded(
      [](void* self) {
        auto& one = *static_cast<Loading*>(self);
        one.loaded = dlopen(one.file, RTLD_NOW | RTLD_GLOBAL);
      },
      &loading, rt::kUnwatched);
}

std::string place_of(void* library) {
  link_map* map = nullptr;
  return dlinfo(library, RTLD_DI_LINKMAP, &map) == 0 ? map->l_name : "";
}

class LoadedInAJob : public testing::Test {
 protected:
  void SetUp() override {
    if (!rt::kGuardsFaults) GTEST_SKIP() << "the sanitizer has functions of its own";
  }
  /// A copy of the library outside of the folders of the system.
  [[nodiscard]] std::string copied() const {
    void* const library = dlopen(kOfTheSystem, RTLD_NOW);
    const auto copy = place_ / "libforeign.so";
    std::filesystem::copy_file(place_of(library), copy);
    dlclose(library);
    return copy.string();
  }
  test::TempDir place_;
};

TEST_F(LoadedInAJob, ANameMeansALibraryOfTheSystem) {
  Loading loading{kOfTheSystem};
  EXPECT_FALSE(load_in_body(loading).happened());
  ASSERT_NE(loading.loaded, nullptr) << dlerror();
  EXPECT_TRUE(is_of_the_system(place_of(loading.loaded))) << place_of(loading.loaded);
  dlclose(loading.loaded);
}

TEST_F(LoadedInAJob, ANameThatTheSystemDoesNotHaveIsNoLibrary) {
  Loading loading{"libforeign.so"};
  EXPECT_FALSE(load_in_body(loading).happened());
  EXPECT_EQ(loading.loaded, nullptr);
}

TEST_F(LoadedInAJob, ALibraryElsewhereEndsTheJobAndIsNotLoaded) {
  const std::string copy = copied();
  Loading loading{copy.c_str()};
  const rt::Fault fault = load_in_body(loading);
  ASSERT_NE(fault.call, nullptr);
  EXPECT_STREQ(fault.call, "dlopen");
  EXPECT_EQ(dlopen(copy.c_str(), RTLD_NOW | RTLD_NOLOAD), nullptr);
}

TEST_F(LoadedInAJob, ALibraryElsewhereIsThatOfTheProgramWhenItIsLoadedAlready) {
  const std::string copy = copied();
  void* const before = dlopen(copy.c_str(), RTLD_NOW);
  ASSERT_NE(before, nullptr) << dlerror();
  Loading loading{copy.c_str()};
  EXPECT_FALSE(load_in_body(loading).happened());
  EXPECT_EQ(loading.loaded, before);
  dlclose(before);
  dlclose(before);
}

TEST_F(LoadedInAJob, NoSecondSetOfLibrariesIsMade) {
  const rt::Fault fault = rt::run_guarded(
      [](void*) { static_cast<void>(dlmopen(LM_ID_NEWLM, kOfTheSystem, RTLD_NOW)); }, nullptr,
      rt::kUnwatched);
  ASSERT_NE(fault.call, nullptr);
  EXPECT_STREQ(fault.call, "dlmopen");
}

}  // namespace
}  // namespace mauve::plugin
