// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "../../../plugins/drivers/imu/xbus_frame.h"
#include "../../../plugins/drivers/imu/xbus_imu.h"
#include "../../../plugins/world/random.h"

namespace {

using drivers::Bytes;
using drivers::ImuReader;
using drivers::ImuWriter;
using drivers::SampleClock;
using drivers::XbusStream;
using rover::Imu;

using Frame = std::vector<std::uint8_t>;

/// "FA FF 30 00 D1"
Frame hex(const std::string& text) {
  std::istringstream words(text);
  Frame bytes;
  for (unsigned byte = 0; words >> std::hex >> byte;) {
    bytes.push_back(static_cast<std::uint8_t>(byte));
  }
  return bytes;
}

Frame operator+(Frame a, const Frame& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Header and checksum around the data.
Frame message(std::uint8_t id, const Frame& data) {
  Frame frame(4);
  frame = frame + data + Frame(1);
  drivers::xbus_seal(frame, id);
  return frame;
}

/// The packet that an MTi-300 sent: counter, sample time, quaternion, acceleration, delta velocity,
/// free acceleration, rate of turn, delta quaternion, status.
const char* const kRecorded =
    "10 20 02 8D 90 10 60 04 00 54 DB F1 20 10 10 3F 7F 89 11 BC 11 1D FA 3B A0 CE F0 BD 73 25 73 "
    "40 20 0C BD DC F9 D0 BE 3C 86 19 41 1D 0B 47 40 10 0C B9 8D B0 00 B9 F1 48 00 3C C9 04 30 "
    "40 30 0C BC B9 89 2E BB 09 8C 00 3C A7 08 00 80 20 0C BA 63 BC 01 BC 04 D6 3F BB 6D E3 FE "
    "80 30 10 3F 80 00 01 B5 91 C0 00 B7 2A 08 00 B6 98 40 00 E0 20 04 00 40 00 03";

Frame composed(const Imu& imu, std::uint32_t ticks = 1) {
  ImuWriter writer;
  const Bytes frame = writer.compose(imu, ticks);
  return {frame.begin(), frame.end()};
}

struct XbusLine {
  XbusStream stream;
  ImuReader reader;
  std::vector<Imu> imus;
  int frames = 0;
  int bad = 0;
  int malformed = 0;
  int implausible = 0;

  void send(const Frame& bytes, double now = 5.0) {
    for (const std::uint8_t byte : bytes) {
      stream.push(static_cast<char>(byte));
      look(now);
    }
  }
  void look(double now = 5.0) {
    for (auto found = stream.next(); found != XbusStream::Event::none; found = stream.next()) {
      bad += found == XbusStream::Event::bad ? 1 : 0;
      if (found == XbusStream::Event::bad) continue;
      ++frames;
      const auto event = reader.read(stream.frame(), now);
      malformed += event == ImuReader::Event::malformed ? 1 : 0;
      implausible += event == ImuReader::Event::implausible ? 1 : 0;
      if (event == ImuReader::Event::imu) imus.push_back(reader.imu());
    }
  }
};

TEST(XbusFrame, ReadsThePublishedMessages) {
  XbusLine line;

  line.send(hex("FA FF 30 00 D1"));
  line.send(hex("FA FF 31 00 D0"));
  line.send(hex("FA FF 10 00 F1"));
  line.send(hex("FA FF 03 04 03 70 03 F8 8C"));
  line.send(hex("FA FF 13 0B 01 08 02 00 00 00 25 00 01 15 34 69"));

  EXPECT_EQ(line.frames, 5);
  EXPECT_EQ(line.bad, 0);
  EXPECT_TRUE(line.imus.empty());
}

TEST(XbusFrame, UsesNoFrameWithAFlippedBitAndReadsTheNext) {
  const Frame frame = composed({0.0, 0.3, 0.1, -0.2, 1.0, true});
  for (std::size_t place = 2; place < frame.size(); ++place) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      Frame damaged = frame;
      damaged[place] = static_cast<std::uint8_t>(damaged[place] ^ (1U << bit));
      XbusLine line;

      line.send(damaged + frame + Frame(300));

      EXPECT_EQ(line.imus.size(), 1U) << "byte " << place << " bit " << bit;
      EXPECT_GE(line.bad, 1) << "byte " << place << " bit " << bit;
    }
  }
}

TEST(XbusFrame, FindsAFrameInsideADamagedOne) {
  XbusLine line;

  line.send(hex("FA FF 36 80 10 20") + composed({}) + composed({}) + composed({}) + Frame(10));

  EXPECT_EQ(line.imus.size(), 3U);
  EXPECT_EQ(line.bad, 1);
}

TEST(XbusFrame, DoesNotWaitForAMessageOfExtendedLength) {
  XbusLine line;

  line.send(hex("FA FF 36 FF 07 FF") + composed({}));

  EXPECT_EQ(line.bad, 1);
  EXPECT_EQ(line.imus.size(), 1U);
}

TEST(XbusFrame, GivesUpAHalfFrame) {
  XbusLine line;
  line.send(hex("FA FF 36 40 10"));
  EXPECT_TRUE(line.stream.in_frame());

  line.stream.drop_begun();
  line.look();

  EXPECT_FALSE(line.stream.in_frame());
  EXPECT_EQ(line.bad, 1);
}

TEST(XbusFrame, SurvivesAMegabyteOfNoiseInWhichFramesBeginAllTheTime) {
  world::Random random(3);
  XbusLine line;

  for (int i = 0; i < 1'000'000; ++i) {
    const double what = random.uniform(0.0, 4.0);
    const auto noise = static_cast<std::uint8_t>(random.uniform(0.0, 256.0));
    line.send({what < 1.0 ? std::uint8_t{0xfa} : what < 2.0 ? std::uint8_t{0xff} : noise});
  }
  line.send(Frame(300));
  const std::size_t before = line.imus.size();
  line.send(composed({}));

  EXPECT_EQ(line.imus.size(), before + 1);
}

TEST(XbusImu, ReadsWhatARealUnitSent) {
  XbusLine line;

  line.send(message(0x36, hex(kRecorded)));

  ASSERT_EQ(line.imus.size(), 1U);
  EXPECT_NEAR(line.imus[0].yaw_rate, -0.00362992, 1e-8);
  EXPECT_NEAR(line.imus[0].acceleration_x, -0.10789835, 1e-8);
  EXPECT_NEAR(line.imus[0].acceleration_y, -0.18410529, 1e-8);
  EXPECT_FALSE(line.imus[0].has_heading) << "it sent a quaternion, no Euler angles";
  EXPECT_DOUBLE_EQ(line.imus[0].time, 5.0);
}

TEST(XbusImu, ReadsEulerAnglesInDegreesAnticlockwiseFromEast) {
  // Rate of turn (0, 0, 0.5), then roll 0, pitch 0, yaw 90.
  const Frame data = hex(
      "80 20 0C 00 00 00 00 00 00 00 00 3F 00 00 00 20 30 0C 00 00 00 00 00 00 00 00 42 B4 00 00");
  XbusLine line;

  line.send(message(0x36, data));
  line.send(message(0x36, data + hex("E0 20 04 00 00 00 01")));

  ASSERT_EQ(line.imus.size(), 2U);
  EXPECT_TRUE(line.imus[0].has_heading);
  EXPECT_NEAR(line.imus[0].heading, std::numbers::pi / 2.0, 1e-6);
  EXPECT_DOUBLE_EQ(line.imus[0].yaw_rate, 0.5);
  EXPECT_FALSE(line.imus[1].has_heading) << "its filter says that it is not valid";
}

TEST(XbusImu, SaysWhatTheWriterWrote) {
  for (const double heading : {-3.0, 0.0, 0.5, 3.1}) {
    XbusLine line;

    line.send(composed({0.0, -0.25, 0.1, -0.2, heading, true}));
    line.send(composed({0.0, -0.25, 0.1, -0.2, heading, false}));

    ASSERT_EQ(line.imus.size(), 2U);
    EXPECT_NEAR(line.imus[0].yaw_rate, -0.25, 1e-6);
    EXPECT_NEAR(line.imus[0].acceleration_x, 0.1, 1e-6);
    EXPECT_NEAR(line.imus[0].acceleration_y, -0.2, 1e-6);
    EXPECT_NEAR(line.imus[0].heading, heading, 1e-6);
    EXPECT_TRUE(line.imus[0].has_heading);
    EXPECT_FALSE(line.imus[1].has_heading);
  }
}

TEST(XbusImu, RefusesValuesThatNoUnitMeasures) {
  XbusLine line;

  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1e300, -500.0}) {
    line.send(composed({0.0, wrong, 0.0, 0.0, 0.0, false}));
    line.send(composed({0.0, 0.0, wrong, 0.0, 0.0, false}));
    line.send(composed({0.0, 0.0, 0.0, 0.0, wrong, true}));
  }

  EXPECT_EQ(line.implausible, 12);
  EXPECT_TRUE(line.imus.empty());
  EXPECT_EQ(line.bad, 0);
}

TEST(XbusImu, CallsLengthsThatCannotBeMalformed) {
  XbusLine line;

  line.send(message(0x36, hex("80 20 0C 00 00")));
  line.send(message(0x36, hex("80 20")));
  line.send(message(0x36, hex("80 20 04 00 00 00 00")));
  line.send(message(0x36, hex("10 60 02 00 00")));

  EXPECT_EQ(line.malformed, 4);
}

/// Bit 1 of the status, which newer units send as a byte.
TEST(XbusImu, LetsNoHeadingThroughWhileTheFilterSaysThatItIsInvalid) {
  const Frame measured = hex("20 30 0C 00 00 00 00 00 00 00 00 42 34 00 00") +
                         hex("80 20 0C 00 00 00 00 00 00 00 00 3D CC CC CD");
  XbusLine line;

  line.send(message(0x36, measured + hex("E0 10 01 02")));
  line.send(message(0x36, measured + hex("E0 10 01 00")));
  line.send(message(0x36, measured + hex("E0 20 04 00 00 00 00")));
  line.send(message(0x36, measured + hex("E0 10 02 00 00")));

  ASSERT_EQ(line.imus.size(), 3U);
  EXPECT_TRUE(line.imus[0].has_heading);
  EXPECT_FALSE(line.imus[1].has_heading);
  EXPECT_FALSE(line.imus[2].has_heading);
  EXPECT_EQ(line.malformed, 1);
}

TEST(XbusImu, IgnoresMessagesWithoutARateOfTurn) {
  XbusLine line;

  line.send(message(0x36, {}));
  line.send(message(0x36, hex("80 23 18") + Frame(24)));  // in double precision
  line.send(message(0x36, hex("10 20 02 00 01")));

  EXPECT_EQ(line.frames, 3);
  EXPECT_EQ(line.malformed, 0);
  EXPECT_TRUE(line.imus.empty());
}

TEST(SampleClock, GivesEvenTimesToSamplesThatArriveInBunches) {
  SampleClock clock;
  double before = clock.time(0, 100.0);
  double worst = 0.0;

  for (int i = 1; i < 1000; ++i) {
    // A sample each 10 ms; they come three at a time.
    const double arrival = 100.0 + 0.03 * std::ceil(i / 3.0);
    const double time = clock.time(static_cast<std::uint32_t>(100 * i), arrival);
    worst = std::max(worst, std::abs(time - before - 0.01));
    EXPECT_LE(time, arrival + 1e-9);
    before = time;
  }

  EXPECT_LT(worst, 0.001);
}

TEST(SampleClock, GoesOnOverTheWrapOfTheTicksAndARestartOfTheUnit) {
  SampleClock clock;
  (void)clock.time(0xffffff00U, 10.0);

  EXPECT_NEAR(clock.time(0x00000100U, 10.0512), 10.0512, 1e-3);
  EXPECT_NEAR(clock.time(5, 20.0), 20.0, 1e-9);
  EXPECT_NEAR(clock.time(105, 20.01), 20.01, 1e-3);
}

}  // namespace
