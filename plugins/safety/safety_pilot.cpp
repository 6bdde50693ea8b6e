// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "safety". Component kind "safety/pilot": lets a command through as far as the way is
/// free. Nearer than `slow_distance` it halves the forward speed. Nearer than `stop_distance` it
/// lets the robot only turn and reverse, as it does without a fresh scan, or with a blind one
/// (zones.h). Without a command, or with one that is not a number, the robot stands. Component kind
/// "safety/cruise": a steady command, to try the pilot without a robot.
#include <cmath>
#include <cstdint>

#include <mauve/plugin.h>

#include "../types/reporting.h"
#include "../types/scan.h"
#include "../types/velocity.h"
#include "zones.h"

namespace safety {

/// The state that survives a change.
struct PilotState {
  std::uint8_t zone = 0;

  static constexpr std::string_view type_name = "pilot_state/1";
  static constexpr auto fields() { return std::tuple{mauve::field("zone", &PilotState::zone)}; }
};

namespace {

using rover::LaserScan;
using rover::Velocity;
using namespace std::chrono_literals;  // NOLINT: durations of states

struct PilotShell : mauve::Shell {
  mauve::ReadPort<Velocity> command{*this, "command", mauve::Need::required};
  mauve::ReadPort<LaserScan> scan{*this, "scan", mauve::Need::required};
  mauve::WritePort<Velocity> safe_command{*this, "safe_command", mauve::Safe{Velocity{}}};
};

class Pilot final : public mauve::Core<PilotShell> {
 public:
  /// [rt] state look: which zone are we in?
  void look() {
    bool sees = false;
    const mauve::DataStatus seen = shell().scan.look([&](const LaserScan& scan) {
      sees = !safety::blind(scan);
      free_way = safety::free_way(scan, limits->half_width);
    });
    if (has_value(seen) && !sees) ++blind_scans;
    sees_.report(!has_value(seen) || sees, "the scan says something again",
                 "the scan says nothing: no way ahead is safe");
    const bool fresh = has_value(seen) && seen != mauve::DataStatus::stale &&
                       (scan_timeout.get() == 0ms || shell().scan.age() <= scan_timeout.get());
    if (!fresh || !sees) free_way = 0.0;
    const Zone now = next_zone(Zone{state->zone}, free_way, limits);
    state->zone = static_cast<std::uint8_t>(now);
    zone = static_cast<int>(state->zone);
  }
  /// [rt] states clear, slow and stop: hand on the command, as far as it is safe.
  void pass() { hand_on(Zone::clear); }
  void halve() { hand_on(Zone::slow); }
  void stop() { hand_on(Zone::stop); }

  bool must_stop() const { return Zone{state->zone} == Zone::stop; }
  bool must_slow() const { return Zone{state->zone} == Zone::slow; }

 private:
  mauve::State<PilotState> state{*this};
  mauve::Parameters<Limits> limits{*this};
  mauve::Property<mauve::Duration> scan_timeout{*this,
                                                "scan_timeout",
                                                500ms,
                                                "an older scan counts as none; 0ms: never",
                                                {.min = 0ms, .max = {}}};
  mauve::Observable<double> free_way{*this, "free_way", 0.0, "to the next obstacle ahead", "m"};
  mauve::Observable<std::uint64_t> blind_scans{*this, "blind_scans", 0,
                                               "looks at a scan that says nothing"};
  mauve::Observable<std::uint64_t> bad_commands{*this, "bad_commands", 0, "not a number"};
  mauve::Observable<int> zone{*this, "zone", 0, "0 clear, 1 slow, 2 stop"};

  mauve::Status on_configure() override {
    if (limits->slow_distance >= limits->stop_distance) return mauve::ok();
    return mauve::invalid(limits[&Limits::slow_distance], "must not be below stop_distance");
  }

  void hand_on(Zone zone_now) {
    const Velocity wanted = shell().command.read();
    const mauve::DataStatus status = shell().command.status();
    const bool usable = has_value(status) && status != mauve::DataStatus::stale;
    if (usable && !(std::isfinite(wanted.linear) && std::isfinite(wanted.angular))) {
      if (rover::worth_reporting(++bad_commands)) {
        mauve::log(mauve::LogLevel::warning, "commands that are no numbers: {} so far",
                   bad_commands.get());
      }
    }
    shell().safe_command.write(usable ? limited(wanted, zone_now) : Velocity{});
  }

  rover::Condition sees_{true};
};

/// Each zone is a state, so that `mauvectl status` and traces show it.
struct PilotFsm : mauve::Fsm<Pilot> {
  Exec look{*this, "look", &Pilot::look};
  Exec clear{*this, "clear", &Pilot::pass};
  Exec slow{*this, "slow", &Pilot::halve};
  Exec stop{*this, "stop", &Pilot::stop};
  Sync period{*this, "period", 10ms, "between two looks"};

  mauve::Status on_configure() override {
    start_at(look);
    look.when("must_stop", &Pilot::must_stop, stop)
        .when("must_slow", &Pilot::must_slow, slow)
        .then(clear);
    clear.then(period);
    slow.then(period);
    stop.then(period);
    period.then(look);
    return mauve::ok();
  }
};

struct CruiseShell : mauve::Shell {
  mauve::WritePort<Velocity> command{*this, "command", mauve::Safe{Velocity{}}};
};

class Cruise final : public mauve::Core<CruiseShell> {
 public:
  void update() { shell().command.write(velocity); }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<Velocity> velocity{*this, "velocity", {0.5, 0.0}, "commanded all the time"};
};

}  // namespace
}  // namespace safety

MAUVE_PLUGIN(plugin) {
  plugin.component<safety::PilotShell, safety::Pilot, safety::PilotFsm>("pilot");
  plugin.component<safety::CruiseShell, safety::Cruise, mauve::PeriodicFsm<safety::Cruise>>(
      "cruise");
}
