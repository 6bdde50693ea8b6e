// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "supervision". Component kind "supervision/supervisor": watches the robot for the rules
/// of its architecture, which change the system (paper 5.4). It shows in which of some areas the
/// robot is (areas.h), and whether it gets on towards its goal (progress.h); it moves nothing.
/// Example: mauvectl get supervisor.core.area
#include <cstdint>

#include <mauve/job.h>
#include <mauve/plugin.h>

#include "areas.h"
#include "progress.h"

template <>
struct mauve::Described<supervision::Area> {
  static constexpr std::string_view name = "area/1";
  static constexpr auto fields() {
    using supervision::Area;
    return std::tuple{field("low", &Area::low, "m"), field("high", &Area::high, "m")};
  }
};

namespace supervision {

/// The state that survives a change.
struct Watched {
  Sighting seen;
  Progress progress;

  /// Opaque to tools; raise the revision when anything in it changes.
  static constexpr std::string_view type_name = "supervised/2";
  static constexpr auto fields() { return std::tuple{}; }
};

namespace {

using rover::Point2D;
using rover::Pose2D;
using namespace std::chrono_literals;  // NOLINT: durations of properties

using Areas = mauve::Bounded<Area, 16>;

struct SupervisorShell : mauve::Shell {
  mauve::ReadPort<Pose2D> pose{*this, "pose", mauve::Need::required};
  mauve::ReadPort<Point2D> goal{*this, "goal", mauve::Need::optional};  // without: never stuck
};

class Supervisor final : public mauve::Core<SupervisorShell> {
 public:
  void update() {
    const Pose2D pose = shell().pose.read();
    const mauve::DataStatus seen = shell().pose.status();
    const bool known = has_value(seen) && seen != mauve::DataStatus::stale;
    const int there = known ? area_of(pose, areas.get(), watched->seen.area, margin) : kNowhere;
    const int now = follow(watched->seen, there, remember, mauve::job_time());
    if (now != area) ++changes;
    area = now;
    const mauve::Duration stays =
        stays_for(watched->progress, pose, wants_to_move(pose), stuck_radius, mauve::job_time());
    stuck = stays >= stuck_after.get();
  }

 private:
  mauve::State<Watched> watched{*this};
  mauve::Property<Areas> areas{*this, "areas", {}, "rectangles, m; the first that fits counts"};
  mauve::Property<double> margin{*this,
                                 "margin",
                                 0.3,
                                 "beyond which an area is left",
                                 {.unit = "m", .min = 0.0, .max = 100.0}};
  mauve::Property<mauve::Duration> remember{*this,
                                            "remember",
                                            2s,
                                            "how long the area is kept without a known pose",
                                            {.min = 0s, .max = 1h}};
  mauve::Property<double> goal_radius{*this,
                                      "goal_radius",
                                      0.5,
                                      "within which the robot is at its goal",
                                      {.unit = "m", .min = 0.0, .max = 100.0}};
  mauve::Property<double> stuck_radius{*this,
                                       "stuck_radius",
                                       0.2,
                                       "a robot that stays within it does not get on",
                                       {.unit = "m", .min = 0.01, .max = 100.0}};
  mauve::Property<mauve::Duration> stuck_after{*this,
                                               "stuck_after",
                                               10s,
                                               "without getting on the robot is stuck",
                                               {.min = 100ms, .max = 1h}};
  mauve::Observable<int> area{*this, "area", kNowhere,
                              "number of the robot's area, from 1; 0 in none, -1 unknown"};
  mauve::Observable<std::uint64_t> changes{*this, "changes", 0, "of the area"};
  mauve::Observable<bool> stuck{*this, "stuck", false, "far from its goal, and does not get on"};

  bool wants_to_move(const Pose2D& pose) {
    const Point2D goal = shell().goal.read();
    return has_value(shell().goal.status()) && !(distance(pose, goal) <= goal_radius);
  }
};

}  // namespace
}  // namespace supervision

MAUVE_PLUGIN(plugin) {
  using namespace supervision;  // NOLINT: names of this file
  plugin.component<SupervisorShell, Supervisor, mauve::PeriodicFsm<Supervisor>>("supervisor");
}
