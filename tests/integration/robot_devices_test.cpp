// SPDX-License-Identifier: LGPL-3.0-or-later
/// The drivers of a Hokuyo scanner and of a Create 2 on devices that the test holds in its hands,
/// and that go wrong.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <mauve/serial/serial_port.h>

#include "../../plugins/drivers/base/create_oi.h"
#include "../../plugins/drivers/laser/scip_write.h"
#include "../../plugins/types/pose.h"
#include "../../plugins/types/velocity.h"
#include "robot_drivers.h"
#include "support/temp_dir.h"

namespace {

using namespace robot;  // NOLINT: the architecture
using mauve::test::TempDir;
namespace scip = drivers::scip;
namespace create = drivers::create;

/// A scanner of five beams that the test holds in its hands.
class HandScanner {
 public:
  explicit HandScanner(std::string path) : path_(std::move(path)) { plug(); }
  void plug() {
    EXPECT_TRUE(line_.open(path_));
    measuring_ = false;
  }
  void unplug() { line_.close(); }

  /// Answers, and sends a scan when it shall.
  void turn() {
    std::array<char, 256> bytes{};
    const std::size_t count = line_.receive(bytes);
    for (std::size_t i = 0; i < count; ++i) {
      if (heard_.push(bytes[i]) && !heard_.line().empty()) answer(std::string(heard_.line()));
    }
    if (!measuring_) return;
    line_.send(next_.empty() ? std::string(writer_.scan(request_, 0, values_)) : next_);
  }
  /// Sent in place of scans from now on; empty: scans.
  void say(std::string bytes) { next_ = std::move(bytes); }
  std::string a_scan() { return std::string(writer_.scan(request_, 0, values_)); }
  void refuse(bool refuses) { refuses_ = refuses; }

 private:
  void answer(const std::string& request) {
    if (refuses_) {
      line_.send(writer_.reply(request, "10"));
    } else if (request == "PP") {
      line_.send(writer_.limits(request, {20, 5000, 360, 178, 182, 180, 600}));
    } else {
      line_.send(writer_.reply(request, "00"));
      measuring_ = request[0] == 'M';
    }
    if (const auto wanted = scip::Request::parse(request)) request_ = *wanted;
  }

  std::string path_;
  mauve::serial::PseudoTerminal line_;
  scip::TextReader heard_;
  scip::ReplyWriter writer_;
  scip::Request request_;
  std::array<std::uint32_t, 5> values_{1000, 1001, 1002, 0, 5000};
  std::string next_;
  bool measuring_ = false;
  bool refuses_ = false;
};

class LaserInHand : public testing::Test {
 protected:
  LaserInHand() : scanner_((place_ / "laser").string()), system_(kLaser, path(), "pty:base") {
    system_.meanwhile([this] { scanner_.turn(); });
  }
  [[nodiscard]] std::string path() const { return (place_ / "laser").string(); }
  void expect_scans() {
    EXPECT_TRUE(system_.goes_on("laser", "scans", 5));
    const auto scan = system_.read<rover::LaserScan>("scan");
    ASSERT_EQ(scan.ranges.size(), 5U);
    EXPECT_FLOAT_EQ(scan.ranges[2], 1.002F);
    EXPECT_FALSE(scan.valid(3));
  }

  TempDir place_;
  HandScanner scanner_;
  System system_;
};

TEST_F(LaserInHand, IsWaitedForWhenItIsNotThereAtTheStart) {
  scanner_.unplug();
  System late(kLaser, path(), "pty:base");
  late.meanwhile([this] { scanner_.turn(); });
  ASSERT_TRUE(late.deployed());
  late.deployer().run_for(1s);
  EXPECT_EQ(late.observe("laser", "device_errors"), 1.0);
  scanner_.plug();

  EXPECT_TRUE(late.goes_on("laser", "scans", 5));
  EXPECT_EQ(late.observe("laser", "reopened"), 1.0);
}

TEST_F(LaserInHand, IsOpenedAgainWhenItIsBack) {
  ASSERT_TRUE(system_.deployed());
  expect_scans();

  scanner_.unplug();
  EXPECT_TRUE(system_.reaches("laser", "device_errors", 1));
  system_.deployer().run_for(1s);
  EXPECT_EQ(system_.observe("laser", "reopened"), 0.0);
  scanner_.plug();

  EXPECT_TRUE(system_.reaches("laser", "reopened", 1));
  expect_scans();
}

TEST_F(LaserInHand, IsAskedAgainAfterGarbageOrAHalfScanForEver) {
  ASSERT_TRUE(system_.deployed());
  expect_scans();

  scanner_.say(std::string(200, 'x'));
  EXPECT_TRUE(system_.goes_on("laser", "timeouts", 1));
  EXPECT_GE(system_.observe("laser", "bad_frames"), 1.0);
  scanner_.say("");
  expect_scans();
  const std::string half = scanner_.a_scan().substr(0, 20);
  scanner_.say(half);
  EXPECT_TRUE(system_.goes_on("laser", "timeouts", 1));
  scanner_.say("");
  expect_scans();
}

TEST_F(LaserInHand, IsAskedUntilItGrantsWhatWasAskedFor) {
  scanner_.refuse(true);
  ASSERT_TRUE(system_.deployed());

  EXPECT_TRUE(system_.reaches("laser", "refused", 2));
  EXPECT_EQ(system_.observe("laser", "scans"), 0.0);
  scanner_.refuse(false);

  expect_scans();
}

/// A base that the test holds in its hands.
class BaseInHand : public testing::Test {
 protected:
  BaseInHand() : path_((place_ / "base").string()) {
    EXPECT_TRUE(line_.open(path_));
    system_.emplace(kBase, "pty:laser", path_);
    system_->meanwhile([this] { turn(); });
  }

  void turn() {
    std::array<char, 512> bytes{};
    const std::size_t count = line_.receive(bytes);
    for (std::size_t i = 0; i < count; ++i) {
      if (const auto command = heard_.push(bytes[i])) {
        begun_ += command->opcode == create::Opcode::stream ? 1 : 0;
        if (command->opcode == create::Opcode::drive_direct) {
          last_ = *command;
          driven_ += command->left != 0 || command->right != 0 ? 1 : 0;
        }
      }
    }
    if (silent_) return;
    if (!packets_.empty()) return send(packets_);
    const create::Frame frame = create::frame_of(report_);
    line_.send({frame.data(), frame.size()});
  }
  /// A frame of these packets.
  void send(std::vector<std::uint8_t> data) {
    data.insert(data.begin(), {19, static_cast<std::uint8_t>(data.size())});
    data.push_back(create::checksum(data));
    const std::string frame(data.begin(), data.end());
    line_.send({frame.data(), frame.size()});
  }
  /// Until the base has heard these wheel speeds, mm/s.
  [[nodiscard]] bool hears(int left, int right) {
    return system_->run_until([=, this] {
      if (command_) system_->write("safe_command", *command_);
      return last_ && last_->left == left && last_->right == right;
    });
  }

  TempDir place_;
  std::string path_;
  mauve::serial::PseudoTerminal line_;
  create::CommandReader heard_;
  create::Report report_{0, create::Mode::safe, 100, 100};
  std::optional<create::Command> last_;
  std::optional<rover::Velocity> command_;
  std::vector<std::uint8_t> packets_;  // of its frames, instead of report_
  int begun_ = 0;
  int driven_ = 0;  // commands with a speed
  bool silent_ = false;
  std::optional<System> system_;
};

TEST_F(BaseInHand, StandsWithoutACommandWithAnOldOneAndWithOneThatIsNoNumber) {
  ASSERT_TRUE(system_->deployed());
  EXPECT_TRUE(hears(0, 0));
  command_ = rover::Velocity{0.2, 0.8};
  EXPECT_TRUE(hears(106, 294)) << "0.094 m/s slower and faster";

  command_ = rover::Velocity{0.2, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_TRUE(hears(0, 0));
  EXPECT_GE(system_->observe("base", "bad_commands"), 1.0);

  command_ = rover::Velocity{0.2, 0.0};
  EXPECT_TRUE(hears(200, 200));
  command_.reset();  // nobody writes any more
  EXPECT_TRUE(hears(0, 0));
  EXPECT_EQ(system_->observe("base", "lost_commands"), 1.0);
}

TEST_F(BaseInHand, IsNotDrivenForwardAgainstItsBumper) {
  ASSERT_TRUE(system_->deployed());
  command_ = rover::Velocity{0.2, 0.0};
  EXPECT_TRUE(hears(200, 200));

  report_.contacts = 2;
  EXPECT_TRUE(hears(0, 0));
  EXPECT_EQ(system_->observe("base", "contacts"), 2.0);
  command_ = rover::Velocity{-0.2, 0.0};
  EXPECT_TRUE(hears(-200, -200));
}

TEST_F(BaseInHand, DiscardsTheJumpOfABaseThatBeganAnew) {
  ASSERT_TRUE(system_->deployed());
  EXPECT_TRUE(system_->reaches("base", "frames", 5));
  report_.left = report_.right = 50'000;

  EXPECT_TRUE(system_->reaches("base", "jumps", 1));
  EXPECT_TRUE(system_->goes_on("base", "frames", 5));

  EXPECT_EQ(system_->observe("base", "jumps"), 1.0);
  EXPECT_EQ(system_->read<rover::Odometry>("odometry").x, 0.0);
}

TEST_F(BaseInHand, IsBegunAnewWhenItFallsSilentAndOpenedAgainWhenItIsBack) {
  ASSERT_TRUE(system_->deployed());
  EXPECT_TRUE(system_->reaches("base", "frames", 5));
  silent_ = true;
  const int begun = begun_;
  EXPECT_TRUE(system_->reaches("base", "timeouts", 1));
  EXPECT_TRUE(system_->run_until([&] { return begun_ > begun; }));
  silent_ = false;
  EXPECT_TRUE(system_->goes_on("base", "frames", 5));

  line_.close();
  EXPECT_TRUE(system_->reaches("base", "device_errors", 1));
  ASSERT_TRUE(line_.open(path_));

  EXPECT_TRUE(system_->reaches("base", "reopened", 1));
  EXPECT_TRUE(system_->goes_on("base", "frames", 5));
}

TEST_F(BaseInHand, StandsUntilItHasReported) {
  silent_ = true;
  ASSERT_TRUE(system_->deployed());
  command_ = rover::Velocity{0.2, 0.0};

  EXPECT_TRUE(system_->run_until([&] {
    system_->write("safe_command", *command_);
    return system_->observe("base", "timeouts") >= 3.0;
  }));
  EXPECT_GE(begun_, 3);
  EXPECT_EQ(driven_, 0);

  silent_ = false;
  EXPECT_TRUE(hears(200, 200));
}

TEST_F(BaseInHand, IsReadThoughItSendsMorePacketsInAnotherOrder) {
  packets_ = {44, 0, 100, 8, 0, 43, 0, 100, 35, 2, 7, 0, 200};
  ASSERT_TRUE(system_->deployed());
  command_ = rover::Velocity{0.2, 0.0};
  EXPECT_TRUE(hears(200, 200));

  EXPECT_TRUE(system_->goes_on("base", "frames", 100));
  EXPECT_EQ(system_->observe("base", "timeouts"), 0.0);
  EXPECT_EQ(system_->observe("base", "bad_frames"), 0.0);
  EXPECT_EQ(system_->observe("base", "silent"), 0.0);
  EXPECT_GT(system_->observe("base", "unknown_packets"), 100.0);
}

TEST_F(BaseInHand, StandsAndSaysSoWhileItsFramesLackAPacket) {
  ASSERT_TRUE(system_->deployed());
  command_ = rover::Velocity{0.2, 0.0};
  EXPECT_TRUE(hears(200, 200));

  packets_ = {7, 0, 35, 2, 43, 0, 100};
  EXPECT_TRUE(hears(0, 0));
  const int driven = driven_;
  EXPECT_TRUE(system_->run_until([&] {
    system_->write("safe_command", *command_);
    return system_->observe("base", "silent") == 1.0;
  }));
  EXPECT_EQ(driven_, driven) << "begun anew, it waits for a report";
  EXPECT_GE(system_->observe("base", "timeouts"), 5.0);
  EXPECT_EQ(system_->reason("base", "silent"), "its base's frames lack packet 44, which is needed");
  EXPECT_GT(system_->observe("base", "lacking_frames"), 100.0);
  EXPECT_EQ(system_->observe("base", "bad_frames"), 0.0);

  packets_.clear();
  EXPECT_TRUE(hears(200, 200));
  EXPECT_TRUE(system_->run_until([&] { return system_->observe("base", "silent") == 0.0; }));
}

TEST_F(BaseInHand, NamesAnUnreadableStreamAndADeadOne) {
  packets_ = {7, 0, 35};  // no frame: a packet is cut
  ASSERT_TRUE(system_->deployed());
  const auto is_silent = [&] { return system_->observe("base", "silent") == 1.0; };

  EXPECT_TRUE(system_->run_until(is_silent));
  EXPECT_EQ(system_->reason("base", "silent"),
            "its base sends bytes, and no undamaged frame: look at `baud`");
  packets_.clear();
  EXPECT_TRUE(system_->run_until([&] { return !is_silent(); }));

  silent_ = true;
  EXPECT_TRUE(system_->run_until(is_silent));
  EXPECT_EQ(system_->reason("base", "silent"), "its base sends nothing");
}

TEST_F(BaseInHand, IsWaitedForWhenItIsNotThereAtTheStart) {
  line_.close();
  System late(kBase, "pty:laser", path_);
  late.meanwhile([this] { turn(); });
  ASSERT_TRUE(late.deployed());
  late.deployer().run_for(1s);
  EXPECT_EQ(late.observe("base", "device_errors"), 1.0);
  ASSERT_TRUE(line_.open(path_));

  EXPECT_TRUE(late.goes_on("base", "frames", 5));
  EXPECT_EQ(late.observe("base", "reopened"), 1.0);
}

TEST_F(BaseInHand, GetsTheOrderToStandWhenItsDriverIsCleanedUp) {
  ASSERT_TRUE(system_->deployed());
  command_ = rover::Velocity{0.2, 0.0};
  EXPECT_TRUE(hears(200, 200));

  system_.reset();

  EXPECT_TRUE(mauve::test::eventually([this] {
    turn();
    return last_->left == 0 && last_->right == 0;
  }));
}

}  // namespace
