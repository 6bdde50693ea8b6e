// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource kind "drivers/world": the simulated world that the simulated drivers share. The same
/// seed gives the same run. Obstacles are listed in `obstacles`, or placed at random when
/// `random_discs` is set; walls are the occupied cells of `map`.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include "../localization/utm.h"
#include "../navigation/map_file.h"
#include "../types/gnss.h"
#include "../types/imu.h"
#include "../world/walls.h"
#include "../world/world.h"
#include "parts.h"

template <>
struct mauve::Described<world::Disc> {
  static constexpr std::string_view name = "disc/1";
  static constexpr auto fields() {
    using world::Disc;
    return std::tuple{field("at", &Disc::at, "m"), field("radius", &Disc::radius, "m")};
  }
};

namespace drivers {

/// The state that survives a change of the world: the robot goes on where it is, among other
/// obstacles.
struct Moving {
  world::Robot robot{1};
  world::Random random{1};

  /// Opaque to tools; raise the revision when anything in it changes.
  static constexpr std::string_view type_name = "simulated_robot/1";
  static constexpr auto fields() { return std::tuple{}; }
};

namespace {

using rover::GnssFix;
using rover::Imu;
using rover::LaserScan;
using rover::Odometry;
using rover::Point2D;
using rover::Pose2D;
using rover::Velocity;

using Discs = mauve::Bounded<world::Disc, world::Map::kCapacity>;

/// Where the origin of the world lies on the globe. Its axes are those of the UTM grid there.
constexpr localization::Geographic kOrigin{43.5661, 1.4744};
constexpr localization::Zone kZone{31, false};
constexpr double kGroundAltitude = 151.0;

class WorldCore final : public mauve::Core<mauve::EmptyShell> {
 public:
  /// [rt] Drives on for `seconds` and returns the odometry of the wheels.
  Odometry drive(Velocity command, double seconds) {
    state_->robot.drive(command, {speed_disturbance, turn_disturbance}, seconds);
    const Pose2D& pose = state_->robot.pose();
    const double left = clearance({pose.x, pose.y}) - robot_radius;
    if (left < nearest) nearest = left;
    x = pose.x;
    y = pose.y;
    Odometry odometry = state_->robot.odometry();
    odometry.time = mauve::to_seconds(mauve::job_time());
    return odometry;
  }

  /// [rt] One turn of the laser.
  LaserScan scan() {
    LaserScan scan;
    scan.time = mauve::to_seconds(mauve::job_time());
    world::cast(map_, state_->robot.pose(), {0.02, laser_range, laser_noise}, state_->random, scan,
                walls_.get());
    return scan;
  }

  /// [rt] The fix of the antenna.
  GnssFix antenna() {
    const Pose2D& pose = state_->robot.pose();
    const double east = origin_.x + pose.x + state_->random.normal(gnss_noise);
    const double north = origin_.y + pose.y + state_->random.normal(gnss_noise);
    const localization::Geographic there = utm_.reverse({east, north}, kZone);
    GnssFix fix;
    // The clock of the satellites goes on while the robot stands; midnight is where it begins.
    fix.time = std::fmod(mauve::to_seconds(mauve::job_time()), 86400.0);
    fix.latitude = there.latitude;
    fix.longitude = there.longitude;
    fix.altitude = kGroundAltitude + state_->random.normal(2.0 * gnss_noise);
    fix.mode = satellites >= 4 ? 3 : satellites == 3 ? 2 : 1;
    fix.satellites = satellites;
    fix.hdop = 0.9;
    return fix;
  }

  /// [rt] The measurement of the inertial unit. The simulated wheels reach their speed at once, so
  /// only the curve is felt.
  Imu imu() {
    const Odometry& moves = state_->robot.odometry();
    Imu imu;
    imu.yaw_rate = moves.angular + imu_bias + state_->random.normal(imu_noise);
    imu.acceleration_y = moves.linear * moves.angular;
    imu.has_heading = imu_heading_noise > 0.0;
    if (!imu.has_heading) return imu;
    const double heading = state_->robot.pose().heading;
    imu.heading = rover::wrap(heading + state_->random.normal(imu_heading_noise));
    return imu;
  }

 private:
  mauve::State<Moving> state_{*this};
  mauve::Property<std::int64_t> seed{*this, "seed", 1, "of everything random", {.min = 0}};
  mauve::Property<Pose2D> start{*this, "start", {}, "where the robot stands at first"};
  mauve::Property<Discs> obstacles{*this, "obstacles", {}, "discs in the way"};
  mauve::Property<std::string> map{
      *this, "map", "", "path of a map's YAML file; none: no walls", {.within = "./"}};
  mauve::Property<int> random_discs{
      *this, "random_discs", 0, "more of them, at random", {.min = 0, .max = 32}};
  mauve::Property<Point2D> random_goal{
      *this, "random_goal", {10.0, 0.0}, "random discs lie on the way to here"};
  mauve::Property<double> robot_radius{
      *this, "robot_radius", 0.3, "for the clearance", {.unit = "m", .min = 0.0}};
  mauve::Property<double> speed_disturbance{
      *this, "speed_disturbance", 0.05, "up to", {.unit = "m/s", .min = 0.0, .max = 1.0}};
  mauve::Property<double> turn_disturbance{
      *this, "turn_disturbance", 0.25, "up to", {.unit = "rad/s", .min = 0.0, .max = 3.0}};
  mauve::Property<double> laser_range{
      *this, "laser_range", 8.0, "of the laser", {.unit = "m", .min = 0.1, .max = 100.0}};
  mauve::Property<double> laser_noise{
      *this, "laser_noise", 0.01, "standard deviation", {.unit = "m", .min = 0.0, .max = 1.0}};
  mauve::Property<double> gnss_noise{
      *this, "gnss_noise", 0.5, "standard deviation", {.unit = "m", .min = 0.0, .max = 100.0}};
  mauve::Property<int> satellites{*this,
                                  "satellites",
                                  9,
                                  "in sight of the antenna; under 3 there is no position",
                                  {.min = 0, .max = 32}};
  mauve::Property<double> imu_noise{
      *this, "imu_noise", 0.01, "standard deviation", {.unit = "rad/s", .min = 0.0, .max = 1.0}};
  mauve::Property<double> imu_bias{
      *this, "imu_bias", 0.002, "of the yaw rate", {.unit = "rad/s", .min = -1.0, .max = 1.0}};
  mauve::Property<double> imu_heading_noise{*this,
                                            "imu_heading_noise",
                                            0.0,
                                            "standard deviation of the compass; 0: there is none",
                                            {.unit = "rad", .min = 0.0, .max = 1.0}};
  mauve::Observable<double> nearest{*this, "nearest", 1e9, "the robot came to an obstacle", "m"};
  mauve::Observable<double> x{*this, "x", 0.0, "true position", "m"};
  mauve::Observable<double> y{*this, "y", 0.0, "true position", "m"};

  mauve::Status on_configure() override {
    const auto number = static_cast<std::uint64_t>(seed.get());
    const Pose2D from = start;
    map_ = {};
    if (random_discs > 0) {
      map_ = world::random_map(number, static_cast<std::size_t>(random_discs.get()), 2.1,
                               {from.x, from.y}, random_goal);
    }
    for (const world::Disc& disc : obstacles.get()) map_.add(disc);
    if (mauve::Status done = build_walls(); !done) return done;
    if (clearance({from.x, from.y}) < robot_radius) {
      return mauve::invalid(start, "is inside an obstacle");
    }
    *state_ = {world::Robot(number, from), world::Random(number + 1)};
    return mauve::ok();
  }

  mauve::Status build_walls() {
    walls_.reset();
    if (map.get().empty()) return mauve::ok();
    const auto grid = std::make_unique<rover::OccupancyGrid>();
    if (mauve::Status done = navigation::load_map(map, *grid); !done) return done;
    walls_ = std::make_unique<world::Walls>();
    return walls_->set(*grid) ? mauve::ok() : mauve::invalid(map, "is no map");
  }
  double clearance(const Point2D& at) const {
    const double discs = map_.clearance(at);
    return walls_ == nullptr ? discs : std::min(discs, walls_->clearance(at));
  }

  world::Map map_;
  localization::Utm utm_;
  const Point2D origin_ = utm_.forward(kOrigin, kZone).value_or(Point2D{});
  std::unique_ptr<world::Walls> walls_;
};

struct WorldInterface : mauve::Interface<WorldCore> {
  mauve::CallService<Odometry(Velocity, double)> drive{*this, "drive", &WorldCore::drive};
  mauve::ReadService<LaserScan> scan{*this, "scan", &WorldCore::scan};
  mauve::ReadService<GnssFix> antenna{*this, "antenna", &WorldCore::antenna};
  mauve::ReadService<Imu> imu{*this, "imu", &WorldCore::imu};
};

}  // namespace

void declare_world(mauve::Plugin& plugin) {
  plugin.resource<mauve::EmptyShell, WorldCore, WorldInterface>("world");
}

}  // namespace drivers
