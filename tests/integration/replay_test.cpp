// SPDX-License-Identifier: LGPL-3.0-or-later
/// etc/replay.json in a real daemon: recordings of real receivers through a pseudo-terminal,
/// compared with gpsd's reading of the same bytes, and a real laser recording through the safety
/// pilot.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/serial/serial_port.h>

#include "../../plugins/drivers/gnss/nmea_write.h"
#include "support/daemon_process.h"
#include "support/gpsd_check.h"
#include "support/test_data.h"

namespace {

using mauve::test::DaemonProcess;
using mauve::test::eventually;
using mauve::test::Process;
using mauve::test::TempDir;
using nlohmann::json;

const std::filesystem::path kRoot = MAUVE_SOURCE_DIR;

/// etc/replay.json with the device and, unless empty, the recording set; quicker than life.
std::string replay(const std::string& device, const std::string& recording) {
  std::ifstream file(kRoot / "etc" / "replay.json");
  json architecture = json::parse(file, nullptr, true, true);
  architecture.erase("$schema");
  json& components = architecture["components"];
  components["gnss"]["properties"]["core.device"] = device;
  components["gnss"]["properties"]["fsm.period"] = "5ms";
  components["gnss"]["properties"]["core.speed_limit"] = 0.0;  // from one recording to the next
  components["laser"]["properties"]["core.recording"] =
      recording.empty() ? (kRoot / "etc" / "samples" / "laser.dat").string() : recording;
  components["laser"]["properties"]["fsm.period"] = "5ms";
  return architecture.dump();
}

/// The daemon on replay.json, a line to its GNSS driver, and a watch on what it publishes.
class Replay : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(line_.open(""));
    daemon_.emplace(place_.write("replay.json", replay(line_.device(), "")));
    ASSERT_TRUE(daemon_->up()) << daemon_->errors();
    watch_.emplace(daemon_->client_words({"watch", "fix.read"}));
    // A fix of our own, each time of another epoch, until one is seen: from then on nothing is
    // lost.
    ASSERT_TRUE(eventually([this, time = 100.0]() mutable {
      send(writer_.compose({time++, 1.0, 1.0, 1.0, 1.0, 3, 4}, 0.0, 0.0));
      return !take_fixes().empty();
    }));
    settle();
  }

  /// Sends all of it, waiting while the line is full.
  void send(std::string_view bytes) {
    ASSERT_TRUE(eventually([&] {
      bytes.remove_prefix(line_.send_some(bytes));
      return bytes.empty();
    }));
  }

  /// New values of fix.read, without those of settle().
  std::vector<json> take_fixes() {
    std::vector<json> fixes;
    for (const std::string& text : watch_->lines()) {
      const json line = json::parse(text, nullptr, false);
      EXPECT_FALSE(line.contains("dropped")) << text;
      if (line.is_object() && line.contains("value") && line["value"].is_object()) {
        fixes.push_back(line["value"]);
      }
    }
    return fixes;
  }

  /// As many fixes as `count`, or those that came until the limit.
  std::vector<json> fixes(std::size_t count) {
    std::vector<json> all;
    (void)eventually([&] {
      for (json& fix : take_fixes()) all.push_back(std::move(fix));
      return all.size() >= count;
    });
    return all;
  }

  /// Waits until every fix that was sent so far has been seen.
  void settle() {
    send(writer_.compose({2.0, 2.0, 2.0, 2.0, 1.0, 3, 4}, 0.0, 0.0));
    ASSERT_TRUE(eventually([this] {
      for (const json& fix : take_fixes()) {
        if (fix["latitude"] == 2.0) return true;
      }
      return false;
    }));
  }

  std::uint64_t bad_frames() { return daemon_->value("gnss.core.bad_frames").get<std::uint64_t>(); }

  TempDir place_;
  mauve::serial::PseudoTerminal line_;
  drivers::NmeaWriter writer_;
  std::optional<DaemonProcess> daemon_;
  std::optional<Process> watch_;
};

/// `compared`: the reports with a place so far.
void expect_same(const json& fix, const support::GpsdReport& report, int& compared) {
  EXPECT_EQ(fix["mode"], report.mode);
  if (!report.latitude) return;
  ++compared;
  EXPECT_NEAR(fix["latitude"], *report.latitude, 1e-7);
  EXPECT_NEAR(fix["longitude"], report.longitude.value_or(fix["longitude"]), 1e-7);
  EXPECT_NEAR(fix["altitude"], report.altitude.value_or(fix["altitude"]), 1e-3);
}

TEST_F(Replay, PublishesEveryEpochOfEveryReceiverAsGpsdReadsIt) {
  const auto folder = support::test_data("nmea");
  if (!folder) GTEST_SKIP() << support::kNoTestData;
  int compared = 0;

  for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
    if (entry.path().extension() != ".log") continue;
    SCOPED_TRACE(entry.path().filename());
    const auto epochs = support::gpsd_epochs(entry.path().string() + ".chk");
    const std::uint64_t bad_before = bad_frames();

    send(support::bytes_of(entry.path()));
    const std::vector<json> seen = fixes(epochs.size());

    ASSERT_EQ(seen.size(), epochs.size());
    for (std::size_t i = 0; i < epochs.size(); ++i) {
      SCOPED_TRACE(epochs[i].gga);
      for (const auto& report : epochs[i].reports) expect_same(seen[i], report, compared);
    }
    settle();
    EXPECT_EQ(bad_frames() - bad_before, 0U);
  }

  EXPECT_GT(compared, 0) << "reports with a place";
}

TEST_F(Replay, CountsAndSkipsDamagedSentencesAndUsesTheNextGoodOne) {
  std::string damaged;
  for (int i = 0; i < 40; ++i) {
    const double latitude = 40.0 + 0.01 * i;
    std::string epoch(writer_.compose({10.0 + i, latitude, 5.0, 100.0, 1.0, 3, 7}, 0.0, 0.0));
    if (i % 4 == 1) epoch[20] = static_cast<char>(epoch[20] ^ 0x02);  // a bit flips in GGA
    if (i % 4 == 3) epoch.erase(30, epoch.find('\n') - 29);           // GGA breaks off
    damaged += epoch;
  }

  send(damaged);
  const std::vector<json> seen = fixes(20);
  settle();

  ASSERT_EQ(seen.size(), 20U);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_NEAR(seen[i]["latitude"], 40.0 + 0.02 * static_cast<double>(i), 1e-7);
  }
  EXPECT_EQ(bad_frames(), 10U) << "those that broke off have no checksum";
  EXPECT_TRUE(daemon_->says("gnss: damaged frames: 10 so far")) << daemon_->errors();
}

TEST_F(Replay, PublishesNothingWhileDisconnectedAndGoesOnAfterwards) {
  EXPECT_EQ(daemon_->ask({"disconnect", "gnss.ports.fix"})["state"], "applied");
  // Seven satellites distinguish it from all that was sent before: it is read while nothing is
  // connected.
  send(writer_.compose({3.0, 3.0, 3.0, 3.0, 1.0, 3, 7}, 0.0, 0.0));
  ASSERT_TRUE(eventually([this] { return daemon_->value("gnss.core.satellites") == 7; }));
  EXPECT_EQ(daemon_->ask({"connect", "gnss.ports.fix", "fix.write"})["state"], "applied");
  send(writer_.compose({4.0, 4.0, 4.0, 4.0, 1.0, 3, 5}, 0.0, 0.0));

  const std::vector<json> seen = fixes(1);

  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.back()["latitude"], 4.0);
}

TEST(ReplayGnss, OpensItsDeviceAgainWhenItComesBack) {
  TempDir place;
  const std::string device = (place / "receiver").string();
  mauve::serial::PseudoTerminal line;
  drivers::NmeaWriter writer;
  ASSERT_TRUE(line.open(device));
  DaemonProcess daemon(place.write("replay.json", replay(device, "")));
  ASSERT_TRUE(daemon.up()) << daemon.errors();
  double time = 1.0;
  const auto heard = [&](double latitude) {
    return eventually([&] {
      static_cast<void>(
          line.send(writer.compose({time++, latitude, 1.0, 1.0, 1.0, 3, 4}, 0.0, 0.0)));
      const json value = daemon.value("fix.read");
      return value.is_object() && value["latitude"] == latitude;
    });
  };
  ASSERT_TRUE(heard(1.0));

  line.close();
  EXPECT_TRUE(eventually([&] { return daemon.value("gnss.core.device_errors") == 1; }));
  EXPECT_TRUE(eventually([&] {
    return daemon.ask({"show", "gnss"})["fsm_state"] == "wait_device";
  }));
  EXPECT_EQ(daemon.value("gnss.core.reopened"), 0);
  EXPECT_TRUE(daemon.says("gnss: its device is not there (time 1)")) << daemon.errors();

  ASSERT_TRUE(line.open(device));
  EXPECT_TRUE(heard(2.0));
  EXPECT_EQ(daemon.value("gnss.core.reopened"), 1);
  EXPECT_EQ(daemon.value("gnss.core.device_errors"), 1);
  EXPECT_TRUE(daemon.says("gnss: its device is back")) << daemon.errors();
}

TEST(Rover, TwoOnOneMachineHearTheirOwnReceivers) {
  DaemonProcess one(kRoot / "etc" / "rover.json");
  DaemonProcess two(kRoot / "etc" / "rover.json");
  ASSERT_TRUE(one.up()) << one.errors();
  ASSERT_TRUE(two.up()) << two.errors();

  for (DaemonProcess* daemon : {&one, &two}) {
    EXPECT_TRUE(eventually([&] { return daemon->value("gnss.core.fixes") >= 3; }));
    EXPECT_EQ(daemon->value("gnss.core.bad_frames"), 0);
    EXPECT_EQ(daemon->value("gnss.core.device_errors"), 0);
    daemon->process().signal(SIGTERM);
    EXPECT_EQ(daemon->process().wait(), 0) << "its line is closed in order";
  }
}

TEST(ReplayLaser, TheSafetyPilotSlowsAndStopsOnARealRecording) {
  const auto recording = support::test_data("lidar/exp2.dat");
  if (!recording) GTEST_SKIP() << support::kNoTestData;
  TempDir place;
  const auto device = place.write("no.nmea", "");
  DaemonProcess daemon(place.write("replay.json", replay(device.string(), recording->string())));
  ASSERT_TRUE(daemon.up()) << daemon.errors();
  Process watch(daemon.client_words({"watch", "safe_command.read"}));
  std::set<double> speeds;

  EXPECT_TRUE(eventually([&] { return daemon.value("laser.core.scans") == 641; }));
  (void)eventually([&] {
    for (const std::string& text : watch.lines()) {
      const json line = json::parse(text, nullptr, false);
      if (line.is_object() && line.contains("value") && line["value"].is_object()) {
        speeds.insert(line["value"]["linear"].get<double>());
      }
    }
    return speeds.count(0.0) > 0 && speeds.count(0.25) > 0;
  });

  EXPECT_TRUE(eventually([&] { return daemon.value("laser.core.finished") == true; }));
  EXPECT_EQ(daemon.value("scan.read")["ranges"].size(), 682U);
  EXPECT_TRUE(speeds.count(0.0)) << "stops";
  EXPECT_TRUE(speeds.count(0.25)) << "slows";
}

/// etc/playback.json with this recording, stopped at first, one value each job.
std::string playback(const std::filesystem::path& recording) {
  std::ifstream file(kRoot / "etc" / "playback.json");
  json architecture = json::parse(file, nullptr, true, true);
  json& player = architecture["components"]["player"];
  player["start"] = false;
  player["properties"]["core.recording"] = recording.string();
  player["properties"]["core.speed"] = 0.0;
  player["properties"]["core.repeat"] = false;
  player["properties"]["core.restamp"] = false;
  return architecture.dump();
}

/// The rows of a CSV file without their times, and without those of the sentinel.
std::vector<std::string> rows_of(const std::filesystem::path& file) {
  std::vector<std::string> rows;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const auto comma = line.find(',');
    if (comma == std::string::npos || line.find("-77.0") != std::string::npos) continue;
    rows.push_back(line.substr(comma));
  }
  return rows;
}

/// Plays `recording`, and records it into `into`.
void play_and_record(const std::filesystem::path& recording, const std::filesystem::path& into) {
  TempDir place;
  DaemonProcess daemon(place.write("playback.json", playback(recording)));
  ASSERT_TRUE(daemon.up()) << daemon.errors();
  Process recorder = daemon.client({"record", "odometry.read", "-o", into.string()});
  const auto lines = [&] {
    const std::string text = TempDir::read(into.string());
    return std::count(text.begin(), text.end(), '\n');
  };
  // A value of our own until it is seen: from then on nothing is lost.
  const std::string own =
      R"({"time": 0, "x": -77.0, "y": 0, "heading": 0, "linear": 0, "angular": 0})";
  ASSERT_TRUE(eventually([&] {
    static_cast<void>(daemon.ask({"write", "odometry.write", own}));
    return lines() > 1;
  })) << daemon.errors();
  static_cast<void>(daemon.ask({"start", "player"}));
  ASSERT_TRUE(eventually([&] { return daemon.value("player.core.finished") == true; }));
  const auto wanted = rows_of(recording).size();
  EXPECT_TRUE(eventually([&] { return rows_of(into).size() >= wanted; }));
  recorder.signal(SIGINT);
  EXPECT_EQ(recorder.wait(), 0);
}

TEST(Playback, WritesTheRecordedValuesAndARecordingOfItPlaysAgain) {
  TempDir place;
  const auto sample = kRoot / "etc" / "samples" / "odometry.csv";
  ASSERT_EQ(rows_of(sample).size(), 51U) << "with the header";

  play_and_record(sample, place / "once.csv");
  play_and_record(place / "once.csv", place / "twice.csv");

  EXPECT_EQ(rows_of(place / "once.csv"), rows_of(sample));
  EXPECT_EQ(rows_of(place / "twice.csv"), rows_of(sample));
}

TEST(ReplaySamples, PlayFromAnyFolderBecauseTheirPathsBeginAtTheArchitecture) {
  ASSERT_NE(std::filesystem::current_path(), kRoot / "etc");
  DaemonProcess daemon(kRoot / "etc" / "replay.json");
  ASSERT_TRUE(daemon.up()) << daemon.errors();

  EXPECT_TRUE(eventually([&] { return daemon.value("laser.core.scans") == 30; }));
  EXPECT_TRUE(eventually([&] { return daemon.value("gnss.core.fixes") == 26; }));
  EXPECT_EQ(daemon.value("gnss.core.bad_frames"), 0);
}

}  // namespace
