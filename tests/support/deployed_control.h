// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component guidance/control with its real plugin, deployed on a simulated clock: commands come
/// out of its state machine, and cores are swapped by the runtime, with its hand-over of state.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

#include "../../plugins/types/pose.h"
#include "../../plugins/types/scan.h"
#include "../../plugins/types/velocity.h"
#include "arch/build/load.h"
#include "plugin/load/catalog.h"
#include "support/drive.h"

namespace support {

class DeployedControl {
 public:
  /// `core` as "guidance/finite_time". Look at error() before anything else.
  DeployedControl(mauve::plugin::Catalog& catalog, const std::string& core) : catalog_(catalog) {
    mauve::arch::Problems problems;
    architecture_ = mauve::arch::load(text(core), catalog_, problems);
    for (const auto& problem : problems.sorted()) error_ += to_string(problem.error) + "\n";
    if (architecture_ == nullptr) return;
    deployer_ = std::make_unique<mauve::Deployer>(
        *architecture_, mauve::DeployOptions{mauve::Realtime::off, true, mauve::Admission::off});
    if (const mauve::Status up = deployer_->deploy(); !up) error_ = to_string(up.error());
  }

  [[nodiscard]] const std::string& error() const { return error_; }

  void aim(const rover::Point2D& goal) { write("goal", goal); }
  /// One step of 10 ms: the command of control at this pose, with this scan.
  [[nodiscard]] rover::Velocity step(const rover::Pose2D& pose, const rover::LaserScan& scan) {
    write("pose", pose);
    write("scan", scan);
    deployer_->run_for(std::chrono::milliseconds(10));
    rover::Velocity command;
    mauve::Cursor cursor;
    cursor.slot = ~0U;  // no private one
    static_cast<void>(
        architecture_->find_resource("command")->find_service("read")->read(&command, cursor));
    return command;
  }
  /// Bytes of state handed over; empty when the swap was refused or not at once in force.
  [[nodiscard]] std::optional<std::size_t> swap(std::string_view core) {
    const auto type = catalog_.core(core);
    if (!type) return std::nullopt;
    const mauve::Result<mauve::Receipt> done = deployer_->swap_core("control", *type);
    if (!done || done->state != mauve::ChangeState::applied || done->components.size() != 1) {
      return std::nullopt;
    }
    return done->components[0].bytes;
  }
  /// Releases that were missed since the beginning.
  [[nodiscard]] std::uint64_t missed() const { return deployer_->status("control").missed; }

 private:
  template <typename T>
  void write(const char* resource, const T& value) {
    architecture_->find_resource(resource)->find_service("write")->write(&value);
  }
  static std::string text(const std::string& core) {
    return R"({ "schema": "mauve/architecture/1", "name": "control",
      "plugins": ["types", "guidance"],
      "resources": {
        "pose": { "type": "shared_data", "data": "pose2d/1" },
        "goal": { "type": "shared_data", "data": "point2d/1" },
        "scan": { "type": "shared_data", "data": "laser_scan/1" },
        "command": { "type": "shared_data", "data": "velocity/1" } },
      "components": {
        "control": { "type": "guidance/control", "core": ")" +
           core + R"(",
          "properties": { "fsm.idle": "10ms" },
          "ports": { "pose": "pose.read", "goal": "goal.read", "scan": "scan.read",
                     "command": "command.write" } } } })";
  }

  mauve::plugin::Catalog& catalog_;
  std::unique_ptr<mauve::Architecture> architecture_;
  std::unique_ptr<mauve::Deployer> deployer_;
  std::string error_;
};

/// A drive in which the other core takes over.
struct SwapDrive {
  drive::Outcome run;
  bool swapped = false;      ///< and goal, command and side were handed over
  std::uint64_t missed = 0;  ///< releases
};

/// With the swap after so many seconds, or at the end when it is there before.
inline SwapDrive drive_and_swap(DeployedControl& control, const char* other, double after,
                                const drive::World& world, const rover::Point2D& goal,
                                std::uint64_t seed, const drive::Conditions& conditions) {
  SwapDrive result;
  drive::Drive drive(world, conditions, {}, seed);
  control.aim(goal);
  while (!drive.over() && !result.run.reached) {
    drive.look();
    drive.go(control.step(drive.pose(), drive.scan()));
    result.run.reached = rover::distance(drive.pose(), goal) < drive::kArrived;
    const bool now = drive.outcome().seconds >= after || result.run.reached;
    if (now && !result.swapped) {
      result.swapped = control.swap(other).value_or(0) > 0;
      after = drive::kNever;
    }
  }
  drive.outcome().reached = result.run.reached;
  result.run = std::move(drive.outcome());
  result.missed = control.missed();
  return result;
}

}  // namespace support
