// SPDX-License-Identifier: LGPL-3.0-or-later
/// A robot that finds its way through the building of etc/maps: map server, navigation, guidance,
/// pilot and world, with their real plugins on a simulated clock.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

#include "arch/build/load.h"
#include "plugin/load/catalog.h"
#include "support/proved_deployer.h"

namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using mauve::Value;

const std::string kMap =
    (std::filesystem::path(MAUVE_SOURCE_DIR) / "etc/maps/building.yaml").string();

/// `discs` stand in the world and not on the map.
std::string architecture(const std::string& discs, const std::string& goal) {
  return R"({
  "schema": "mauve/architecture/1", "name": "finds_its_way",
  "plugins": ["types", "drivers", "guidance", "navigation", "safety"],
  "resources": {
    "world": { "type": "drivers/world",
               "properties": { "core.map": ")" +
         kMap + R"(", "core.obstacles": [)" + discs + R"(] } },
    "odometry": { "type": "shared_data", "data": "odometry/2" },
    "pose": { "type": "shared_data", "data": "pose2d/1" },
    "goal": { "type": "shared_data", "data": "point2d/1" },
    "target": { "type": "shared_data", "data": "point2d/1" },
    "scan": { "type": "shared_data", "data": "laser_scan/1" },
    "map": { "type": "shared_data", "data": "occupancy_grid/1" },
    "path": { "type": "shared_data", "data": "path/1" },
    "command": { "type": "shared_data", "data": "velocity/1" },
    "safe_command": { "type": "shared_data", "data": "velocity/1" }
  },
  "components": {
    "robot": { "type": "drivers/robot_sim",
      "properties": { "fsm.period": "10ms", "core.step": "10ms" },
      "ports": { "command": "safe_command.read", "odometry": "odometry.write", "pose": "pose.write",
                 "drive": "world.drive" },
      "task": { "priority": 70 } },
    "laser": { "type": "drivers/laser_sim", "properties": { "fsm.period": "25ms" },
      "ports": { "scan": "scan.write", "world": "world.scan" }, "task": { "priority": 60 } },
    "safety": { "type": "safety/pilot",
      "properties": { "core.stop_distance": 0.4, "core.slow_distance": 0.8,
                      "core.half_width": 0.3 },
      "ports": { "command": "command.read", "scan": "scan.read",
                 "safe_command": "safe_command.write" },
      "task": { "priority": 65 } },
    "control": { "type": "guidance/control", "core": "guidance/potential_field",
      "properties": { "core.obstacle_distance": 0.55, "core.safety_distance": 0.4 },
      "ports": { "pose": "pose.read", "goal": "target.read", "scan": "scan.read",
                 "command": "command.write" },
      "task": { "priority": 40 } },
    "mission": { "type": "guidance/mission",
      "properties": { "core.goal": )" +
         goal + R"(, "fsm.period": "100ms" },
      "ports": { "goal": "goal.write" }, "task": { "priority": 20 } },
    "navigation": { "type": "navigation/navigation",
      "ports": { "goal": "goal.read", "map": "map.read", "pose": "pose.read", "scan": "scan.read",
                 "target": "target.write", "path": "path.write" },
      "task": { "priority": 10 } },
    "map_server": { "type": "navigation/map_server",
      "properties": { "core.file": ")" +
         kMap + R"(" },
      "ports": { "map": "map.write" }, "task": { "priority": 5 } }
  }
})";
}

class Building {
 public:
  explicit Building(const std::string& text) : catalog_({MAUVE_PLUGIN_DIR}) {
    mauve::arch::Problems problems;
    architecture_ = mauve::arch::load(text, catalog_, problems);
    for (const auto& problem : problems.sorted()) ADD_FAILURE() << to_string(problem.error);
    if (architecture_ == nullptr) return;
    deployer_ = std::make_unique<mauve::test::ProvedDeployer>(
        *architecture_, mauve::DeployOptions{mauve::Realtime::off, true, mauve::Admission::off});
    const mauve::Status up = deployer_->deploy();
    EXPECT_TRUE(up) << (up ? "" : to_string(up.error()));
  }

  [[nodiscard]] mauve::test::ProvedDeployer& deployer() { return *deployer_; }
  [[nodiscard]] double observe(const std::string& owner, const std::string& name) const {
    const auto* component = architecture_->find_component(owner);
    const mauve::CoreBase& core =
        component != nullptr ? component->core() : architecture_->find_resource(owner)->core();
    const Value value = core.find_observable(name)->value();
    if (const auto* integer = value.get_if<std::int64_t>()) return static_cast<double>(*integer);
    return *value.get_if<double>();
  }
  bool run_until(const std::function<bool()>& condition, mauve::Duration limit) {
    for (mauve::Duration passed{0}; passed < limit; passed += 50ms) {
      if (condition()) return true;
      deployer_->run_for(50ms);
    }
    return condition();
  }
  bool drive_to_the_goal(mauve::Duration limit = 180s) {
    return run_until([&] { return observe("navigation", "goals_reached") > 0.0; }, limit);
  }
  void expect_at(double x, double y) const {
    EXPECT_NEAR(observe("world", "x"), x, 0.6);
    EXPECT_NEAR(observe("world", "y"), y, 0.6);
  }
  void expect_stands() {
    const double x = observe("world", "x");
    const double y = observe("world", "y");
    deployer_->run_for(2s);
    EXPECT_DOUBLE_EQ(observe("world", "x"), x);
    EXPECT_DOUBLE_EQ(observe("world", "y"), y);
  }

 private:
  mauve::plugin::Catalog catalog_;
  std::unique_ptr<mauve::Architecture> architecture_;
  std::unique_ptr<mauve::test::ProvedDeployer> deployer_;
};

TEST(NavigationSimulated, DrivesThroughTwoRoomsToItsGoal) {
  Building building(architecture("", R"({ "x": 14.0, "y": -3.8 })"));

  EXPECT_TRUE(building.drive_to_the_goal()) << "office, then meeting room";

  building.expect_at(14.0, -3.8);
  EXPECT_GT(building.observe("world", "nearest"), 0.0);
  EXPECT_EQ(building.observe("navigation", "plans"), 1.0) << "what is seen is what is on the map";
}

TEST(NavigationSimulated, FindsAnotherDoorWhenTheFirstIsBlocked) {
  // The door between yard and office is shut: that is not on the map.
  Building building(architecture(R"({ "at": { "x": 8.1, "y": -3.2 }, "radius": 0.35 },
                                    { "at": { "x": 8.1, "y": -2.5 }, "radius": 0.35 })",
                                 R"({ "x": 10.0, "y": -2.0 })"));

  EXPECT_TRUE(building.drive_to_the_goal());

  building.expect_at(10.0, -2.0);
  EXPECT_GT(building.observe("navigation", "blocked"), 0.0);
  EXPECT_GT(building.observe("world", "nearest"), 0.0);
}

TEST(NavigationSimulated, StandsAndSaysSoWhenThereIsNoWay) {
  Building building(architecture("", R"({ "x": 19.0, "y": -4.2 })"));

  ASSERT_TRUE(
      building.run_until([&] { return building.observe("navigation", "answer") > 1.0; }, 10s));

  EXPECT_EQ(building.observe("navigation", "answer"), 3.0) << "in the locked store";
  building.expect_stands();

  // Another goal is driven to as if nothing had been.
  ASSERT_TRUE(
      building.deployer().set("mission.core.goal", Value(Value::Object{{"x", 3.0}, {"y", 1.0}})));
  EXPECT_TRUE(building.drive_to_the_goal());
  building.expect_at(3.0, 1.0);
}

TEST(NavigationSimulated, GoesOnWhenItsCoreIsExchangedOnTheWay) {
  Building building(architecture("", R"({ "x": 12.0, "y": 5.0 })"));
  ASSERT_TRUE(building.run_until([&] { return building.observe("world", "x") > 3.0; }, 60s));

  const auto done = building.deployer().set("navigation.core.keep_away", Value(0.5));

  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_GT(done->components.at(0).bytes, 0U) << "the way is handed over";
  EXPECT_TRUE(building.drive_to_the_goal());
  building.expect_at(12.0, 5.0);
}

}  // namespace
