// SPDX-License-Identifier: LGPL-3.0-or-later
/// The drivers of a Hokuyo scanner and of a Create 2 in a small architecture, on a simulated clock.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <mauve/detail/job.h>
#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/observable.h>

#include "arch/build/load.h"
#include "plugin/load/catalog.h"
#include "support/eventually.h"
#include "support/proved_deployer.h"
#include "support/settled_lines.h"

namespace robot {

using namespace std::chrono_literals;  // NOLINT: durations
using mauve::Value;

inline constexpr const char* kHead = R"({ "schema": "mauve/architecture/1", "name": "drivers",
  "plugins": ["types", "drivers", "safety"],
  "resources": {
    "world": { "type": "drivers/world", "properties": { "core.laser_noise": 0.0,
      "core.speed_disturbance": 0.0, "core.turn_disturbance": 0.0,
      "core.obstacles": [ { "at": { "x": 4.0, "y": 0.0 }, "radius": 0.5 } ] } },
    "brake": { "type": "drivers/create_brake", "properties": { "core.device": "BASE" } },
    "scan": { "type": "shared_data", "data": "laser_scan/1" },
    "odometry": { "type": "shared_data", "data": "odometry/2" },
    "twist": { "type": "shared_data", "data": "twist/1" },
    "command": { "type": "shared_data", "data": "velocity/1" },
    "safe_command": { "type": "shared_data", "data": "velocity/1" } },
  "components": {)";
inline constexpr const char* kSimulators = R"(
    "scanner": { "type": "drivers/hokuyo_sim", "properties": { "fsm.period": "25ms" },
      "ports": { "world": "world.scan" } },
    "wheels": { "type": "drivers/create_sim", "properties": { "fsm.period": "15ms" },
      "ports": { "drive": "world.drive" } },)";
inline constexpr const char* kPilot = R"(
    "cruise": { "type": "safety/cruise",
      "properties": { "core.velocity": { "linear": 0.4, "angular": 0.0 } },
      "ports": { "command": "command.write" } },
    "pilot": { "type": "safety/pilot",
      "properties": { "core.stop_distance": 0.5, "core.slow_distance": 1.0 },
      "ports": { "command": "command.read", "scan": "scan.read",
                 "safe_command": "safe_command.write" } },)";
inline constexpr const char* kLaser = R"(
    "laser": { "type": "drivers/hokuyo", "properties": { "core.device": "LASER" },
      "ports": { "scan": "scan.write" } })";
inline constexpr const char* kBase = R"(
    "base": { "type": "drivers/create", "properties": { "core.device": "BASE", "core.baud": 0 },
      "ports": { "command": "safe_command.read", "odometry": "odometry.write",
                 "twist": "twist.write", "brake": "brake.write" } })";

class System {
 public:
  System(const std::string& components, const std::string& laser, const std::string& base)
      : catalog_({MAUVE_PLUGIN_DIR}) {
    std::string text = kHead + components + "} }";
    replace(text, "LASER", laser);
    replace(text, "BASE", base);
    mauve::arch::Problems problems;
    architecture_ = mauve::arch::load(text, catalog_, problems);
    EXPECT_TRUE(architecture_ != nullptr)
        << (problems.empty() ? "" : to_string(problems.sorted()[0].error));
    if (architecture_ == nullptr) return;
    deployer_ = std::make_unique<mauve::test::ProvedDeployer>(
        *architecture_, mauve::DeployOptions{mauve::Realtime::off, true, mauve::Admission::warn});
    deployed_ = deployer_->deploy();
  }

  [[nodiscard]] const mauve::Status& deployed() const { return deployed_; }
  [[nodiscard]] mauve::test::ProvedDeployer& deployer() { return *deployer_; }

  [[nodiscard]] double observe(const std::string& owner, const std::string& name) const {
    const auto* component = architecture_->find_component(owner);
    const mauve::CoreBase& core =
        component != nullptr ? component->core() : architecture_->find_resource(owner)->core();
    const Value value = core.find_observable(name)->value();
    if (const auto* integer = value.get_if<std::int64_t>()) return static_cast<double>(*integer);
    if (const auto* truth = value.get_if<bool>()) return *truth ? 1.0 : 0.0;
    return *value.get_if<double>();
  }
  /// Of a warning that lasts.
  [[nodiscard]] std::string reason(const std::string& owner, const std::string& name) const {
    const auto& core = architecture_->find_component(owner)->core();
    return std::string(dynamic_cast<mauve::Warning*>(core.find_observable(name))->reason());
  }
  /// The value of a resource; its default when there is none.
  template <typename T>
  [[nodiscard]] T read(const std::string& resource) const {
    mauve::ServiceBase& service = *architecture_->find_resource(resource)->find_service("read");
    mauve::Cursor cursor{service.attach(), 0, 0};
    T value{};
    static_cast<void>(service.read(&value, cursor));
    service.detach(cursor.slot);
    return value;
  }
  /// Writes as a job that runs now.
  template <typename T>
  void write(const std::string& resource, const T& value) {
    const mauve::Instant before = mauve::this_job().start;
    mauve::this_job().start = deployer_->clock().now();
    architecture_->find_resource(resource)->find_service("write")->write(&value);
    mauve::this_job().start = before;
  }
  void set(const std::string& address, const Value& value) {
    const auto done = deployer_->set(address, value);
    EXPECT_TRUE(done) << (done ? "" : to_string(done.error()));
  }

  /// Lets time pass, 10 ms at a time, until it is so; the bytes come along.
  [[nodiscard]] bool run_until(const std::function<bool()>& condition) {
    const auto is_so = [&] {
      deployer_->run_for(10ms);
      lines_.wait();
      if (meanwhile_) meanwhile_();
      return condition();
    };
    // Thousands of steps, each of which waits for other threads, beside builds.
    return mauve::test::eventually(is_so, std::chrono::minutes(3));
  }
  /// The work that the test does every 10 ms.
  void meanwhile(std::function<void()> work) { meanwhile_ = std::move(work); }
  [[nodiscard]] bool reaches(const std::string& owner, const std::string& name, double least) {
    return run_until([=, this] { return observe(owner, name) >= least; });
  }
  [[nodiscard]] bool goes_on(const std::string& owner, const std::string& name, double by) {
    return reaches(owner, name, observe(owner, name) + by);
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
  mauve::Status deployed_ = mauve::ok();
  std::function<void()> meanwhile_;
  mauve::test::SettledLines lines_;
};

}  // namespace robot
