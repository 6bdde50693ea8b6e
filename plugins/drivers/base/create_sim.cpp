// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/create_sim": a Create 2 at the far end of a serial line. It obeys the
/// Open Interface (create_oi.h) on a pseudo-terminal, whose other end is the device named by
/// `line`. It drives in the simulated world and streams its encoders, so that the real driver runs
/// on it. Like the real one it drives on at the last speed it was sent. List it before the driver.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include <mauve/serial/simulated_line.h>

#include "../../types/pose.h"
#include "../../types/velocity.h"
#include "../parts.h"
#include "create_oi.h"
#include "simulated_time.h"
#include "wheels.h"

namespace drivers {
namespace {

using rover::Odometry;
using rover::Velocity;

struct WheelsShell : mauve::Shell {
  mauve::CallPort<Odometry(Velocity, double)> drive{*this, "drive", mauve::Need::required};
};

class CreateSim final : public mauve::Core<WheelsShell> {
 public:
  void update() {
    hear();
    const double seconds = simulated_time(step.get());
    const std::optional<Odometry> moved = shell().drive(velocity_of(speeds_, wheels_), seconds);
    if (!moved) return;
    roll({moved->linear, moved->angular}, seconds);
    if (!streaming_) return;
    const create::Frame frame =
        create::frame_of({0, mode_, counted(left_counts_), counted(right_counts_)});
    line.send({frame.data(), frame.size()}, frames, lost);
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::serial::SimulatedLine line{*this, "line", "pty:base"};
  mauve::Property<mauve::Duration> step{*this,
                                        "step",
                                        std::chrono::milliseconds(15),
                                        "simulated in each period: the same as fsm.period",
                                        {.min = std::chrono::microseconds(10), .max = {}}};
  mauve::Observable<std::uint64_t> commands{*this, "commands", 0, "heard"};
  mauve::Observable<std::uint64_t> frames{*this, "frames", 0, "sent"};
  mauve::Observable<std::uint64_t> lost{*this, "lost", 0, "not sent: nobody reads the line"};
  mauve::Observable<double> left{*this, "left", 0.0, "speed of the wheel", "m/s"};
  mauve::Observable<double> right{*this, "right", 0.0, "speed of the wheel", "m/s"};

  mauve::Status on_configure() override {
    mode_ = create::Mode::off;
    streaming_ = false;
    speeds_ = {};
    left_counts_ = right_counts_ = 0.0;
    return line.open();
  }
  void on_cleanup() override { line.close(); }

  void hear() {
    std::array<char, 512> bytes{};
    const std::size_t count = line.receive(bytes);
    for (std::size_t i = 0; i < count; ++i) {
      if (const auto command = heard_.push(bytes[i])) obey(*command);
    }
    left = speeds_.left;
    right = speeds_.right;
  }

  void obey(const create::Command& command) {
    ++commands;
    switch (command.opcode) {
      case create::Opcode::start:
        mode_ = create::Mode::passive;
        speeds_ = {};
        break;
      case create::Opcode::safe:
        mode_ = create::Mode::safe;
        break;
      case create::Opcode::stream:
        streaming_ = true;
        break;
      case create::Opcode::drive_direct:
        if (mode_ == create::Mode::safe) {
          speeds_ = {command.left / 1000.0, command.right / 1000.0};
        }
        break;
    }
  }

  void roll(const Velocity& velocity, double seconds) {
    const double turn = velocity.angular * wheels_.base / 2.0;
    left_counts_ += (velocity.linear - turn) * seconds / wheels_.step();
    right_counts_ += (velocity.linear + turn) * seconds / wheels_.step();
  }
  static std::uint16_t counted(double counts) {
    return static_cast<std::uint16_t>(std::llround(counts) & 0xffff);
  }

  create::CommandReader heard_;
  create::Mode mode_ = create::Mode::off;
  bool streaming_ = false;
  Wheels wheels_;
  WheelSpeeds speeds_;
  double left_counts_ = 0.0;
  double right_counts_ = 0.0;
};

}  // namespace

void declare_create_sim(mauve::Plugin& plugin) {
  plugin.component<WheelsShell, CreateSim, mauve::PeriodicFsm<CreateSim>>("create_sim");
}

}  // namespace drivers
