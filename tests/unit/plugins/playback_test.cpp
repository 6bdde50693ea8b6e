// SPDX-License-Identifier: LGPL-3.0-or-later
// Playing a recording: when its values are written, and with which stamps.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "../../../plugins/drivers/recording/playback.h"
#include "../../../plugins/types/motion.h"
#include "../../../plugins/types/pose.h"
#include "support/temp_dir.h"

#include <mauve/test_kit.h>

namespace {

using mauve::Value;
using rover::Odometry;
using namespace std::chrono_literals;

/// Four values; the stamps in them are 0.5 s older than their rows, on a clock that began earlier.
constexpr const char* kDrive =
    "time_s,o.read.time,o.read.x,o.read.y,o.read.heading,o.read.linear,o.read.angular\n"
    "1.000000000,1000.5,1.0,0.0,0.0,0.5,0.0\n"
    "1.100000000,1000.6,2.0,0.0,0.0,0.5,0.0\n"
    "1.200000000,1000.7,3.0,0.0,0.0,0.5,0.0\n"
    "1.210000000,1000.71,4.0,0.0,0.0,0.5,0.0\n";

class Playing : public testing::Test {
 protected:
  using Shell = drivers::PlaybackShell<Odometry>;
  using Core = drivers::Playback<Odometry>;

  void begin(double speed, bool repeat = false, bool restamp = true) {
    const auto set = [&](const char* name, const Value& value) {
      ASSERT_TRUE(bench_.core().find_property(name)->set(value)) << name;
    };
    set("recording", Value(place_.write("drive.csv", kDrive).string()));
    set("speed", Value(speed));
    set("repeat", Value(repeat));
    set("restamp", Value(restamp));
    const auto done = bench_.configure();
    ASSERT_TRUE(done) << to_string(done.error());
  }
  /// The x of the value that is there after a job that runs `later` than the one before.
  double x_after(mauve::Duration later) {
    bench_.advance(later);
    bench_.core().update();
    return written().x;
  }
  Odometry written() {
    const auto value = bench_.written(bench_.shell().out);
    return value ? *value : Odometry{};
  }
  std::string observed(const char* name) {
    return to_string(bench_.core().find_observable(name)->value());
  }

  mauve::test::TempDir place_;
  mauve::CoreBench<Shell, Core> bench_;
};

/// Two addresses: one begins 6 s after the other one, and ends 2 s before it.
constexpr const char* kTwo =
    "time_s,pose.read.x,pose.read.y,pose.read.heading,goal.read.x,goal.read.y\n"
    "10.0,1.0,0.0,0.0,,\n"
    "12.0,2.0,0.0,0.0,,\n"
    "16.0,,,,77.0,0.0\n"
    "18.0,,,,88.0,0.0\n"
    "20.0,3.0,0.0,0.0,,\n";

template <typename T>
class PlayerOf {
 public:
  PlayerOf(const mauve::test::TempDir& place, const char* address) {
    const auto set = [&](const char* name, const Value& value) {
      EXPECT_TRUE(bench_.core().find_property(name)->set(value)) << name;
    };
    set("recording", Value(place.write("two.csv", kTwo).string()));
    set("address", Value(address));
    set("repeat", Value(true));
    EXPECT_TRUE(bench_.configure());
  }
  double x_after(mauve::Duration later) {
    bench_.advance(later);
    bench_.core().update();
    const auto value = bench_.written(bench_.shell().out);
    return value ? value->x : 0.0;
  }

 private:
  mauve::CoreBench<drivers::PlaybackShell<T>, drivers::Playback<T>> bench_;
};

/// Values that were recorded together are played together, also when they are repeated.
TEST(PlayersOfOneFile, HaveOneClock) {
  mauve::test::TempDir place;
  PlayerOf<rover::Pose2D> pose(place, "pose.read");
  PlayerOf<rover::Point2D> goal(place, "goal.read");
  const auto after = [&](mauve::Duration later) {
    return std::pair(pose.x_after(later), goal.x_after(later));
  };

  EXPECT_EQ(after(0s), std::pair(1.0, 0.0));
  EXPECT_EQ(after(5999ms), std::pair(2.0, 0.0));
  EXPECT_EQ(after(1ms), std::pair(2.0, 77.0));
  EXPECT_EQ(after(2s), std::pair(2.0, 88.0));
  EXPECT_EQ(after(1999ms), std::pair(2.0, 88.0));
  EXPECT_EQ(after(1ms).first, 1.0) << "at its end the file begins again, for all";
  EXPECT_EQ(after(5999ms), std::pair(2.0, 88.0));
  EXPECT_EQ(after(1ms), std::pair(2.0, 77.0));
}

TEST_F(Playing, WritesEachValueInTheFirstJobAtOrAfterItsTime) {
  begin(1.0);

  EXPECT_EQ(x_after(0ms), 1.0) << "the first job begins the recording";
  EXPECT_EQ(x_after(99ms), 1.0);
  EXPECT_EQ(x_after(1ms), 2.0);
  EXPECT_EQ(x_after(105ms), 3.0);
  EXPECT_EQ(observed("finished"), "false");
  EXPECT_EQ(x_after(5ms), 4.0);
  EXPECT_EQ(observed("finished"), "true");
  EXPECT_EQ(observed("played"), "4");
}

TEST_F(Playing, GoesTwiceAsFastWhereItsPropertySaysSo) {
  begin(2.0);

  EXPECT_EQ(x_after(0ms), 1.0);
  EXPECT_EQ(x_after(49ms), 1.0);
  EXPECT_EQ(x_after(1ms), 2.0);
}

TEST_F(Playing, WritesOneValueInEachJobWithoutAClock) {
  begin(0.0);

  for (const double x : {1.0, 2.0, 3.0, 4.0, 4.0}) EXPECT_EQ(x_after(1ms), x);
}

TEST_F(Playing, BeginsAgainWhereItsPropertySaysSo) {
  begin(0.0, true);

  for (const double x : {1.0, 2.0, 3.0, 4.0, 1.0, 2.0}) EXPECT_EQ(x_after(1ms), x);
}

TEST_F(Playing, MovesTheStampsToThisRunAndKeepsTheirAge) {
  begin(1.0);
  static_cast<void>(x_after(0ms));
  const double first = written().time;
  EXPECT_EQ(x_after(100ms), 2.0);

  EXPECT_NEAR(written().time - first, 0.1, 1e-9);
  EXPECT_NEAR(written().time, 1.1, 1e-9) << "the bench began at 1 s, and this value is new";
}

TEST_F(Playing, LeavesTheStampsAsTheyWereWhereItsPropertySaysSo) {
  begin(1.0, false, false);
  static_cast<void>(x_after(0ms));

  EXPECT_EQ(written().time, 1000.5);
}

TEST_F(Playing, AsksNothingOfHeapAndKernel) {
  begin(1.0, true);
  static_cast<void>(x_after(0ms));

  const auto cost = bench_.cost([&] { bench_.core().update(); });

  EXPECT_EQ(cost.heap_calls, 0U);
  EXPECT_EQ(cost.system_calls, 0U);
}

TEST_F(Playing, RefusesAFileOfAnotherType) {
  const auto file = place_.write("other.csv", "time_s,a.read.z\n1.0,2\n");
  ASSERT_TRUE(bench_.core().find_property("recording")->set(Value(file.string())));

  const auto done = bench_.configure();

  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("has no column of odometry/2"), std::string::npos)
      << to_string(done.error());
}

}  // namespace
