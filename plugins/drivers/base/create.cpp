// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "drivers/create_oi" of component kind "drivers/create": an iRobot Create 2 on a serial
/// device (create_oi.h). Each period it adds up the encoder counts that the base streamed, writes
/// `odometry`, `pose` and `twist`, and sends the wheels their speeds. Times of `twist` are on the
/// monotonic clock. Example: mauvectl watch base.core.mode
///
/// The base itself drives on for ever at the last speed it was sent. So the driver sends zero when
/// the command is missing, stale, older than `command_timeout`, or no number, and when it is
/// cleaned up. A driver that is stopped, faulted or gone cannot do that: connect its port `brake`
/// to a resource "drivers/create_brake", which the runtime calls then. When mauved itself is killed
/// or stands still, its guardian sends that zero (`stand`).
///
/// While the bumper is pressed the base is not driven forward. When a wheel drops or a cliff is
/// there the base stops by itself and obeys no more (`mode` 1): it is armed again by `mauvectl
/// stop` and `start`, not before. The warning `disobeys` lasts meanwhile, as it does when somebody
/// presses its button or docks it. A base that is silent for `answer_timeout` is begun anew, which
/// stops it, and stands until it reports. So is the base of another `device`. Packets that were not
/// asked for, and another order of packets, do no harm; a frame without one that is needed reports
/// nothing.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include <mauve/job.h>
#include <mauve/serial/device_line.h>

#include "../../types/silence.h"
#include "../parts.h"
#include "../serial/damaged.h"
#include "base_driver.h"
#include "create_oi.h"
#include "wheels.h"

namespace drivers {

/// The state that survives a change: unused bytes, the frame begun, and the wheel odometry.
struct BaseLine {
  mauve::serial::LineBytes bytes;
  create::ReportReader reports;
  WheelOdometry wheels;
  bool begun = false;      // the base may be driving
  bool answers = false;    // it has reported since it was begun
  std::size_t device = 0;  // a number of the name of the line that it is on

  /// Opaque to tools; raise the revision when anything in it changes.
  static constexpr std::string_view type_name = "base_line/4";
  static constexpr auto fields() { return std::tuple{}; }
};

namespace {

using rover::Velocity;

class CreateOi final : public BaseCore {
  using Counter = mauve::Observable<std::uint64_t>;

  mauve::State<BaseLine> state{*this};
  mauve::Guarded stand{*this, "stand"};
  mauve::serial::DeviceLine line_{*this, {.baud = 115'200}};
  mauve::Parameters<Wheels> wheels{*this};
  mauve::Property<mauve::Duration> command_timeout{
      *this, "command_timeout", 500ms, "an older command counts as none", {.min = 1ms, .max = {}}};
  mauve::Property<mauve::Duration> answer_timeout{
      *this, "answer_timeout", 500ms, "silent for so long: begin anew", {.min = 1ms, .max = {}}};
  Counter frames{*this, "frames", 0, "undamaged"};
  Counter bad_frames{*this, "bad_frames", 0, "damaged ones, skipped"};
  Counter lacking_frames{*this, "lacking_frames", 0, "undamaged, without packet 7, 35, 43 or 44"};
  Counter unknown_packets{*this, "unknown_packets", 0, "of numbers that are not known here"};
  Counter jumps{*this, "jumps", 0, "of the counts, discarded: the base began anew"};
  Counter timeouts{*this, "timeouts", 0, "times it fell silent"};
  Counter lost_commands{*this, "lost_commands", 0, "times there was none any more"};
  Counter bad_commands{*this, "bad_commands", 0, "not a number"};
  rover::Silence silence{*this};
  mauve::Warning disobeys{*this, "disobeys", "the base streams, and obeys no command"};
  mauve::Observable<int> mode{*this, "mode", 0, "0 off, 1 passive, 2 safe, 3 full"};
  mauve::Observable<int> contacts{*this, "contacts", 0,
                                  "1 right bumper, 2 left, 4 right wheel dropped, 8 left"};

  mauve::Status on_configure() override {
    const auto standing = create::drive_text(0, 0);
    line_.guard(stand, {.bytes = {standing.data(), standing.size()}, .times = 3, .apart = 20ms});
    return line_.open();
  }
  /// A core that has handed its state over to a successor does not stop the base under it.
  void on_cleanup() override {
    if (state->begun) send_speeds({});
    line_.close(state->bytes);
  }

  void begin() override {
    heard_ = begun_ = mauve::job_time();
    silent_ = false;
    state->begun = true;
    state->answers = false;
    line_.forget(state->bytes);  // of another base, or sent before this one was begun
    state->reports = {};
    state->device = device();
    line_.send(create::begin_text());
  }

  void work() override {
    const mauve::Instant now = mauve::job_time();
    if (heard_ == 0) heard_ = now;  // the first job after a change
    silent_ = state->device != device();
    if (silent_) return send_speeds({});  // another base, which nobody has begun
    if (read_reports(now)) {
      publish(now);
    } else {
      look_for_silence();
    }
    silent_ = now - heard_ >= answer_timeout.get().count();
    if (silent_) ++timeouts;
    const Velocity command = wanted();
    const bool answers = state->answers && !silent_;
    send_speeds(answers ? wheel_speeds(command, wheels) : WheelSpeeds{});
  }
  bool silent() override { return silent_; }

  bool lost() override { return line_.lost(); }
  void reopen() override {
    silence.look("its device is not there");
    if (line_.reopen()) begin();
  }

  [[nodiscard]] std::size_t device() const { return std::hash<std::string>{}(line_.device.get()); }

  /// All that are there; false when there is none.
  bool read_reports(mauve::Instant now) {
    using Event = create::ReportReader::Event;
    bool any = false;
    char byte = 0;
    while (line_.take(state->bytes, byte)) {
      state->reports.push(byte);
      for (Event event = state->reports.next(); event != Event::none;
           event = state->reports.next()) {
        any = use(event, now) || any;
      }
    }
    return any;
  }

  /// True when there is something to publish.
  bool use(create::ReportReader::Event event, mauve::Instant now) {
    last_ = event;
    if (event == create::ReportReader::Event::bad) {
      count_damaged(bad_frames);
      ++missed_;
      return false;
    }
    const create::Packets& packets = state->reports.packets();
    if (packets.unknown != 0 && rover::worth_reporting(++unknown_packets)) {
      mauve::log(mauve::LogLevel::warning,
                 "its base sends packet {}, which is not known here; the rest of its frame is not "
                 "read ({} so far)",
                 packets.unknown, unknown_packets.get());
    }
    if (event == create::ReportReader::Event::report) return take_report(now);
    ++lacking_frames;
    ++missed_;
    return false;
  }

  /// Why nothing was published.
  void look_for_silence() {
    using Event = create::ReportReader::Event;
    if (line_.received == received_) return silence.look("its base sends nothing");
    if (last_ == Event::bad) {
      return silence.look("its base sends bytes, and no undamaged frame: look at `baud`");
    }
    if (last_ == Event::lacking) {
      return silence.look("its base's frames lack packet {}, which is needed",
                          state->reports.packets().lacks);
    }
    silence.look("its base sends no reports that can be used");
  }

  /// The stream is the clock, a frame that is not used is a period too. After a gap the clock is
  /// ours, less the time that a frame may have been under way. False when there is nothing to
  /// publish.
  bool take_report(mauve::Instant now) {
    constexpr double kUnderWay = 0.05;
    const create::Report& report = state->reports.report();
    const double streamed = (missed_ + 1) * create::kStreamPeriod;
    const double passed = mauve::to_seconds(now - heard_) - kUnderWay;
    const auto step =
        state->wheels.advance(report.left, report.right, std::max(streamed, passed), wheels);
    missed_ = 0;
    heard_ = now;
    state->answers = true;
    ++frames;
    if (step == WheelOdometry::Step::jump) ++jumps;
    mode = static_cast<int>(report.mode);
    contacts = report.contacts;
    if (report.obeys()) {
      disobeys.end("its base obeys again");
    } else if (now - begun_ >= kUntilItObeys) {
      disobeys.begin("its base is in mode {} and obeys no command: stop and start arms it again",
                     mode.get());
    }
    return step == WheelOdometry::Step::moved;
  }

  void publish(mauve::Instant now) {
    rover::Odometry odometry = state->wheels.odometry();
    odometry.time = mauve::to_seconds(now) - state->wheels.lag();
    shell().odometry.write(odometry);
    silence.ended();
    received_ = line_.received;
    last_ = create::ReportReader::Event::none;
    shell().pose.write({odometry.x, odometry.y, odometry.heading});
    shell().twist.write({odometry.time, odometry.linear, odometry.angular});
  }

  /// The command, as far as it can be followed.
  Velocity wanted() {
    Velocity command = shell().command.read();
    const mauve::DataStatus status = shell().command.status();
    const bool fresh = has_value(status) && status != mauve::DataStatus::stale &&
                       shell().command.age() <= command_timeout.get();
    if (!fresh && followed_) ++lost_commands;
    followed_ = fresh;
    if (!fresh) return {};
    if (!std::isfinite(command.linear) || !std::isfinite(command.angular)) {
      if (rover::worth_reporting(++bad_commands)) {
        mauve::log(mauve::LogLevel::warning, "commands that are no numbers: {} so far",
                   bad_commands.get());
      }
      return {};
    }
    if (state->reports.report().bumped()) command.linear = std::min(command.linear, 0.0);
    return command;
  }

  void send_speeds(const WheelSpeeds& speeds) {
    const auto whole = [](double speed) { return static_cast<int>(std::lround(speed * 1000.0)); };
    const auto text = create::drive_text(whole(speeds.left), whole(speeds.right));
    line_.send({text.data(), text.size()});
  }

  static constexpr std::int64_t kUntilItObeys = 500'000'000;  // ns after it was begun

  mauve::Instant heard_ = 0;            // begin of the job that read the last report
  mauve::Instant begun_ = 0;            // the base, by this core
  int missed_ = 0;                      // frames since that report
  std::uint64_t received_ = 0;          // bytes, when a value was published last
  create::ReportReader::Event last_{};  // since then
  bool followed_ = false;
  bool silent_ = false;
};

}  // namespace

void declare_create(mauve::Plugin& plugin) {
  plugin.core<CreateOi>("create_oi");
  plugin.component<BaseShell, BaseFsm>("create", "create_oi");
}

}  // namespace drivers
