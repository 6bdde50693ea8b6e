// SPDX-License-Identifier: LGPL-3.0-or-later
/// The drivers of serial devices on a simulated clock: real plugins, a real pseudo-terminal, and
/// bytes that come as a line brings them.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/architecture.h>
#include <mauve/deployer.h>

#include "../../plugins/drivers/nmea_write.h"
#include "../../plugins/drivers/serial_port.h"
#include "../../plugins/drivers/ubx_pvt.h"
#include "../../plugins/drivers/xbus_imu.h"
#include "../../plugins/world/random.h"
#include "arch/load.h"
#include "plugin/catalog.h"
#include "support/gpsd_check.h"
#include "support/temp_dir.h"
#include "support/test_data.h"

namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using drivers::PseudoTerminal;
using mauve::Value;
using mauve::test::TempDir;
using rover::GnssFix;
using rover::Imu;

/// A driver "driver" of `kind`, whose output goes to the resource "data".
std::string driver(const std::string& kind, const std::string& type, const std::string& port,
                   const std::string& device, const std::string& more = {}) {
  return R"({"schema": "mauve/architecture/1", "name": "line", "plugins": ["types", "drivers"],
    "resources": {"data": {"type": "shared_data", "data": ")" +
         type + R"("}}, "components": {"driver": {"type": ")" + kind +
         R"(", "properties": {"core.device": ")" + device + "\"" + more + R"(}, "ports": {")" +
         port + R"(": "data.write"}}}})";
}

std::string gnss(const std::string& device, const std::string& more = {}) {
  return driver("drivers/gnss", "gnss_fix/1", "fix", device, more);
}

std::string imu(const std::string& device) { return driver("drivers/imu", "imu/1", "imu", device); }

/// An architecture deployed without threads.
class Simulated {
 public:
  explicit Simulated(const std::string& text) : catalog_({MAUVE_PLUGIN_DIR}) {
    mauve::arch::Problems problems;
    architecture_ = mauve::arch::load(text, catalog_, problems);
    if (architecture_ == nullptr) {
      ADD_FAILURE() << "does not load: " << text;
      return;
    }
    deployer_ = std::make_unique<mauve::Deployer>(
        *architecture_, mauve::DeployOptions{mauve::Realtime::off, true, mauve::Admission::warn});
    up_ = deployer_->deploy();
  }

  [[nodiscard]] const mauve::Status& up() const { return up_; }
  void run(mauve::Duration duration) { deployer_->run_for(duration); }
  [[nodiscard]] std::string state() const { return deployer_->status("driver").fsm_state; }

  [[nodiscard]] std::int64_t observe(const std::string& name,
                                     const std::string& owner = "driver") const {
    const Value value = architecture_->find_component(owner)->core().find_observable(name)->value();
    return *value.get_if<std::int64_t>();
  }

  /// The value of resource "data" now.
  template <typename T>
  [[nodiscard]] T data() const {
    T value;
    mauve::Cursor cursor;
    (void)architecture_->find_resource("data")->find_service("read")->read(&value, cursor);
    return value;
  }

 private:
  mauve::plugin::Catalog catalog_;
  std::unique_ptr<mauve::Architecture> architecture_;
  std::unique_ptr<mauve::Deployer> deployer_;
  mauve::Status up_ = mauve::ok();
};

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
  }

  void send(std::string_view piece, mauve::Duration wait) {
    ASSERT_TRUE(line_.send(piece));
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

  for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
    if (entry.path().extension() != ".log") continue;
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
        EXPECT_NEAR(fix.latitude, report.latitude.value_or(fix.latitude), 1e-7);
        EXPECT_NEAR(fix.longitude, report.longitude.value_or(fix.longitude), 1e-7);
      }
    }
    EXPECT_EQ(player.driver().observe("implausible"), 0);
    // This one recording ends in a truncated sentence.
    EXPECT_EQ(player.driver().observe("bad_frames"),
              entry.path().filename() == "ublox-8.log" ? 1 : 0);
  }
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

std::string xbus(const Imu& imu, std::uint32_t ticks) {
  drivers::ImuWriter writer;
  const auto frame = writer.compose(imu, ticks);
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
  driver.run(200ms);
  ASSERT_TRUE(line.send(nmea(somewhere(1.0))));
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
    ASSERT_TRUE(line.send(nmea(somewhere(time)) + "$GPGGA,12"));
    driver.run(500ms);
    line.close();
    driver.run(500ms);
    EXPECT_EQ(driver.state(), "wait_device");
    ASSERT_TRUE(line.open(device));
    driver.run(500ms);
  }

  EXPECT_EQ(driver.observe("device_errors"), 3);
  EXPECT_EQ(driver.observe("reopened"), 3);
  EXPECT_EQ(driver.observe("fixes"), 3);
  EXPECT_EQ(driver.observe("bad_frames"), 3) << "the sentences that broke off";
}

TEST(GnssDriver, StillRefusesASpeedThatDoesNotExist) {
  const TempDir place;
  Simulated driver(gnss((place / "receiver").string(), R"(, "core.baud": 1234)"));

  ASSERT_FALSE(driver.up());
  EXPECT_NE(driver.up().error().message.find("1234 baud"), std::string::npos);
}

TEST(GnssDriver, ReadsUbxAndTellsEachEpochOnceAmongNmea) {
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
  EXPECT_EQ(player.driver().observe("bad_frames"), 0);
  EXPECT_EQ(player.driver().state(), "wait_frame");
  player.send("", 2s);  // half_frame is 5 s
  EXPECT_EQ(player.driver().observe("bad_frames"), 1);
  player.send(ubx(somewhere(7.0)), 100ms);

  EXPECT_EQ(player.fixes().size(), 1U);
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

TEST(ImuDriver, PublishesEachMeasurementInGarbageAndWithoutItsDevice) {
  const TempDir place;
  const std::string device = (place / "imu").string();
  Simulated driver(imu(device));
  ASSERT_TRUE(driver.up());
  driver.run(300ms);
  EXPECT_EQ(driver.state(), "wait_device");
  PseudoTerminal line;
  ASSERT_TRUE(line.open(device));
  driver.run(300ms);

  for (unsigned i = 0; i < 100; ++i) {
    ASSERT_TRUE(line.send("garbage\xfa" + xbus({0.0, 0.01 * i, 0.0, 0.0, 0.5, true}, 100 * i)));
    driver.run(10ms);
  }
  driver.run(100ms);

  EXPECT_EQ(driver.observe("measurements"), 100);
  EXPECT_EQ(driver.observe("reopened"), 1);
  EXPECT_EQ(driver.observe("bad_frames"), 0);
  EXPECT_NEAR(driver.data<Imu>().yaw_rate, 0.99, 1e-6);
  EXPECT_NEAR(driver.data<Imu>().heading, 0.5, 1e-6);
}

TEST(ImuDriver, CountsDamageAndValuesThatAreNoNumbers) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  Simulated driver(imu(line.device()));
  ASSERT_TRUE(driver.up());
  std::string damaged = xbus({}, 1);
  damaged[20] = static_cast<char>(damaged[20] ^ 0x10);

  ASSERT_TRUE(line.send(damaged + xbus({0.0, NAN, 0.0, 0.0, 0.0, false}, 2)));
  ASSERT_TRUE(line.send(xbus({}, 3) + xbus({}, 4).substr(0, 20)));
  driver.run(500ms);
  EXPECT_EQ(driver.observe("bad_frames"), 1);
  EXPECT_EQ(driver.observe("implausible"), 1);
  EXPECT_EQ(driver.observe("measurements"), 1);
  driver.run(6s);

  EXPECT_EQ(driver.observe("bad_frames"), 2) << "the half frame";
}

/// The simulated world at the far end: a receiver and a unit that speak to the real drivers.
std::string world(const std::string& protocol) {
  return R"({"schema": "mauve/architecture/1", "name": "line", "plugins": ["types", "drivers"],
    "resources": {"world": {"type": "drivers/world",
                            "properties": {"core.imu_heading_noise": 0.01}},
                  "fix": {"type": "shared_data", "data": "gnss_fix/1"},
                  "data": {"type": "shared_data", "data": "imu/1"}},
    "components": {
      "gnss": {"type": "drivers/gnss", "properties": {"core.device": "pty:gnss"},
               "ports": {"fix": "fix.write"}},
      "driver": {"type": "drivers/imu", "properties": {"core.device": "pty:imu"},
                 "ports": {"imu": "data.write"}},
      "receiver": {"type": "drivers/receiver_sim", "ports": {"antenna": "world.antenna"},
                   "properties": {"fsm.period": "100ms", "core.protocol": ")" +
         protocol + R"("}},
      "unit": {"type": "drivers/imu_sim", "ports": {"world": "world.imu"}}}})";
}

TEST(SimulatedDevices, SpeakToTheRealDriversListedBeforeThem) {
  for (const char* protocol : {"nmea", "ubx"}) {
    SCOPED_TRACE(protocol);
    Simulated line(world(protocol));
    ASSERT_TRUE(line.up());

    line.run(5s);

    EXPECT_GE(line.observe("fixes", "gnss"), 40);
    EXPECT_EQ(line.observe("bad_frames", "gnss"), 0);
    EXPECT_EQ(line.observe("satellites", "gnss"), 9);
    EXPECT_GE(line.observe("measurements"), 450);
    EXPECT_EQ(line.observe("bad_frames"), 0);
    EXPECT_TRUE(line.data<Imu>().has_heading);
    EXPECT_LT(std::abs(line.data<Imu>().yaw_rate), 0.1);
  }
}

TEST(SimulatedDevices, RefuseAProtocolThatDoesNotExist) {
  Simulated line(world("morse"));

  ASSERT_FALSE(line.up());
  EXPECT_NE(line.up().error().message.find("nmea or ubx"), std::string::npos);
}

}  // namespace
