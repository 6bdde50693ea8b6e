// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "../../../plugins/drivers/base/create_oi.h"
#include "../../../plugins/drivers/base/wheels.h"
#include "../../../plugins/world/random.h"

namespace {

using namespace drivers::create;
using drivers::WheelOdometry;
using drivers::Wheels;
using Event = ReportReader::Event;
using Step = WheelOdometry::Step;

std::string text(const Report& report) {
  const Frame frame = frame_of(report);
  return {frame.begin(), frame.end()};
}

/// A frame of these packets.
std::string sealed(std::vector<std::uint8_t> data) {
  data.insert(data.begin(), {19, static_cast<std::uint8_t>(data.size())});
  data.push_back(checksum(data));
  return {data.begin(), data.end()};
}

Report some_report(world::Random& random) {
  const auto number = [&random](double below) {
    return static_cast<unsigned>(random.uniform(0.0, below));
  };
  return {static_cast<std::uint8_t>(number(16)), static_cast<Mode>(number(4)),
          static_cast<std::uint16_t>(number(65'536)), static_cast<std::uint16_t>(number(65'536))};
}

struct Heard {
  std::vector<Report> reports;
  int bad = 0;
  std::vector<int> lacks;
};

Heard hear(std::string_view bytes) {
  ReportReader reader;
  Heard heard;
  for (const char byte : bytes) {
    reader.push(byte);
    for (Event event = reader.next(); event != Event::none; event = reader.next()) {
      if (event == Event::report) heard.reports.push_back(reader.report());
      if (event == Event::bad) ++heard.bad;
      if (event == Event::lacking) heard.lacks.push_back(reader.packets().lacks);
    }
  }
  return heard;
}

TEST(CreateStream, SumsAsTheSpecificationShows) {
  const std::array<std::uint8_t, 7> example{19, 5, 29, 2, 25, 13, 0};

  EXPECT_EQ(checksum(example), 163);
}

TEST(CreateStream, ReadsWhatTheBaseSends) {
  const std::string bytes = text({0x9, Mode::safe, 0xffff, 0x0102});

  EXPECT_EQ(bytes.substr(0, 12),
            std::string("\x13\x0a\x07\x09\x23\x02\x2b\xff\xff\x2c\x01\x02", 12));
  const Heard heard = hear(bytes);
  ASSERT_EQ(heard.reports.size(), 1U);
  EXPECT_TRUE(heard.reports[0].bumped());
  EXPECT_TRUE(heard.reports[0].wheel_dropped());
  EXPECT_TRUE(heard.reports[0].obeys());
  EXPECT_EQ(heard.reports[0].left, 0xffff);
  EXPECT_EQ(heard.reports[0].right, 0x0102);
  EXPECT_EQ(heard.bad, 0);
}

TEST(CreateStream, ReadsFramesWhoseDataLookLikeHeaders) {
  const Report strange{0, Mode::full, 0x130a, 0x0713};

  const Heard heard = hear((text(strange) + text(strange)).substr(5) + text(strange));

  EXPECT_EQ(heard.reports, (std::vector<Report>{strange, strange}));
  EXPECT_EQ(heard.bad, 0) << "it began in the middle of a frame";
}

TEST(CreateStream, CountsADamagedFrameOnceAndReadsTheNext) {
  const std::string good = text({0, Mode::safe, 100, 200});
  std::string flipped = good;
  flipped[8] = static_cast<char>(flipped[8] ^ 4);
  const std::string cut = good.substr(0, 6);

  const Heard heard = hear(good + flipped + good + cut + good);

  EXPECT_EQ(heard.reports.size(), 3U);
  EXPECT_EQ(heard.bad, 2);
}

TEST(CreateStream, CountsGarbageByTheLengthOfAFrame) {
  const std::string good = text({0, Mode::safe, 100, 200});

  const Heard heard = hear(good + std::string(1300, '\x13') + good);

  EXPECT_EQ(heard.reports.size(), 2U);
  EXPECT_EQ(heard.bad, 100);
}

TEST(CreateStream, CallsNoFrameDamagedWhoseModeIsNotKnown) {
  for (int mode = 0; mode < 256; ++mode) {
    const Heard heard = hear(text({0, static_cast<drivers::create::Mode>(mode), 1000, 2000}));
    ASSERT_EQ(heard.reports.size(), 1U) << mode;
    EXPECT_EQ(heard.bad, 0);
    EXPECT_EQ(heard.reports[0].obeys(), mode == 2 || mode == 3);
  }
}

TEST(CreateStream, ReadsFramesWithOtherPacketsAndAnotherOrder) {
  const Report sent{1, Mode::safe, 0x1234, 0x5678};
  std::vector<std::uint8_t> groups{35, 2, 1, 1, 0,   0,    0,    0,    0,
                                   0,  0, 0, 0, 101, 0x12, 0x34, 0x56, 0x78};
  groups.resize(groups.size() + 24);
  const std::vector<std::vector<std::uint8_t>> frames = {
      groups,
      {7, 1, 8, 0, 35, 2, 43, 0x12, 0x34, 44, 0x56, 0x78},             // a wall, in the middle
      {44, 0x56, 0x78, 35, 2, 43, 0x12, 0x34, 19, 0xff, 0x13, 7, 1},   // another order, a way
      {7, 1, 35, 2, 43, 0x12, 0x34, 44, 0x56, 0x78, 250, 19, 10, 7}};  // one that is not known

  for (const auto& data : frames) {
    const std::string frame = sealed(data);
    const Heard heard = hear(frame + frame);

    EXPECT_EQ(heard.reports, (std::vector<Report>{sent, sent})) << data.size();
    EXPECT_EQ(heard.bad, 0) << data.size();
  }
}

TEST(CreateStream, NamesThePacketThatAFrameLacks) {
  const std::string without = sealed({7, 1, 35, 2, 43, 0x12, 0x34});
  const std::string hidden = sealed({7, 1, 99, 35, 2, 43, 0x12, 0x34, 44, 0x56, 0x78});

  const Heard heard = hear(without + hidden + without);

  EXPECT_EQ(heard.lacks, (std::vector<int>{44, 35, 44}));
  EXPECT_TRUE(heard.reports.empty());
  EXPECT_EQ(heard.bad, 0);
}

TEST(CreateStream, FindsTheFramesOfABaseThatStandsFromWhereverItBegins) {
  for (unsigned counts = 0; counts < 0x10000; counts += 7) {
    const auto left = static_cast<std::uint16_t>(0x130a ^ (counts & 0xfU));
    const std::string frame = text({0, Mode::full, left, static_cast<std::uint16_t>(counts)});
    for (std::size_t begin = 1; begin < frame.size(); ++begin) {
      ASSERT_EQ(hear((frame + frame + frame).substr(begin)).reports.size(), 2U)
          << counts << " from " << begin;
    }
  }
}

TEST(CreateStream, CallsAFrameDamagedWhosePacketsDoNotFillIt) {
  const std::string good = text({0, Mode::safe, 100, 200});

  const Heard heard = hear(good + sealed({7, 1, 35, 2, 43, 0x12, 0x34, 44, 0x56}) + good);

  EXPECT_EQ(heard.reports.size(), 2U);
  EXPECT_EQ(heard.bad, 1);
}

TEST(CreateStream, ADamagedLengthHidesNoFrameBehindIt) {
  const std::string good = text({0, Mode::safe, 100, 200});
  for (int length = 0; length < 256; ++length) {
    if (length == 10) continue;
    std::string damaged = good;
    damaged[1] = static_cast<char>(length);

    const Heard heard = hear(good + damaged + good + good);

    ASSERT_EQ(heard.reports.size(), 3U) << length;
    EXPECT_EQ(heard.bad, 1) << length;
  }
}

TEST(CreateStream, NeverUsesAFrameInWhichAnyBitFlipped) {
  world::Random random(3);
  for (int round = 0; round < 50; ++round) {
    const Report sent = some_report(random);
    const std::string good = text(sent);
    for (std::size_t byte = 0; byte < good.size(); ++byte) {
      for (unsigned bit = 0; bit < 8; ++bit) {
        std::string flipped = good;
        flipped[byte] = static_cast<char>(static_cast<unsigned char>(flipped[byte]) ^ (1U << bit));
        const Heard heard = hear(flipped + good);
        ASSERT_EQ(heard.reports, std::vector<Report>{sent}) << byte << "." << bit;
      }
    }
  }
}

TEST(CreateStream, FindsEveryWholeFrameAmongLostAndAddedBytes) {
  world::Random random(5);
  std::string stream;
  std::vector<Report> sent;
  for (int i = 0; i < 2000; ++i) {
    const Report report = some_report(random);
    std::string frame = text(report);
    const auto at = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(kFrame)));
    switch (i % 4) {
      case 1:
        frame.erase(at, 1);
        break;
      case 2:
        frame.insert(0, at, '\x13');
        sent.push_back(report);
        break;
      default:
        sent.push_back(report);
    }
    stream += frame;
  }

  EXPECT_EQ(hear(stream).reports, sent);
}

TEST(CreateCommands, AreHeardAsTheyWereSent) {
  const auto drive = drive_text(-500, 123);
  EXPECT_EQ(std::string(drive.begin(), drive.end()), std::string("\x91\x00\x7b\xfe\x0c", 5))
      << "the right wheel first";
  CommandReader reader;
  std::vector<Command> heard;
  std::string bytes(begin_text());
  bytes += '\x8c';  // an opcode that the simulated base does not know
  bytes.append(drive.begin(), drive.end());
  for (const char byte : bytes) {
    if (const auto command = reader.push(byte)) heard.push_back(*command);
  }

  ASSERT_EQ(heard.size(), 4U);
  EXPECT_EQ(heard[0].opcode, Opcode::start);
  EXPECT_EQ(heard[1].opcode, Opcode::safe);
  EXPECT_EQ(heard[2].opcode, Opcode::stream);
  EXPECT_EQ(heard[3].opcode, Opcode::drive_direct);
  EXPECT_EQ(heard[3].left, -500);
  EXPECT_EQ(heard[3].right, 123);
}

TEST(CreateCommands, StayWithinWhatTheBaseTakes) {
  EXPECT_EQ(drive_text(9000, -9000), drive_text(500, -500));
}

TEST(Wheels, TurnInOppositeDirectionsOnTheSpot) {
  const drivers::WheelSpeeds speeds = drivers::wheel_speeds({0.0, 1.0}, Wheels{});

  EXPECT_DOUBLE_EQ(speeds.right, 0.1175);
  EXPECT_DOUBLE_EQ(speeds.left, -0.1175);
}

TEST(Wheels, KeepTheCurveWhenTheyWouldBeTooFast) {
  const Wheels wheels;
  const rover::Velocity wanted{1.0, 2.0};
  const drivers::WheelSpeeds speeds = drivers::wheel_speeds(wanted, wheels);
  const rover::Velocity driven = drivers::velocity_of(speeds, wheels);

  EXPECT_DOUBLE_EQ(speeds.right, 0.5);
  EXPECT_NEAR(driven.angular / driven.linear, wanted.angular / wanted.linear, 1e-9);
}

TEST(Wheels, StandStillWhenTheCommandIsNoNumber) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const rover::Velocity& odd :
       {rover::Velocity{kNan, 0.0}, {0.1, kNan}, {kInfinite, 0.0}, {0.1, -kInfinite}}) {
    const drivers::WheelSpeeds speeds = drivers::wheel_speeds(odd, Wheels{});
    EXPECT_EQ(speeds.left, 0.0);
    EXPECT_EQ(speeds.right, 0.0);
  }
  EXPECT_DOUBLE_EQ(drivers::wheel_speeds({1e300, 1e300}, Wheels{}).right, 0.5);
}

TEST(WheelOdometry, DrivesAroundACircleBackToItsStart) {
  const Wheels wheels;
  WheelOdometry odometry;
  double left = 65'000.0;  // both wrap on the way
  double right = 65'000.0;
  const rover::Velocity velocity{0.3, 0.6};
  const drivers::WheelSpeeds speeds = drivers::wheel_speeds(velocity, wheels);
  const double turn = 2.0 * std::numbers::pi / velocity.angular;
  const int reports = 1000;
  const auto counts = [](double number) {
    return static_cast<std::uint16_t>(std::lround(number) & 0xffff);
  };
  ASSERT_EQ(odometry.advance(counts(left), counts(right), kStreamPeriod, wheels), Step::first);

  for (int i = 0; i < reports; ++i) {
    left += speeds.left * turn / reports / wheels.step();
    right += speeds.right * turn / reports / wheels.step();
    ASSERT_EQ(odometry.advance(counts(left), counts(right), turn / reports, wheels), Step::moved);
  }

  EXPECT_NEAR(odometry.odometry().x, 0.0, 0.005);
  EXPECT_NEAR(odometry.odometry().y, 0.0, 0.005);
  EXPECT_NEAR(odometry.odometry().heading, 0.0, 0.005);
  EXPECT_NEAR(odometry.odometry().linear, 0.3, 0.02) << "0.44 mm in a count";
  EXPECT_NEAR(odometry.odometry().angular, 0.6, 0.1);
  EXPECT_NEAR(odometry.lag(), 2.0 * turn / reports, 1e-9);
}

TEST(WheelOdometry, DiscardsAJumpAndCountsOnFromThere) {
  const Wheels wheels;
  WheelOdometry odometry;
  odometry.advance(5000, 6000, kStreamPeriod, wheels);
  odometry.advance(5010, 6010, kStreamPeriod, wheels);
  const double before = odometry.odometry().x;

  EXPECT_EQ(odometry.advance(0, 0, kStreamPeriod, wheels), Step::jump) << "the base began anew";
  EXPECT_DOUBLE_EQ(odometry.odometry().x, before);
  EXPECT_DOUBLE_EQ(odometry.odometry().linear, 0.0);
  EXPECT_EQ(odometry.advance(10, 10, kStreamPeriod, wheels), Step::moved);
  EXPECT_NEAR(odometry.odometry().x, before + 10 * wheels.step(), 1e-12);
}

TEST(WheelOdometry, DiscardsWhatMayHaveWrappedUnseen) {
  const Wheels wheels;
  WheelOdometry odometry;
  odometry.advance(0, 0, kStreamPeriod, wheels);

  EXPECT_EQ(odometry.advance(5, 5, 11.0, wheels), Step::jump);
  EXPECT_EQ(odometry.advance(7, 7, 0.0, wheels), Step::jump) << "no time has passed";
  EXPECT_EQ(odometry.advance(9, 9, std::nan(""), wheels), Step::jump);
  EXPECT_EQ(odometry.advance(900, 900, 1.0, wheels), Step::moved) << "a second was lost";
  EXPECT_DOUBLE_EQ(odometry.odometry().linear, 891 * wheels.step());
}

}  // namespace
