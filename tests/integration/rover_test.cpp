// SPDX-License-Identifier: LGPL-3.0-or-later
/// etc/yard.json with its real plugins on a simulated clock: every job of every component, in
/// order.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

#include "arch/build/load.h"
#include "plugin/load/catalog.h"
#include "support/eventually.h"
#include "support/proved_deployer.h"
#include "support/test_data.h"

namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using mauve::Deployer;
using mauve::Receipt;
using mauve::Value;
using mauve::test::eventually;

const std::filesystem::path kRoot = MAUVE_SOURCE_DIR;

/// One of the architectures of etc/, deployed without threads.
class Simulated {
 public:
  /// `sample`: what to read in place of the GNSS sample.
  explicit Simulated(const std::string& name, const std::string& sample = {},
                     mauve::Admission admission = mauve::Admission::warn)
      : catalog_({MAUVE_PLUGIN_DIR}) {
    std::string text = support::bytes_of(kRoot / "etc" / name);
    if (!sample.empty()) replace(text, "samples/gnss.nmea", sample);
    // Paths in an architecture begin at its file.
    replace(text, "\"samples/", "\"" + (kRoot / "etc/samples/").string());
    mauve::arch::Problems problems;
    architecture_ = mauve::arch::load(text, catalog_, problems);
    EXPECT_TRUE(architecture_ != nullptr) << name;
    if (architecture_ == nullptr) return;
    deployer_ = std::make_unique<mauve::test::ProvedDeployer>(
        *architecture_, mauve::DeployOptions{mauve::Realtime::off, true, admission});
    const mauve::Status up = deployer_->deploy();
    EXPECT_TRUE(up) << (up ? "" : to_string(up.error()));
  }

  [[nodiscard]] mauve::test::ProvedDeployer& deployer() { return *deployer_; }
  [[nodiscard]] auto core(const std::string& name) const { return catalog_.core(name); }
  [[nodiscard]] mauve::TaskAttributes task(const std::string& component) const {
    return architecture_->find_component(component)->bundle()->task;
  }
  void load(const std::string& plugin) { EXPECT_TRUE(catalog_.load(plugin)); }

  /// The observable "control.core.goals_reached" of a component, or of a resource, as a number.
  [[nodiscard]] double observe(const std::string& owner, const std::string& name) const {
    const auto* component = architecture_->find_component(owner);
    const mauve::CoreBase& core =
        component != nullptr ? component->core() : architecture_->find_resource(owner)->core();
    const Value value = core.find_observable(name)->value();
    if (const auto* integer = value.get_if<std::int64_t>()) return static_cast<double>(*integer);
    return *value.get_if<double>();
  }

  Receipt swap(const std::string& component, const std::string& core) {
    const auto type = catalog_.core(core);
    EXPECT_TRUE(type) << core;
    return checked(deployer_->swap_core(component, *type));
  }

  Receipt checked(const mauve::Result<Receipt>& done) {
    EXPECT_TRUE(done) << (done ? "" : to_string(done.error()));
    if (!done) return {};
    EXPECT_EQ(done->state, mauve::ChangeState::applied);
    for (const auto& member : done->components) EXPECT_EQ(member.missed, 0U) << member.name;
    return *done;
  }

  /// Lets time pass until the condition holds; false when it did not within `limit`.
  bool run_until(const std::function<bool()>& condition, mauve::Duration limit) {
    for (mauve::Duration passed{0}; passed < limit; passed += 10ms) {
      if (condition()) return true;
      deployer_->run_for(10ms);
    }
    return condition();
  }

  bool drive_until_left(double metres) {
    return run_until(
        [&] {
          const double left = observe("control", "distance_to_goal");
          return left > 0.0 && left < metres;
        },
        60s);
  }
  bool drive_to_the_goal() {
    return run_until([&] { return observe("control", "goals_reached") > 0.0; }, 60s);
  }

  void expect_nothing_missed() {
    for (const auto& status : deployer_->status()) {
      EXPECT_EQ(status.missed, 0U) << status.name;
      EXPECT_EQ(status.state, mauve::ComponentState::running) << status.name;
    }
  }

 private:
  static void replace(std::string& text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
      text.replace(at, what.size(), by);
    }
  }

  mauve::plugin::Catalog catalog_;
  std::unique_ptr<mauve::Architecture> architecture_;
  std::unique_ptr<mauve::test::ProvedDeployer> deployer_;
};

TEST(RoverSimulated, ReachesItsGoalWithoutTouching) {
  Simulated rover("yard.json");

  EXPECT_TRUE(rover.drive_to_the_goal());

  EXPECT_GT(rover.observe("world", "nearest"), 0.05);
  rover.expect_nothing_missed();
}

TEST(RoverSimulated, ReachesItsGoalThroughSwapsToCoresKnownAndNew) {
  Simulated rover("yard.json");
  ASSERT_TRUE(rover.drive_until_left(8.0));
  rover.swap("control", "guidance/finite_time");
  ASSERT_TRUE(rover.drive_until_left(4.0));
  rover.load("guidance_extra");
  const Receipt receipt = rover.swap("control", "guidance_extra/widest_gap");

  EXPECT_TRUE(rover.drive_to_the_goal());

  ASSERT_EQ(receipt.components.size(), 1U);
  EXPECT_GT(receipt.components[0].bytes, 0U) << "goal, command and side are handed over";
  EXPECT_EQ(rover.deployer().status("control").core, "guidance_extra/widest_gap");
  EXPECT_GT(rover.observe("world", "nearest"), 0.0);
  rover.expect_nothing_missed();
}

TEST(RoverSimulated, KeepsItsCommandWhenAPropertyChangesOnTheWay) {
  Simulated rover("yard.json");
  ASSERT_TRUE(rover.drive_until_left(10.0));
  rover.deployer().run_for(20ms);
  const double x = rover.observe("world", "x");

  rover.checked(rover.deployer().set("control.core.speed", Value(0.5)));
  rover.deployer().run_for(100ms);

  EXPECT_GT(rover.observe("world", "x"), x + 0.02) << "it did not stop to change its mind";
  rover.expect_nothing_missed();
}

TEST(RoverSimulated, StandsWhenTheControlOrThePilotIsStopped) {
  for (const std::string name : {"control", "safety"}) {
    Simulated rover("yard.json");
    ASSERT_TRUE(rover.drive_until_left(11.0));

    ASSERT_TRUE(rover.deployer().stop({name}));
    rover.deployer().run_for(50ms);
    const double x = rover.observe("world", "x");
    rover.deployer().run_for(1s);

    EXPECT_DOUBLE_EQ(rover.observe("world", "x"), x) << name;
  }
}

TEST(RoverSimulated, StandsWhenTheLaserFallsSilent) {
  Simulated rover("yard.json");
  ASSERT_TRUE(rover.drive_until_left(11.0));

  ASSERT_TRUE(rover.deployer().stop({"laser"}));
  rover.deployer().run_for(1s);
  const double x = rover.observe("world", "x");
  rover.deployer().run_for(1s);

  EXPECT_DOUBLE_EQ(rover.observe("world", "x"), x);
}

TEST(RoverSimulated, HearsItsReceiverThroughTheSerialLine) {
  Simulated rover("yard.json");

  EXPECT_TRUE(eventually([&] {
    rover.deployer().run_for(100ms);
    return rover.observe("gnss", "fixes") >= 5.0;
  }));

  EXPECT_EQ(rover.observe("gnss", "bad_frames"), 0.0);
  EXPECT_EQ(rover.observe("gnss", "satellites"), 9.0);
}

TEST(RoverSimulated, IsProvedToMeetItsDeadlinesAndRefusesACoreThatWouldNot) {
  Simulated rover("yard.json", {}, mauve::Admission::strict);
  const mauve::Timing timing = rover.deployer().analyze();
  EXPECT_TRUE(timing.problems.empty()) << timing.problems.front();
  EXPECT_GT(timing.factor.value_or(0), 1.0);
  mauve::Edit edit;
  edit.member = "control";
  edit.core = *rover.core("guidance/finite_time");
  edit.task = rover.task("control");
  edit.task->budget = 12ms;

  const mauve::Result<Receipt> refused = rover.deployer().apply({{edit}});

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, mauve::Errc::limit);
  EXPECT_EQ(refused.error().at, "control");
  EXPECT_EQ(rover.deployer().generation(), 1U);
  edit.task->budget = 1ms;
  EXPECT_TRUE(rover.deployer().apply({{edit}}));
}

TEST(RoverSimulated, RunsWhoUsesItsWorldOnOneCpu) {
  Simulated rover("yard.json");

  const auto cpus = [&](const char* name) { return rover.deployer().status(name).cpus; };

  EXPECT_EQ(cpus("laser"), cpus("robot"));
  EXPECT_EQ(cpus("receiver"), cpus("robot"));
}

TEST(MinimalSimulated, CountsAndGoesOnCountingAfterASwap) {
  Simulated minimal("minimal.json");
  minimal.deployer().run_for(1s);
  const double count = minimal.observe("counter", "count");
  minimal.swap("counter", "demo/countdown");
  minimal.deployer().run_for(500ms);

  EXPECT_NEAR(count, 100.0, 2.0);
  EXPECT_LT(minimal.observe("counter", "count"), count - 40.0);
  EXPECT_GT(minimal.observe("counter", "count"), 0.0);
}

TEST(ReplaySimulated, PlaysItsSamplesAndKeepsTheRobotSafe) {
  Simulated replay("replay.json");

  // A thread of its own reads the recording, in its own time.
  EXPECT_TRUE(eventually([&] {
    replay.deployer().run_for(100ms);
    return replay.observe("gnss", "fixes") == 26.0 && replay.observe("laser", "scans") == 30.0;
  }));
  replay.deployer().run_for(1s);

  EXPECT_EQ(replay.observe("gnss", "fixes"), 26.0);
  EXPECT_EQ(replay.observe("gnss", "bad_frames"), 0.0);
  EXPECT_EQ(replay.observe("laser", "scans"), 30.0);
  EXPECT_GE(replay.observe("safety", "zone"), 1.0) << "the recording has ended: nothing is sure";
}

TEST(ReplaySimulated, ADeviceThatNeverRunsDryDoesNotHoldUpAJob) {
  Simulated replay("replay.json", "/dev/zero");

  replay.deployer().run_for(1s);

  EXPECT_EQ(replay.observe("gnss", "fixes"), 0.0);
  EXPECT_GT(replay.deployer().status("gnss").releases, 100U);
}

}  // namespace
