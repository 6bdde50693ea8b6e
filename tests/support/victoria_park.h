// SPDX-License-Identifier: LGPL-3.0-or-later
/// The truck in Victoria Park (data/victoria_park): its recording, and the estimate of the filter
/// when the positions are cut out for a while.
#pragma once

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "../../plugins/localization/ackermann.h"
#include "../../plugins/localization/filter.h"
#include "../../plugins/world/random.h"

namespace support::park {

struct Recording {
  std::vector<rover::Twist> wheels;
  std::vector<rover::Pose> fixes;

  [[nodiscard]] double seconds() const { return wheels.back().time - wheels.front().time; }
};

/// Lines of three numbers.
template <typename F>
void each_line(const std::filesystem::path& path, F&& f) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
  char comma = 0;
  while (file >> a >> comma >> b >> comma >> c) f(a, b, c);
}

inline Recording read(const std::filesystem::path& folder) {
  Recording recording;
  each_line(folder / "odometry.csv", [&](double time, double speed, double steering) {
    recording.wheels.push_back(localization::twist_of({}, time, speed, steering));
  });
  each_line(folder / "gnss.csv", [&](double time, double x, double y) {
    recording.fixes.push_back({time, x, y, 0.0});
  });
  return recording;
}

/// Of the truck. Antenna and vehicle come with the recording, the noises were found by trying on
/// it.
inline localization::Parameters truck() {
  localization::Parameters p;
  p.acceleration = 0.5;
  p.turn_acceleration = 0.5;
  p.slip = 0.03;
  p.heading_slip = 0.015;
  p.twist_linear = 0.05;
  p.twist_angular = 0.02;
  p.position = 0.8;
  p.antenna = {3.78, 0.5};
  return p;
}

/// Half a minute each, at random, at least half a minute apart.
struct Outages {
  static constexpr double kLength = 30.0;
  std::vector<double> begins;

  static Outages random(std::uint64_t seed, double from, double to) {
    world::Random random(seed);
    Outages outages;
    for (double at = from + random.uniform(0.0, 60.0); at + kLength < to;
         at += kLength + random.uniform(30.0, 90.0)) {
      outages.begins.push_back(at);
    }
    return outages;
  }
  /// Seconds since the outage began that the time lies in; negative: in none.
  [[nodiscard]] double into(double time) const {
    for (const double begin : begins) {
      if (time >= begin && time < begin + kLength) return time - begin;
    }
    return -1.0;
  }
};

struct Sample {
  rover::MotionState state;
  rover::Pose fix;
  double outage = -1.0;   ///< s since it began
  double error = 0.0;     ///< m, of the antenna
  double surprise = 0.0;  ///< the squared Mahalanobis distance of it
  double nis = 0.0;       ///< of a fix the filter was given
  bool rejected = false;
};

struct Replay {
  std::vector<Sample> samples;            ///< one for each fix
  std::vector<rover::MotionState> track;  ///< five a second
  localization::Estimate last;
  double seconds = 0.0;  ///< of processor time
};

/// How far the fix is from where the filter believes the antenna to be.
inline void compare(const localization::Parameters& parameters, Sample& sample) {
  const rover::MotionState& state = sample.state;
  const rover::Point2D& antenna = parameters.antenna;
  const double cosine = std::cos(state.heading);
  const double sine = std::sin(state.heading);
  const double x = sample.fix.x - state.x - cosine * antenna.x + sine * antenna.y;
  const double y = sample.fix.y - state.y - sine * antenna.x - cosine * antenna.y;
  const double xx = state.variance_x + parameters.position * parameters.position;
  const double yy = state.variance_y + parameters.position * parameters.position;
  const double xy = state.covariance_xy;
  sample.error = std::hypot(x, y);
  sample.surprise = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy);
}

/// Plays the recording to the filter, but for the positions in outages.
inline Replay replay(const Recording& recording, const Outages& outages,
                     const localization::Parameters& parameters) {
  using namespace localization;
  Replay result;
  result.samples.reserve(recording.fixes.size());
  result.track.reserve(recording.wheels.size() / 8 + 1);
  const std::clock_t begun = std::clock();
  const auto memory = std::make_unique<Memory>();
  start(begin(parameters), *memory);
  auto wheel = recording.wheels.begin();
  for (const rover::Pose& fix : recording.fixes) {
    for (; wheel != recording.wheels.end() && wheel->time <= fix.time; ++wheel) {
      add(parameters, *wheel, wheel->time, 0.5, *memory);
      if ((wheel - recording.wheels.begin()) % 8 != 0) continue;
      result.track.push_back(motion_state(memory->estimate));
    }
    Sample sample;
    sample.fix = fix;
    sample.outage = outages.into(fix.time);
    if (sample.outage < 0.0) {
      const std::uint64_t before = memory->estimate.rejected;
      add(parameters, fix, fix.time, 0.5, *memory);
      sample.rejected = memory->estimate.rejected != before;
      sample.nis = memory->estimate.nis;
    }
    sample.state = motion_state(predicted(parameters, fix.time, *memory));
    compare(parameters, sample);
    result.samples.push_back(sample);
  }
  result.last = memory->estimate;
  result.seconds = static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
  return result;
}

/// The value below which that share lies.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace support::park
