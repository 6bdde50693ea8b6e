// SPDX-License-Identifier: LGPL-3.0-or-later
/// The receiver's driver on a simulated clock: real plugins, a real pseudo-terminal, and
/// bytes that come as a line brings them.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/serial/serial_port.h>

#include "../../plugins/drivers/gnss/nmea_write.h"
#include "../../plugins/drivers/gnss/ubx_pvt.h"
#include "../../plugins/world/random.h"
#include "serial_drivers.h"
#include "support/gpsd_check.h"
#include "support/sanitized.h"
#include "support/temp_dir.h"
#include "support/test_data.h"

namespace {

using namespace serial;  // NOLINT: the driver
using mauve::test::TempDir;
using rover::GnssFix;

/// One frame a job, so that no published value is missed by who looks each millisecond.
const char* const kOneByOne = R"(, "core.frames_per_job": 1, "fsm.period": "1ms",
    "fsm.wait_frame": "1ms")";

/// Sends the recording in pieces, each `wait` after the one before, and takes every fix.
class Player {
 public:
  Player() {
    EXPECT_TRUE(line_.open(""));
    driver_ = std::make_unique<Simulated>(gnss(line_.device(), kOneByOne));
    EXPECT_TRUE(driver_->up());
    driver_->run(1ms);  // from its first job on it listens
  }

  void send(std::string_view piece, mauve::Duration wait) {
    driver_->take(line_, piece);
    for (mauve::Duration passed{0}; passed < wait; passed += 1ms) step();
  }
  /// Until nothing is left to read.
  void finish() {
    for (int i = 0; i < 3000; ++i) step();
  }
  [[nodiscard]] const std::vector<GnssFix>& fixes() const { return fixes_; }
  [[nodiscard]] const Simulated& driver() const { return *driver_; }

 private:
  void step() {
    driver_->run(1ms);
    const std::int64_t count = driver_->observe("fixes");
    if (count == seen_) return;
    EXPECT_EQ(count, seen_ + 1) << "one was missed";
    seen_ = count;
    fixes_.push_back(driver_->data<GnssFix>());
  }

  PseudoTerminal line_;
  std::unique_ptr<Simulated> driver_;
  std::vector<GnssFix> fixes_;
  std::int64_t seen_ = 0;
};

/// How a line brings the bytes: in pieces of at most so many, or of that many at random.
struct Pace {
  const char* name;
  std::size_t piece;
  bool random;
  mauve::Duration wait;
};

class GnssLine : public testing::TestWithParam<Pace> {};

TEST_P(GnssLine, BringsEveryEpochOfEveryReceiverAsGpsdReadsIt) {
  const auto folder = support::test_data("nmea");
  if (!folder) GTEST_SKIP() << support::kNoTestData;
  world::Random random(5);
  int compared = 0;

  for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
    if (entry.path().extension() != ".log") continue;
    // A sanitizer needs minutes for the four long recordings in small pieces; AtRandom reads them.
    if (support::kSanitized && !GetParam().random && entry.file_size() > 10'000) continue;
    SCOPED_TRACE(entry.path().filename());
    const std::string bytes = support::bytes_of(entry.path());
    const auto epochs = support::gpsd_epochs(entry.path().string() + ".chk");
    Player player;

    for (std::size_t at = 0; at < bytes.size();) {
      const auto most = static_cast<double>(GetParam().piece);
      const auto piece = GetParam().random
                             ? static_cast<std::size_t>(random.uniform(1.0, most + 1.0))
                             : GetParam().piece;
      player.send(std::string_view(bytes).substr(at, piece), GetParam().wait);
      at += piece;
    }
    player.finish();

    ASSERT_EQ(player.fixes().size(), epochs.size());
    for (std::size_t i = 0; i < epochs.size(); ++i) {
      SCOPED_TRACE(epochs[i].gga);
      for (const auto& report : epochs[i].reports) {
        const GnssFix& fix = player.fixes()[i];
        EXPECT_EQ(fix.mode, report.mode);
        if (!report.latitude) continue;
        ++compared;
        EXPECT_NEAR(fix.latitude, *report.latitude, 1e-7);
        EXPECT_NEAR(fix.longitude, report.longitude.value_or(fix.longitude), 1e-7);
      }
    }
    EXPECT_EQ(player.driver().observe("implausible"), 0);
    EXPECT_EQ(player.driver().observe("bad_frames"), 0);
  }

  EXPECT_GT(compared, 0) << "reports with a place";
}

INSTANTIATE_TEST_SUITE_P(Pieces, GnssLine,
                         testing::Values(Pace{"OneByOne", 1, false, 1ms},
                                         Pace{"AtRandom", 900, true, 20ms},
                                         Pace{"At4800Baud", 48, false, 100ms}),
                         [](const auto& pace) { return pace.param.name; });

GnssFix somewhere(double time, double latitude = 43.5) {
  return {time, latitude, 1.5, 150.0, 0.9, 3, 8};
}

std::string nmea(const GnssFix& fix) {
  drivers::NmeaWriter writer;
  return std::string(writer.compose(fix, 0.0, 0.0));
}

std::string ubx(const GnssFix& fix) {
  const auto frame = drivers::write_pvt(fix);
  return {frame.begin(), frame.end()};
}

TEST(GnssDriver, StartsWithoutItsDeviceAndWaitsForIt) {
  const TempDir place;
  const std::string device = (place / "receiver").string();
  Simulated driver(gnss(device));
  ASSERT_TRUE(driver.up());

  driver.run(1s);
  EXPECT_EQ(driver.state(), "wait_device");
  EXPECT_EQ(driver.observe("device_errors"), 1);
  PseudoTerminal line;
  ASSERT_TRUE(line.open(device));
  ASSERT_TRUE(driver.reaches("reopened", 1));
  driver.take(line, nmea(somewhere(1.0)));
  driver.run(200ms);

  EXPECT_EQ(driver.observe("reopened"), 1);
  EXPECT_EQ(driver.observe("fixes"), 1);
}

TEST(GnssDriver, GoesOnWhenItsDeviceIsPluggedInAgain) {
  const TempDir place;
  const std::string device = (place / "receiver").string();
  PseudoTerminal line;
  ASSERT_TRUE(line.open(device));
  Simulated driver(gnss(device));
  ASSERT_TRUE(driver.up());

  for (int time = 1; time <= 3; ++time) {
    driver.run(1ms);
    driver.take(line, nmea(somewhere(time)) + "$GPGGA,12");
    driver.run(500ms);
    line.close();
    ASSERT_TRUE(driver.reaches("device_errors", time));
    EXPECT_EQ(driver.state(), "wait_device");
    ASSERT_TRUE(line.open(device));
    ASSERT_TRUE(driver.reaches("reopened", time));
  }

  EXPECT_EQ(driver.observe("device_errors"), 3);
  EXPECT_EQ(driver.observe("reopened"), 3);
  EXPECT_EQ(driver.observe("fixes"), 3);
  EXPECT_EQ(driver.observe("bad_frames"), 0) << "the sentences broke off before their checksum";
}

TEST(GnssDriver, StillRefusesASpeedThatDoesNotExist) {
  const TempDir place;
  Simulated driver(gnss((place / "receiver").string(), R"(, "core.baud": 1234)"));

  ASSERT_FALSE(driver.up());
  EXPECT_NE(driver.up().error().message.find("1234 baud"), std::string::npos);
}

TEST(GnssDriver, ReadsUbxAndReportsEachEpochOnceAmongNmea) {
  Player player;

  for (int time = 1; time <= 5; ++time) {
    const GnssFix fix = somewhere(time, 43.5 + 1e-5 * time);
    player.send(ubx(fix) + nmea(fix), 1s);
  }

  ASSERT_EQ(player.fixes().size(), 5U);
  EXPECT_NEAR(player.fixes()[4].latitude, 43.50005, 1e-9);
  EXPECT_EQ(player.driver().observe("good_frames"), 20);
  EXPECT_EQ(player.driver().observe("bad_frames"), 0);
}

TEST(GnssDriver, CountsAJumpAndDoesNotPublishIt) {
  Player player;
  for (int time = 1; time <= 10; ++time) player.send(nmea(somewhere(time)), 1s);

  player.send(nmea(somewhere(11.0, 43.6)), 1s);
  player.send(nmea(somewhere(12.0)), 1s);

  EXPECT_EQ(player.fixes().size(), 11U);
  EXPECT_EQ(player.driver().observe("implausible"), 1);
}

TEST(GnssDriver, GivesUpAHalfFrameThatNeverEnds) {
  Player player;
  std::string half = ubx(somewhere(1.0)).substr(0, 40);

  player.send(half, 4s);
  EXPECT_EQ(player.driver().state(), "wait_frame");
  player.send("", 2s);  // half_frame is 5 s
  EXPECT_EQ(player.driver().observe("bad_frames"), 0) << "no checksum came";
  player.send(ubx(somewhere(7.0)), 100ms);

  EXPECT_EQ(player.fixes().size(), 1U);
}

std::string gga(const std::string& talker, int second, int satellites) {
  std::string text = talker + "GGA,1200" + std::to_string(second) +
                     ".00,4334.00000,N,00128.00000,E,1," + std::to_string(satellites) +
                     ",0.9,150.0,M,48.0,M,,";
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  constexpr std::string_view kHex = "0123456789ABCDEF";
  return "$" + text + "*" + kHex[sum / 16U] + kHex[sum % 16U] + "\r\n";
}

TEST(GnssDriver, PublishesAnEpochWithoutItsBestTalkerBeforeTheNext) {
  Player player;
  for (int second = 10; second < 13; ++second) {
    player.send(gga("GP", second, 3), 20ms);
    player.send(gga("GL", second, 7), 980ms);
  }
  for (int second = 13; second < 16; ++second) {
    player.send(gga("GP", second, 4), 990ms);
    EXPECT_EQ(player.driver().observe("satellites"), 4);
  }

  EXPECT_EQ(player.fixes().size(), 6U);
}

TEST(GnssDriver, PublishesEpochsWithoutFixAsSuch) {
  Player player;
  GnssFix none;
  none.time = 5.0;

  player.send(nmea(none), 100ms);
  player.send(ubx(none), 100ms);

  ASSERT_EQ(player.fixes().size(), 2U);
  for (const GnssFix& fix : player.fixes()) EXPECT_EQ(fix.mode, 1);
  EXPECT_EQ(player.driver().observe("mode"), 1);
  EXPECT_EQ(player.driver().observe("satellites"), 0);
}

}  // namespace
