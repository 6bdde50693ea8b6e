// SPDX-License-Identifier: LGPL-3.0-or-later
/// Every broken plugin is refused with words that help, and leaves nothing behind.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "unit/plugin/zoo.h"

namespace mauve::plugin::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Fault {
  const char* plugin;
  Reason reason;
  const char* words;
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.plugin; }

class Zoo : public ::testing::TestWithParam<Fault> {};

TEST_P(Zoo, IsRefusedWithWordsThatHelp) {
  Catalog catalog({MAUVE_ZOO});

  const Status loaded = catalog.load(GetParam().plugin);

  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, GetParam().reason.code) << to_string(loaded.error());
  EXPECT_EQ(loaded.error().id, GetParam().reason.id) << to_string(loaded.error());
  EXPECT_THAT(to_string(loaded.error()), HasSubstr(GetParam().words));
  EXPECT_FALSE(loaded.error().at.empty());
  EXPECT_THAT(catalog.plugins(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Plugins, Zoo,
    ::testing::Values(
        Fault{"no_entry", {Errc::plugin_refused, "not_a_plugin"}, "does not export mauve_plugin"},
        Fault{"wrong_magic", {Errc::plugin_refused, "not_a_plugin"}, "no magic number"},
        Fault{"wrong_abi", {Errc::abi_mismatch, "plugin_other_abi"}, "rebuild it with mauve"},
        Fault{"wrong_size", {Errc::abi_mismatch, "plugin_other_abi"}, "rebuild it with mauve"},
        Fault{"wrong_fingerprint",
              {Errc::abi_mismatch, "plugin_other_headers"},
              "was built with other headers"},
        Fault{"no_declare", {Errc::plugin_refused, "plugin_damaged"}, "its entry is not the one"},
        Fault{"missing_symbol",
              {Errc::plugin_refused, "plugin_missing_symbol"},
              "zoo::nobody_wrote_me(double)"},
        Fault{"throwing_declare",
              {Errc::hook_threw, "hook_exception"},
              "cannot declare throwing_declare"},
        Fault{"duplicate_name",
              {Errc::duplicate, "plugin_registers_twice"},
              "duplicate_name/number: is registered twice"},
        Fault{"bad_name", {Errc::invalid_value, "plugin_bad_name"}, "good/number: is no name"},
        Fault{"no_default_core",
              {Errc::unknown_name, "plugin_no_default_core"},
              "no_default_core/nubmer is not registered"},
        Fault{"other_contract",
              {Errc::type_mismatch, "plugin_other_contract"},
              "its state machine calls zoo/number/1"},
        Fault{"thread_local_data",
              {Errc::plugin_refused, "plugin_thread_local"},
              "real-time thread: (anonymous namespace)::calls"},
        Fault{"debug_containers",
              {Errc::abi_mismatch, "plugin_other_options"},
              "was built with _GLIBCXX_DEBUG, this runtime without"},
        Fault{"search_path", {Errc::plugin_refused, "plugin_search_path"}, "RPATH or RUNPATH"},
        Fault{
            "executable_stack", {Errc::plugin_refused, "plugin_unsafe_memory"}, "executable stack"},
        Fault{"needs_neighbour",
              {Errc::plugin_refused, "plugin_needs_library"},
              "needs neighbour.so"},
        Fault{"not_stamped", {Errc::plugin_refused, "plugin_without_checksum"}, "has no checksum"},
        Fault{"two_symbols",
              {Errc::plugin_refused, "plugin_exports"},
              "must be its only exported symbol"}),
    [](const auto& each) { return std::string(each.param.plugin); });

/// LD_LIBRARY_PATH may name it, or an earlier attempt have left it behind.
TEST(ZooOfLibraries, OneBesideAPluginIsRefusedAlsoIfItIsLoadedAlready) {
  Catalog first({MAUVE_ZOO "/1"});
  ASSERT_TRUE(first.load("good"));  // by then the program has its own libraries
  Catalog catalog({MAUVE_ZOO});
  const Status missing = catalog.load("needs_helper");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().id, "plugin_missing_library");

  void* const helper = dlopen(MAUVE_ZOO "/helper/libzoo_helper.so", RTLD_NOW);
  ASSERT_NE(helper, nullptr) << dlerror();
  const Status loaded = catalog.load("needs_helper");
  dlclose(helper);

  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().id, "plugin_needs_library");
  EXPECT_THAT(loaded.error().message, HasSubstr("libzoo_helper.so"));
}

TEST(ZooOfInitialisers, AreRefusedBeforeTheyRun) {
#if defined(MAUVE_SANITIZE_ADDRESS_UNDEFINED) || defined(MAUVE_SANITIZE_THREAD)
  GTEST_SKIP() << "sanitizers add initialisers of their own, so here they cannot be distinguished";
#endif
  Catalog catalog({MAUVE_ZOO});

  const Status loaded = catalog.load("static_initialiser");

  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().id, "plugin_static_initialiser");
  EXPECT_THAT(loaded.error().message, HasSubstr("static_initialiser"));
  EXPECT_THAT(loaded.error().hint, HasSubstr("constexpr"));
}

TEST(ZooOfInitialisers, AreTracedToTheHeaderOrOptionThatBringsThem) {
#if defined(MAUVE_SANITIZE_ADDRESS_UNDEFINED) || defined(MAUVE_SANITIZE_THREAD)
  GTEST_SKIP() << "sanitizers add initialisers of their own, so here they cannot be distinguished";
#endif
  Catalog catalog({MAUVE_ZOO});

  const Status iostream = catalog.load("iostream");
  const Status fast_math = catalog.load("fast_math");

  ASSERT_FALSE(iostream);
  EXPECT_THAT(iostream.error().message, HasSubstr("includes <iostream>"));
  EXPECT_THAT(iostream.error().message, HasSubstr("std::ios_base::Init"));
  EXPECT_THAT(iostream.error().hint, HasSubstr("include <ostream>"));
  ASSERT_FALSE(fast_math);
  EXPECT_EQ(fast_math.error().id, "plugin_fast_math");
  EXPECT_THAT(fast_math.error().message, HasSubstr("linked with -ffast-math"));
  EXPECT_THAT(fast_math.error().hint, HasSubstr("link without -ffast-math"));
}

TEST(ZooOfTextRelocations, IsRefusedWhereItCanBeBuilt) {
  if (!std::filesystem::exists(zoo_file("text_relocation.so"))) {
    GTEST_SKIP() << "the assembler line of this plugin is for x86_64";
  }
  Catalog catalog({MAUVE_ZOO});

  const Status loaded = catalog.load("text_relocation");

  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().id, "plugin_unsafe_memory");
  EXPECT_THAT(loaded.error().hint, HasSubstr("-fPIC"));
}

TEST(ZooOfConstructors, ThrowToTheirCallerAndLeaveNoUser) {
  Catalog catalog({MAUVE_ZOO});
  ASSERT_TRUE(catalog.load("throwing_constructor"));

  std::string what;
  try {
    make_core(catalog, "throwing_constructor/number");
  } catch (const std::exception& error) {
    what = error.what();
  }

  EXPECT_EQ(what, "no hardware");
  const auto unloaded = catalog.unload("throwing_constructor");
  ASSERT_TRUE(unloaded) << to_string(unloaded.error());
  EXPECT_TRUE(unloaded->unmapped) << unloaded->reason;
}

TEST(ZooOfNames, RefusesAPluginUnderAnotherFileName) {
  const PluginDir folder;
  folder.put("1/good.so", "better.so");
  Catalog catalog(folder.list());

  const Status loaded = catalog.load("better");

  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("its name is \"good\""));
  EXPECT_EQ(loaded.error().at, (folder / "better.so").string());
}

TEST(ZooOfTypes, RefusesAnotherLayoutUnderTheSameName) {
  const PluginDir folder;
  folder.put("1/good.so", "good.so");
  folder.put("other_layout.so", "other_layout.so");
  Catalog catalog(folder.list());
  ASSERT_TRUE(catalog.load("good"));

  const Status loaded = catalog.load("other_layout");

  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, Errc::type_mismatch);
  EXPECT_EQ(loaded.error().at, "zoo_number/1");
  EXPECT_EQ(catalog.find("other_layout"), nullptr);
  EXPECT_TRUE(catalog.type("zoo_number/1"));
}

TEST(ZooOfDeclarations, AreRefusedByTheFileThatTheyAreIn) {
  Catalog catalog({MAUVE_ZOO});

  const Status loaded = catalog.load("throwing_declare");

  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().at, zoo_file("throwing_declare.so").string());
}

}  // namespace
}  // namespace mauve::plugin::test
