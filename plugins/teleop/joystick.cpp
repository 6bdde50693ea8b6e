// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "teleop/joystick": the events of a Linux input device, read from
/// /dev/input/event*, a FIFO or a pseudo-terminal; one write to port `joystick` each period. A
/// device that is missing or goes away is looked for again every `retry`; meanwhile the joystick
/// that is written is marked as not connected. A thread of its own (mauve/serial/line_thread.h)
/// opens and reads the device, so that a job makes no system call for it. Example: mauvectl watch
/// teleop.core.steering joystick.core.connected
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include <mauve/job.h>
#include <mauve/log.h>
#include <mauve/serial/line_thread.h>

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
    line_.fill(bytes_);
    const bool open = line_.open();  // then the bytes from before it failed are there
    read();
    if (!open) find();
    let_go_when_silent();
    Joystick now = reader_.shown();
    now.time = last_event_;
    now.connected = connected_;
    connected = connected_;
    shell().joystick.write(now);
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<std::string> device{*this,
                                      "device",
                                      "/dev/input/event0",
                                      "input device, or a FIFO that carries its events",
                                      {.within = "/dev/"}};
  mauve::Property<int> axis_min{*this, "axis_min", -32767,
                                "of axes of a device that does not state its ranges"};
  mauve::Property<int> axis_max{*this, "axis_max", 32767,
                                "of axes of a device that does not state its ranges"};
  mauve::Property<mauve::Duration> retry{
      *this, "retry", 100ms, "between two looks for a lost device", {.min = 1ms, .max = 60s}};
  mauve::Property<mauve::Duration> event_timeout{
      *this,
      "event_timeout",
      0ns,
      "what is held counts as let go without an event for so long; 0: never",
      {.min = 0ns, .max = 3600s}};
  mauve::Warning silent{*this, "silent", "what was held counts as let go, or it sends no events"};
  mauve::Observable<bool> connected{*this, "connected", false, "the device is there"};
  mauve::Observable<std::uint64_t> reports{*this, "reports", 0, "complete reports of the device"};
  mauve::Observable<std::uint64_t> dropped{*this, "dropped", 0, "times the kernel dropped events"};
  mauve::Observable<std::uint64_t> device_errors{*this, "device_errors", 0, "times it went away"};
  mauve::Observable<std::uint64_t> reopened{*this, "reopened", 0, "times it came back"};
  mauve::Observable<std::uint64_t> received{*this, "received", 0, "bytes from its line"};

  mauve::Status on_configure() override {
    if (axis_min >= axis_max) return mauve::invalid(axis_max, "must be above axis_min");
    device_.choose(device, retry.get());
    static_cast<void>(device_.reopen());
    line_.when_received([this](std::size_t count) { received += count; });
    begin();
    return line_.start(device_, 0);
  }
  void on_cleanup() override {
    line_.stop();
    line_.empty_handed(bytes_);
    device_.close();
  }

  /// Every device states its own ranges; one that does not has those of the properties.
  void begin() {
    constexpr std::size_t kFirstOfHat = 6;
    for (std::size_t axis = 0; axis < Joystick::kAxes; ++axis) {
      ranges_[axis] = axis < kFirstOfHat ? AxisRange{axis_min, axis_max} : AxisRange{-1, 1};
      reader_.set_range(axis, ranges_[axis]);
    }
    reader_.begin();
  }

  void find() {
    gone();
    const mauve::Instant now = mauve::job_time();
    if (now < next_look_) return;
    next_look_ = now + retry->count();
    static_cast<void>(line_.reopen());
  }

  void read() {
    for (int left = kEventsPerJob; left > 0 && bytes_.ring.size() >= sizeof(input_event); --left) {
      std::array<char, sizeof(input_event)> bytes{};
      for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = bytes_.ring.there(i).front();
      bytes_.ring.drop(bytes.size());
      input_event event;
      std::memcpy(&event, bytes.data(), sizeof event);
      if (event.type == Mark::kType) {
        learn(event.code, event.value);
      } else {
        take(bytes);
      }
    }
  }

  void learn(std::uint16_t code, std::int32_t value) {
    if (code == Mark::kThere) return there();
    if (code == Mark::kGone) return gone();
    const std::size_t axis = code & 0xffU;
    if (axis >= ranges_.size()) return;
    (code < Mark::kHighest ? ranges_[axis].min : ranges_[axis].max) = value;
    reader_.set_range(axis, ranges_[axis]);
  }

  void take(std::span<const char> bytes) {
    const std::size_t complete = reader_.push(bytes);
    if (complete == 0) {
      if (++fragments_ == kMostFragments) {
        silent.begin("its device sends no events of an input device: is it /dev/input/js*?");
      }
      return;
    }
    fragments_ = 0;
    silent.end("its device sends events");
    reports += complete;
    heard_ = mauve::job_time();
    last_event_ = std::chrono::duration<double>(mauve::Duration{mauve::job_time()}).count();
    if (reader_.take_dropped()) ++dropped;
  }

  /// The receiver of a wireless joystick stays when the joystick is out of reach. Its last events
  /// would keep the robot moving.
  void let_go_when_silent() {
    const bool held = reader_.holds();
    if (event_timeout.get() == 0ns || !held) return;
    if (mauve::job_time() - heard_ < event_timeout.get().count()) return;
    reader_.begin();
    silent.begin("it holds, and sends no event: all counts as let go");
  }

  void there() {
    heard_ = mauve::job_time();
    begin();
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
  }

  static constexpr int kEventsPerJob = 512;  // more waits for the next job
  /// Events without the end of a report: a report has a few, a joystick may have 56 at once.
  static constexpr int kMostFragments = 200;

  EventReader reader_;
  std::array<AxisRange, Joystick::kAxes> ranges_{};
  InputDevice device_;
  mauve::serial::LineBytes bytes_;
  mauve::serial::LineThread line_;  // ends before both
  mauve::Instant next_look_ = 0;
  mauve::Instant heard_ = 0;  // the last report
  int fragments_ = 0;         // events since then
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
