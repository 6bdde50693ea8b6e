// SPDX-License-Identifier: LGPL-3.0-or-later
/// The cores of plugins/guidance in random worlds, alone and with the pilot, swapped by the runtime
/// on the way, and from room to room through the building of etc/maps.
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "../../plugins/world/random.h"
#include "bench/robot.h"
#include "bench/support/checked.h"
#include "bench/support/table.h"
#include "picture/svg.h"
#include "support/building.h"
#include "support/deployed_control.h"
#include "support/drive.h"

namespace bench {
namespace {

namespace drive = support::drive;
namespace building = support::building;

constexpr drive::Worlds kWorlds[] = {drive::kOpen, drive::kDense, drive::kDenser};
/// Of etc/rover.json.
constexpr safety::Limits kRoverPilot{0.5, 1.0, 0.35, 0.1};

struct Core {
  const char* name;
  const char* type;
  drive::Law law;
  drive::Law doors;  ///< with the properties of etc/rover.json
};

std::vector<Core> cores() {
  return {{"potential_field", "guidance/potential_field", drive::field(), building::field()},
          {"finite_time", "guidance/finite_time", drive::finite_time(), building::finite_time()}};
}

drive::Conditions with_pilot() {
  drive::Conditions conditions;
  conditions.pilot = &kRoverPilot;
  conditions.laser_noise = 0.01;
  return conditions;
}

Table::Row row(const std::string& core, const char* worlds, const drive::Summary& sum) {
  return {core,
          worlds,
          std::to_string(sum.reached) + " of " + std::to_string(sum.clearances.size()),
          std::to_string(sum.touched),
          shown(sum.least_clearance()),
          shown(median(sum.clearances)),
          shown(drive::mean(sum.seconds), 1),
          shown(drive::mean(sum.lengths)),
          shown(100.0 * sum.jump, 1)};
}

Table table(const char* name, const char* text) {
  return {name,
          text,
          {"core", "worlds", "reached", "collisions", "least clearance (m)", "median clearance (m)",
           "time (s)", "path (m)", "largest jump (% of slew limit)"}};
}

void report_worlds(const Options& options, const char* name, const char* text,
                   const drive::Conditions& conditions) {
  Table result = table(name, text);
  for (const Core& core : cores()) {
    for (const drive::Worlds& worlds : kWorlds) {
      result.add(row(core.name, worlds.name,
                     drive::drive_worlds(drive::driven_by(core.law), worlds, options.choose(300, 5),
                                         conditions)));
    }
  }
  result.print(options);
}

drive::Summary swapped(mauve::plugin::Catalog& catalog, const Core& first, const Core& second,
                       const drive::Worlds& worlds, int count) {
  drive::Summary sum;
  world::Random random(1);
  const drive::Conditions conditions = with_pilot();
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(count); ++seed) {
    support::DeployedControl control(catalog, first.type);
    must_hold(control.error().empty(), control.error().c_str());
    const support::SwapDrive run =
        support::drive_and_swap(control, second.type, random.uniform(0.0, 12.0), worlds.world(seed),
                                worlds.goal(), seed, conditions);
    must_hold(run.swapped, "no swap");
    must_hold(run.missed == 0, "releases missed");
    sum.add(run.run);
  }
  return sum;
}

void report_swaps(const Options& options) {
  Table result = table("robot: control, core swapped on the way",
                       "The deployed component on a simulated clock; at a random moment of the "
                       "first 12 s the runtime puts the other core in its place. Pilot as above.");
  mauve::plugin::Catalog catalog({MAUVE_PLUGIN_DIR});
  const std::vector<Core> all = cores();
  for (const std::size_t first : {std::size_t{0}, std::size_t{1}}) {
    for (const drive::Worlds& worlds : kWorlds) {
      result.add(row(std::string(all[first].name) + " to " + all[1 - first].name, worlds.name,
                     swapped(catalog, all[first], all[1 - first], worlds, options.choose(300, 3))));
    }
  }
  result.print(options);
}

/// One open world, and the way of each core through it.
void draw_world() {
  constexpr double kScale = 80.0;  // pixels a metre
  constexpr std::uint64_t kSeed = 6;
  const auto place = [](const rover::Point2D& at) {
    return mauve::ctl::Place{(at.x + 0.5) * kScale, (3.5 - at.y) * kScale};
  };
  const drive::World world = drive::kOpen.world(kSeed);
  mauve::ctl::Svg picture(11.0 * kScale, 7.0 * kScale);
  for (const world::Disc& disc : world.map) {
    picture.circle(place(disc.at), disc.radius * kScale, "fill='#999'");
  }
  drive::Conditions conditions = with_pilot();
  conditions.draws = true;
  std::size_t index = 0;
  for (const Core& core : cores()) {
    const drive::Outcome run =
        drive::drive(drive::driven_by(core.law), world, drive::kOpen.goal(), kSeed, conditions);
    std::vector<mauve::ctl::Place> track;
    for (const rover::Point2D& at : run.track) track.push_back(place(at));
    const std::string colour(mauve::ctl::line_colour(index));
    picture.polyline(track, "fill='none' stroke-width='2' stroke='" + colour + "'");
    picture.text({10.0, 20.0 * static_cast<double>(++index)},
                 std::string(core.name) + ", " + shown(run.seconds, 1) + " s",
                 "fill='" + colour + "'");
  }
  picture.circle(place(drive::kOpen.goal()), 5.0, "fill='black'", "goal");
  std::ofstream("build/bench/control.svg") << picture.file();
}

void report_building(const Options& options) {
  Table result("robot: from room to room",
               "Errands through the building of etc/maps behind doors of 1.3 m, with the way "
               "points of navigation, the pilot and the properties of etc/rover.json.",
               {"core", "reached", "least clearance (m)", "time (s)", "planned (m)", "driven (m)",
                "time / (planned at 0.45 m/s)", "worst"});
  building::Building rooms;
  must_hold(rooms.load(MAUVE_SOURCE_DIR), "no map");
  world::Random random(11);
  std::vector<building::Errand> errands;
  while (static_cast<int>(errands.size()) < options.choose(20, 1)) {
    errands.push_back(rooms.errand(random));
  }
  for (const Core& core : cores()) {
    drive::Summary sum;
    double planned = 0.0;
    double worst = 0.0;
    double seconds = 0.0;
    for (const building::Errand& errand : errands) {
      const drive::Outcome run = rooms.drive(drive::driven_by(core.doors), errand,
                                             sum.clearances.size() + 1, building::conditions());
      planned += errand.length;
      seconds += run.seconds;
      worst = std::max(worst, run.seconds * building::kSpeed / errand.length);
      sum.add(run);
    }
    const auto count = static_cast<double>(sum.lengths.size());
    result.add({core.name, std::to_string(sum.reached) + " of " + std::to_string(errands.size()),
                shown(sum.least_clearance()), shown(seconds, 0), shown(planned, 0),
                shown(drive::mean(sum.lengths) * count, 0),
                shown(seconds * building::kSpeed / planned), shown(worst)});
  }
  result.print(options);
}

}  // namespace

void report_control(const Options& options) {
  report_worlds(options, "robot: control, the laws alone",
                "Random discs on the way, speed disturbed by up to 0.1 m/s and turn rate by up to "
                "0.5 rad/s; nearer than 0.35 m from the robot's centre is a collision.",
                {});
  report_worlds(options, "robot: control, with the pilot",
                "The same worlds, the laser with noise, and the pilot of etc/rover.json behind.",
                with_pilot());
  report_swaps(options);
  report_building(options);
  if (!options.smoke) draw_world();
}

}  // namespace bench
