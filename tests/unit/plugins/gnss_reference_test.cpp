// SPDX-License-Identifier: LGPL-3.0-or-later
/// Our reading of real receivers against gpsd's reading of the same bytes.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "../../../plugins/drivers/nmea_fix.h"
#include "../../../plugins/drivers/nmea_frame.h"
#include "support/gpsd_check.h"
#include "support/test_data.h"

namespace {

using drivers::FixReader;
using drivers::FrameReader;

struct Reading {
  std::vector<rover::GnssFix> fixes;
  std::uint32_t bad = 0;
};

Reading read(const std::string& bytes) {
  FrameReader frames;
  FixReader fixes;
  Reading reading;
  for (const char byte : bytes) {
    if (frames.push(byte) != FrameReader::Event::frame) continue;
    const FixReader::Event event = fixes.read(frames.frame());
    if (event == FixReader::Event::fix) reading.fixes.push_back(fixes.fix());
    EXPECT_NE(event, FixReader::Event::malformed) << frames.frame();
  }
  reading.bad = frames.bad();
  return reading;
}

void expect_same(const rover::GnssFix& fix, const support::GpsdReport& report) {
  EXPECT_EQ(fix.mode, report.mode);
  EXPECT_NEAR(fix.latitude, report.latitude.value_or(fix.latitude), 1e-7);
  EXPECT_NEAR(fix.longitude, report.longitude.value_or(fix.longitude), 1e-7);
  EXPECT_NEAR(fix.altitude, report.altitude.value_or(fix.altitude), 1e-3);
}

TEST(GnssReference, EveryEpochOfEveryReceiverIsAsGpsdReadsIt) {
  const auto folder = support::test_data("nmea");
  if (!folder) GTEST_SKIP() << support::kNoTestData;
  std::size_t compared = 0;

  for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
    if (entry.path().extension() != ".log") continue;
    SCOPED_TRACE(entry.path().filename());
    const Reading reading = read(support::bytes_of(entry.path()));
    const auto epochs = support::gpsd_epochs(entry.path().string() + ".chk");

    // This one recording ends in a truncated sentence.
    EXPECT_EQ(reading.bad, entry.path().filename() == "ublox-8.log" ? 1U : 0U);
    ASSERT_EQ(reading.fixes.size(), epochs.size());
    for (std::size_t i = 0; i < epochs.size(); ++i) {
      SCOPED_TRACE(epochs[i].gga);
      for (const auto& report : epochs[i].reports) {
        expect_same(reading.fixes[i], report);
        ++compared;
      }
    }
  }

  EXPECT_GT(compared, 1000U);
}

}  // namespace
