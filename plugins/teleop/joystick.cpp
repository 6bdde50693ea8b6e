// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "teleop/joystick": the events of a Linux input device, read from
/// /dev/input/event*, a FIFO or a pseudo-terminal; one write to port `joystick` each period.
/// A device that is missing or goes away is looked for again every `retry`; meanwhile the joystick
/// written says that it is not connected. Opening happens on this component's thread: give it a
/// priority below what must not wait for a slow USB driver.
/// Example: mauvectl watch teleop.core.steering joystick.core.connected
#include <array>
#include <chrono>
#include <cstdint>
#include <string>

#include <mauve/job.h>
#include <mauve/log.h>

#include "event_reader.h"
#include "input_device.h"
#include "parts.h"

namespace teleop {
namespace {

using rover::Joystick;
using namespace std::chrono_literals;  // NOLINT: durations of properties

struct JoystickShell : mauve::Shell {
  mauve::WritePort<Joystick> joystick{*this, "joystick", mauve::Safe{Joystick{}}};
};

class JoystickDriver final : public mauve::Core<JoystickShell> {
 public:
  void update() {
    if (!connected_) find();
    if (device_.is_open()) read();
    Joystick now = reader_.shown();
    now.time = last_event_;
    now.connected = connected_;
    connected = connected_;
    shell().joystick.write(now);
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<std::string> device{*this, "device", "/dev/input/event0",
                                      "input device, or a FIFO that carries its events"};
  mauve::Property<int> axis_min{*this, "axis_min", -32767,
                                "of axes of a device that does not tell its ranges"};
  mauve::Property<int> axis_max{*this, "axis_max", 32767,
                                "of axes of a device that does not tell its ranges"};
  mauve::Property<mauve::Duration> retry{
      *this, "retry", 100ms, "between two looks for a lost device", {.min = 1ms, .max = 60s}};
  mauve::Observable<bool> connected{*this, "connected", false, "the device is there"};
  mauve::Observable<std::uint64_t> reports{*this, "reports", 0, "complete reports of the device"};
  mauve::Observable<std::uint64_t> dropped{*this, "dropped", 0, "times the kernel dropped events"};
  mauve::Observable<std::uint64_t> device_errors{*this, "device_errors", 0, "times it went away"};
  mauve::Observable<std::uint64_t> reopened{*this, "reopened", 0, "times it came back"};

  mauve::Status on_configure() override {
    if (axis_min >= axis_max) return mauve::invalid(axis_max, "must be above axis_min");
    device_.name(device);
    begin();
    return mauve::ok();
  }
  void on_cleanup() override { device_.close(); }

  /// Every device tells its own ranges; one that does not has those of the properties.
  void begin() {
    constexpr std::size_t kFirstOfHat = 6;
    for (std::size_t axis = 0; axis < Joystick::kAxes; ++axis) {
      reader_.set_range(axis,
                        axis < kFirstOfHat ? AxisRange{axis_min, axis_max} : AxisRange{-1, 1});
    }
    reader_.begin();
  }

  void find() {
    const mauve::Instant now = mauve::job_time();
    if (now < next_look_) return;
    next_look_ = now + retry->count();
    if (device_.is_open() && device_.is_file()) return;
    if (device_.open()) {
      begin();
      static_cast<void>(device_.ask(reader_));
    } else {
      device_.close();
    }
  }

  void read() {
    for (int block = 0; block < kBlocksPerJob; ++block) {
      std::size_t count = 0;
      switch (device_.read(bytes_, count)) {
        case InputDevice::Got::bytes:
          there();
          take({bytes_.data(), count});
          break;
        case InputDevice::Got::nothing:
          there();
          return;
        case InputDevice::Got::nobody:
          gone();
          return;
        case InputDevice::Got::lost:
          gone();
          device_.close();
          return;
      }
    }
  }

  void take(std::span<const char> bytes) {
    const std::size_t complete = reader_.push(bytes);
    if (complete == 0) return;
    reports += complete;
    last_event_ = std::chrono::duration<double>(mauve::Duration{mauve::job_time()}).count();
    if (!reader_.take_dropped()) return;
    ++dropped;
    static_cast<void>(device_.ask(reader_));
  }

  void there() {
    if (connected_) return;
    connected_ = true;
    if (had_one_) ++reopened;
    had_one_ = true;
    mauve::log(mauve::LogLevel::info, "its joystick is there");
  }

  void gone() {
    if (!connected_) return;
    connected_ = false;
    ++device_errors;
    mauve::log(mauve::LogLevel::warning, "its joystick is gone");
    begin();
    next_look_ = mauve::job_time() + retry->count();
  }

  static constexpr int kBlocksPerJob = 8;  // more waits for the next job

  EventReader reader_;
  InputDevice device_;
  std::array<char, 64 * sizeof(input_event)> bytes_{};
  mauve::Instant next_look_ = 0;
  double last_event_ = 0.0;
  // The observables go on from an earlier core; these are about this core's own descriptor.
  bool connected_ = false;
  bool had_one_ = false;
};

}  // namespace

void declare_joystick(mauve::Plugin& plugin) {
  plugin.component<JoystickShell, JoystickDriver, mauve::PeriodicFsm<JoystickDriver>>("joystick");
}

}  // namespace teleop
