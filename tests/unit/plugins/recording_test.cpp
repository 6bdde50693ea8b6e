// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "../../../plugins/drivers/recording/recording.h"
#include "support/temp_dir.h"
#include "support/test_data.h"

namespace {

using drivers::Recording;

std::string line(long time, int range) {
  std::string text = std::to_string(time);
  for (std::size_t i = 1; i < Recording::kFirstColumn; ++i) text += " 167.2";
  for (std::size_t i = 0; i < Recording::kBeams; ++i) text += " " + std::to_string(range);
  return text + " \n";
}

TEST(Recording, ReadsRangesInMetresAndTimesFromTheFirstScan) {
  const auto recording = Recording::parse(line(5'000'000, 1500) + "\n" + line(5'100'000, 15), "x");
  ASSERT_TRUE(recording);
  ASSERT_EQ(recording->size(), 2U);
  rover::LaserScan scan;

  recording->show(0, scan);
  EXPECT_EQ(scan.ranges.size(), Recording::kBeams);
  EXPECT_FLOAT_EQ(scan.ranges[341], 1.5F);
  EXPECT_FALSE(scan.valid(0)) << "the first 70 look at the robot";
  EXPECT_FALSE(scan.valid(681));
  recording->show(1, scan);

  EXPECT_DOUBLE_EQ(scan.time, 0.1);
  EXPECT_FALSE(scan.valid(341)) << "below 20 mm is an error code";
}

TEST(Recording, NamesTheLineThatIsNoScan) {
  const auto broken = Recording::parse(line(1, 1000) + "1 2 three\n", "exp.dat");

  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().message.find("exp.dat:2"), std::string::npos);
}

TEST(Recording, RefusesAnEmptyOrMissingFile) {
  EXPECT_FALSE(Recording::parse("", "empty"));
  EXPECT_FALSE(Recording::load("/nowhere/exp.dat"));
}

TEST(Recording, IsNotWaitedForWhenItIsNoRegularFile) {
  const mauve::test::TempDir folder;
  const std::string pipe = (folder / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : {pipe, std::string("/dev/zero"), folder.path().string()}) {
    const auto refused = Recording::load(path);
    ASSERT_FALSE(refused) << path;
    EXPECT_NE(refused.error().message.find("it is no regular file"), std::string::npos);
  }
}

TEST(Recording, LoadsARealRecordingWhole) {
  const auto path = support::test_data("lidar/exp2.dat");
  if (!path) GTEST_SKIP() << support::kNoTestData;

  const auto recording = Recording::load(*path);

  ASSERT_TRUE(recording);
  ASSERT_EQ(recording->size(), 641U);
  rover::LaserScan scan;
  recording->show(640, scan);
  EXPECT_GT(scan.time, 60.0);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < recording->size(); ++i) {
    recording->show(i, scan);
    for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) seen += scan.valid(beam) ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(seen) / 641.0, 275.0, 1.0) << "valid beams a scan, on average";
}

}  // namespace
