// SPDX-License-Identifier: LGPL-3.0-or-later
/// Elements of a plugin that a start would refuse are refused when the file is read.
#include <string>

#include <gtest/gtest.h>

#include "arch/build/load.h"
#include "mauve/host/architecture.h"
#include "plugin/load/catalog.h"
#include "unit/arch/sample_plugin.h"

namespace mauve::arch {
namespace {

using sample::ControlCore;
using sample::ControlShell;

struct NoBegin final : Fsm<ControlCore> {
  Exec update{*this, "update", &ControlCore::update};
  Sync pace{*this, "pace", Duration{1'000'000}};
  Status on_configure() override {
    update.then(pace);
    pace.then(update);
    return ok();
  }
};
struct Endless final : Fsm<ControlCore> {
  Exec first{*this, "first", &ControlCore::update};
  Exec second{*this, "second", &ControlCore::update};
  Status on_configure() override {
    start_at(first);
    first.then(second);
    second.then(first);
    return ok();
  }
};
struct DeadEnd final : Fsm<ControlCore> {
  Exec update{*this, "update", &ControlCore::update};
  Sync pace{*this, "pace", Duration{1'000'000}};
  Status on_configure() override {
    start_at(update);
    update.then(pace);
    return ok();
  }
};
struct Unreachable final : Fsm<ControlCore> {
  Exec update{*this, "update", &ControlCore::update};
  Sync pace{*this, "pace", Duration{1'000'000}};
  Sync island{*this, "island", Duration{1'000'000}};
  Status on_configure() override {
    start_at(update);
    update.then(pace);
    pace.then(update);
    island.then(update);
    return ok();
  }
};
struct SameState final : Fsm<ControlCore> {
  Exec update{*this, "update", &ControlCore::update};
  Sync pace{*this, "update", Duration{1'000'000}};
};

struct SameProperty final : ControlCore {
  Property<double> one{*this, "setpoint", 1.0};
  Property<double> other{*this, "setpoint", 2.0};
  void update() override {}
};
struct SameValue final : ControlCore {
  Property<double> one{*this, "error", 1.0};
  Observable<double> other{*this, "error", 2.0};
  void update() override {}
};
struct IllegalName final : ControlCore {
  Property<double> one{*this, "My Prop", 1.0};
  void update() override {}
};
struct SamePortShell final : Shell {
  ReadPort<double> one{*this, "in"};
  ReadPort<double> other{*this, "in"};
};
struct SamePortCore final : Core<SamePortShell> {
  void update() {}
};
struct SameServiceCore final : Core<EmptyShell> {
  void take(const double& /*value*/) {}
};
struct SameService final : Interface<SameServiceCore> {
  WriteService<double> one{*this, "write", &SameServiceCore::take};
  WriteService<double> other{*this, "write", &SameServiceCore::take};
};

Plugin unsound_plugin() {
  Plugin plugin("sample");
  plugin.core<sample::Attract>("attract");
  plugin.core<SameProperty>("same_property");
  plugin.core<SameValue>("same_value");
  plugin.core<IllegalName>("illegal_name");
  plugin.fsm<NoBegin>("no_begin");
  plugin.fsm<Endless>("endless");
  plugin.fsm<DeadEnd>("dead_end");
  plugin.fsm<Unreachable>("unreachable");
  plugin.fsm<SameState>("same_state");
  plugin.component<ControlShell, sample::ControlFsm>("control", "attract");
  plugin.component<SamePortShell, SamePortCore, PeriodicFsm<SamePortCore>>("same_port");
  plugin.resource<EmptyShell, SameServiceCore, SameService>("same_service");
  return plugin;
}

/// The problems of a file with this component or resource, as "WHERE: MESSAGE".
std::string refusal_of(const std::string& kind, const std::string& element) {
  plugin::Catalog catalog;
  EXPECT_TRUE(catalog.add(unsound_plugin()));
  Problems problems;
  const auto made = load(R"({ "schema": "mauve/architecture/1", "name": "unsound", ")" + kind +
                             R"(": { "one": )" + element + " } }",
                         catalog, problems);
  EXPECT_EQ(made, nullptr);
  std::string all;
  for (const Problem& problem : problems.sorted()) {
    EXPECT_FALSE(problem.error.hint.empty() && problem.error.code == Errc::duplicate);
    all += (all.empty() ? "" : "\n") + problem.error.at + ": " + problem.error.message;
  }
  return all;
}
std::string refusal_of_fsm(const std::string& fsm) {
  return refusal_of("components", R"({ "type": "sample/control", "fsm": "sample/)" + fsm + "\" }");
}
std::string refusal_of_core(const std::string& core) {
  return refusal_of("components",
                    R"({ "type": "sample/control", "core": "sample/)" + core + "\" }");
}

TEST(SoundElements, AFileIsRefusedWithAStateMachineThatCannotStart) {
  EXPECT_EQ(refusal_of_fsm("no_begin"), "one.fsm: has no initial state");
  EXPECT_EQ(refusal_of_fsm("endless"),
            "one.fsm.first: execution states form a cycle that never waits: first -> second -> "
            "first");
  EXPECT_EQ(refusal_of_fsm("dead_end"), "one.fsm.pace: has no default successor");
  EXPECT_EQ(refusal_of_fsm("unreachable"),
            "one.fsm.island: can never be reached from the initial state");
}

TEST(SoundElements, AFileIsRefusedWithANameThatIsUsedTwiceInAnElement) {
  EXPECT_EQ(refusal_of_core("same_property"),
            "one.core: \"setpoint\" is the name of more than one property");
  EXPECT_EQ(refusal_of_core("same_value"),
            "one.core: \"error\" is the name of a property and of an observable");
  EXPECT_EQ(refusal_of_fsm("same_state"), "one.fsm: \"update\" is the name of more than one state");
  EXPECT_EQ(refusal_of("components", R"({ "type": "sample/same_port" })"),
            "one.shell: \"in\" is the name of more than one port");
  EXPECT_EQ(refusal_of("resources", R"({ "type": "sample/same_service" })"),
            "one.interface: \"write\" is the name of more than one service");
}

TEST(SoundElements, AFileIsRefusedWithANameThatNoAddressCanHave) {
  EXPECT_EQ(refusal_of_core("illegal_name"), "one.core: property \"My Prop\" is not a name");
}

}  // namespace
}  // namespace mauve::arch
