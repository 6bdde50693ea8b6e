// SPDX-License-Identifier: LGPL-3.0-or-later
/// The localization on the truck in Victoria Park. The satellites are cut out for half a minute at
/// random. The estimate of the filter is then compared with the positions that it did not get.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "bench/robot.h"
#include "support/test_data.h"
#include "support/victoria_park.h"
#include "support/victoria_park_picture.h"

namespace bench {
namespace {

using namespace support::park;
using localization::Memory;

constexpr const char* kPicture = "build/bench/victoria_park.svg";

struct Shares {
  std::vector<double> errors;  // m, 20 to 30 s into an outage
  double admitted = 0.0;       // of them, inside the 95 % ellipse
  double fixes = 0.0;          // given to the filter
  double below = 0.0;          // of them, NIS below its 95 % limit
  double between = 0.0;        // of them, NIS in its two-sided 95 % band
  double seconds = 0.0;        // of processor time
};

void count(const Replay& run, double from, Shares& shares) {
  shares.seconds += run.seconds;
  for (const Sample& sample : run.samples) {
    if (sample.fix.time < from) continue;
    if (sample.outage >= 20.0) {
      shares.errors.push_back(sample.error);
      shares.admitted += sample.surprise < 5.991 ? 1.0 : 0.0;
    }
    if (sample.outage >= 0.0) continue;
    ++shares.fixes;
    shares.below += sample.nis < 5.991 ? 1.0 : 0.0;
    shares.between += sample.nis > 0.0506 && sample.nis < 7.378 ? 1.0 : 0.0;
  }
}

/// Nanoseconds of one call.
template <typename F>
double cost(int times, F&& f) {
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < times; ++i) f(i);
  const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
  return took.count() / times;
}

struct Costs {
  Figure& twist;
  Figure& pose;
  Figure& predict;
  Figure& late;
};

void measure(const Options& options, Costs& figures) {
  const localization::Parameters parameters;
  const auto memory = std::make_unique<Memory>();
  localization::start(localization::begin(parameters, {}, 0.1, 0.05), *memory);
  const int times = options.choose(20'000, 1'000);
  double time = 1.0;
  const auto feed = [&](const localization::Measurement& m) {
    localization::add(parameters, m, time, 10.0, *memory);
  };
  figures.twist.add(cost(times, [&](int) { feed(rover::Twist{time += 0.01, 0.0, 0.0}); }));
  figures.pose.add(cost(times, [&](int) { feed(rover::Pose{time += 0.01, 0.0, 0.0, 1.0}); }));
  double sum = 0.0;
  figures.predict.add(cost(times, [&](int) {
    sum += motion_state(localization::predicted(parameters, time + 0.05, *memory)).x;
  }));
  if (sum == 1.0) std::puts("");  // the result is used
  // Just behind the oldest entry but one: all others are gone through again.
  figures.late.add(cost(times / 100,
                        [&](int) {
                          feed(rover::Pose{time - (Memory::kCapacity - 3) * 0.01, 0.0, 0.0, 1.0});
                          for (int i = 0; i < 8; ++i) feed(rover::Twist{time += 0.01, 0.0, 0.0});
                        }) /
                   1e3);
}

}  // namespace

void report_localization(const Options& options) {
  Report report(
      "robot: localization",
      "A truck of 26 minutes in Victoria Park; satellites cut out for 30 s at random, ten "
      "times in each replay.",
      options);
  Figure& p50 = report.figure("error 20 to 30 s into an outage, p50", "m", at_most(5));
  Figure& p90 = report.figure("the same, p90", "m", at_most(15));
  Figure& admitted = report.figure("of these positions, inside the 95 % ellipse", "%");
  Figure& below = report.figure("NIS below its 95 % limit between outages", "%");
  Figure& between = report.figure("NIS in its two-sided 95 % band", "%");
  Figure& speed = report.figure("times as fast as the recording, one core", "");
  Costs costs{report.figure("update_twist", "ns"), report.figure("update_pose", "ns"),
              report.figure("predict 50 ms ahead", "ns"),
              report.figure("a pose late by the whole memory of 128, and 8 twists", "us")};
  const auto folder = support::test_data("victoria_park");
  if (!folder) report.note(support::kNoTestData);
  for (int round = 0; round < options.rounds; ++round) {
    measure(options, costs);
    if (!folder) continue;
    const Recording recording = read(*folder);
    const double from = recording.wheels.front().time + 60.0;
    const double to = recording.wheels.back().time;
    Shares shares;
    const int runs = options.choose(20, 1);
    for (int i = 0; i < runs; ++i) {
      const auto seed = static_cast<std::uint64_t>(round * runs + i + 1);
      const Outages outages = Outages::random(seed, from, to);
      const Replay run = replay(recording, outages, truck());
      if (seed == 1 && !options.smoke) std::ofstream(kPicture) << picture(run, truck());
      count(run, from, shares);
    }
    p50.add(quantile(shares.errors, 0.5));
    p90.add(quantile(shares.errors, 0.9));
    admitted.add(100.0 * shares.admitted / static_cast<double>(shares.errors.size()));
    below.add(100.0 * shares.below / shares.fixes);
    between.add(100.0 * shares.between / shares.fixes);
    speed.add(runs * recording.seconds() / shares.seconds);
  }
  report.print();
}

}  // namespace bench
