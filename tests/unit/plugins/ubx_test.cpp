// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "../../../plugins/drivers/gnss/gnss_reader.h"
#include "../../../plugins/drivers/gnss/nmea_write.h"
#include "../../../plugins/drivers/gnss/ubx_frame.h"
#include "../../../plugins/drivers/gnss/ubx_pvt.h"
#include "../../../plugins/world/random.h"

namespace {

using drivers::GnssReader;
using drivers::GnssStream;
using rover::GnssFix;

const std::string kRatePoll("\xb5\x62\x06\x08\x00\x00\x0e\x30", 8);
const std::string kPvtPoll("\xb5\x62\x01\x07\x00\x00\x08\x19", 8);

const GnssFix kFix{3661.25, 43.5661, -1.4744, 151.37, 0.9, 3, 9};

std::string pvt(const GnssFix& fix) {
  const auto frame = drivers::write_pvt(fix);
  return {frame.begin(), frame.end()};
}

std::string gga(const GnssFix& fix) {
  drivers::NmeaWriter writer;
  return std::string(writer.compose(fix, 0.0, 0.0));
}

GnssFix at(double time, double latitude) {
  GnssFix fix = kFix;
  fix.time = time;
  fix.latitude = latitude;
  return fix;
}

/// A payload of NAV-PVT with some bytes changed, sealed again.
std::string changed_pvt(std::size_t place, std::initializer_list<int> bytes,
                        std::size_t payload = 92) {
  auto frame = drivers::write_pvt(kFix);
  for (const int byte : bytes) frame.at(6 + place++) = static_cast<std::uint8_t>(byte);
  const std::span<std::uint8_t> all(frame.data(), payload + 8);
  drivers::ubx_seal(all, 0x01, 0x07);
  return {all.begin(), all.end()};
}

/// The output of a line; the gate is open.
struct Line {
  GnssStream stream;
  GnssReader reader;
  std::vector<GnssFix> fixes;
  int sentences = 0;
  int messages = 0;
  int bad = 0;
  int malformed = 0;

  void send(const std::string& bytes, double now = 0.0) {
    for (const char byte : bytes) {
      stream.push(byte);
      look(now);
    }
  }
  void look(double now = 0.0) {
    for (auto found = stream.next(); found != GnssStream::Event::none; found = stream.next()) {
      sentences += found == GnssStream::Event::sentence ? 1 : 0;
      messages += found == GnssStream::Event::message ? 1 : 0;
      bad += found == GnssStream::Event::bad ? 1 : 0;
      if (found == GnssStream::Event::bad) continue;
      const auto event = reader.read(found, stream, now, 0.0);
      malformed += event == GnssReader::Event::malformed ? 1 : 0;
      if (event == GnssReader::Event::fix) fixes.push_back(reader.fix());
    }
  }
};

TEST(UbxFrame, ReadsThePublishedPolls) {
  Line line;

  line.send(kRatePoll + kPvtPoll);

  EXPECT_EQ(line.messages, 2);
  EXPECT_EQ(line.bad, 0);
}

TEST(UbxFrame, CountsEverySingleFlippedBitBehindTheHeaderAndReadsTheNextMessage) {
  const std::string frame = pvt(kFix);
  for (std::size_t place = 2; place < frame.size(); ++place) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::string damaged = frame;
      damaged[place] = static_cast<char>(static_cast<unsigned char>(damaged[place]) ^ (1U << bit));
      Line line;

      line.send(damaged + frame + std::string(2000, '\0'));

      EXPECT_EQ(line.messages, 1) << "byte " << place << " bit " << bit;
      EXPECT_LE(line.bad, 1) << "byte " << place << " bit " << bit;
      EXPECT_TRUE(place < 6 || line.bad == 1) << "byte " << place << " bit " << bit;
    }
  }
}

TEST(UbxFrame, ResumesOneByteAfterTheSyncOfADamagedFrame) {
  // A header that promises 100 bytes swallows a whole message, which is found nevertheless.
  Line line;

  line.send(std::string("\xb5\x62\x01\x07\x64\x00", 6) + kPvtPoll + pvt(kFix) + kRatePoll);

  EXPECT_EQ(line.messages, 3);
  EXPECT_EQ(line.bad, 0) << "of a length that NAV-PVT never has";
  ASSERT_EQ(line.fixes.size(), 1U);
}

TEST(UbxFrame, TrustsNoLengthBeyondItsBound) {
  Line line;

  line.send(std::string("\xb5\x62\x01\x07\xff\xff", 6));
  line.send(kPvtPoll);

  EXPECT_EQ(line.bad, 0);
  EXPECT_EQ(line.messages, 1) << "without waiting for 65,535 bytes";
}

TEST(UbxFrame, GivesUpAHalfFrameAndFindsWhatItHadSwallowed) {
  Line line;
  line.send(std::string("\xb5\x62\x01\x07\x00\x02", 6) + gga(kFix) + "$GPGGA,12");
  EXPECT_TRUE(line.stream.in_frame());
  EXPECT_EQ(line.sentences, 0);

  line.stream.drop_begun();
  line.look();

  EXPECT_FALSE(line.stream.in_frame());
  EXPECT_EQ(line.sentences, 3);
  EXPECT_EQ(line.bad, 0) << "no checksum of what broke off was seen";
  line.send(pvt(kFix));
  EXPECT_EQ(line.messages, 1);
}

TEST(UbxFrame, SurvivesAMegabyteOfNoiseInWhichFramesBeginAllTheTime) {
  world::Random random(11);
  Line line;

  for (int i = 0; i < 1'000'000; ++i) {
    const double what = random.uniform(0.0, 4.0);
    const char noise = static_cast<char>(static_cast<int>(random.uniform(0.0, 256.0)));
    line.send({what < 1.0 ? '\xb5' : what < 2.0 ? '\x62' : what < 3.0 ? '\x01' : noise});
  }
  const int before = line.messages;
  line.send(std::string(1100, '\0') + pvt(kFix));

  EXPECT_GE(line.messages, before + 1);
}

TEST(UbxPvt, SaysWhatTheWriterWrote) {
  for (const double time : {0.5, 3661.25, 86399.999}) {
    GnssFix fix = kFix;
    fix.time = time;
    Line line;

    line.send(pvt(fix));

    ASSERT_EQ(line.fixes.size(), 1U);
    EXPECT_NEAR(line.fixes[0].time, time, 1e-9);
    EXPECT_NEAR(line.fixes[0].latitude, 43.5661, 1e-9);
    EXPECT_NEAR(line.fixes[0].longitude, -1.4744, 1e-9);
    EXPECT_NEAR(line.fixes[0].altitude, 151.37, 1e-9);
    EXPECT_NEAR(line.fixes[0].hdop, 0.9, 1e-9);
    EXPECT_EQ(line.fixes[0].mode, 3);
    EXPECT_EQ(line.fixes[0].satellites, 9);
  }
}

/// Some receivers send it on two ports of one line, or on demand too.
TEST(UbxPvt, OfAnEpochThatComesTwiceIsOneFix) {
  GnssFix next = kFix;
  next.time += 1.0;
  Line line;

  line.send(pvt(kFix) + pvt(kFix) + pvt(next) + pvt(next));

  EXPECT_EQ(line.messages, 4);
  EXPECT_EQ(line.malformed, 0);
  EXPECT_EQ(line.fixes.size(), 2U);
}

TEST(UbxPvt, ReadsTheOffsetsOfTheProtocolDescription) {
  // Written by hand, not by our writer: 12:35:19 + 0.25 s, 3D, 8 satellites, 48.1173 N, 11.5167 E,
  // 545.4 m above the sea, PDOP 1.57; protocol 14, with 84 bytes.
  std::array<std::uint8_t, 92> frame{};
  const auto put = [&](std::size_t place, std::initializer_list<int> bytes) {
    for (const int byte : bytes) frame.at(6 + place++) = static_cast<std::uint8_t>(byte);
  };
  put(8, {12, 35, 19, 0x07});
  put(16, {0x80, 0xb2, 0xe6, 0x0e});
  put(20, {3, 1, 0, 8});
  put(24, {0x38, 0x4e, 0xdd, 0x06});
  put(28, {0xc8, 0x1c, 0xae, 0x1c});
  put(36, {0x78, 0x52, 0x08, 0x00});
  put(76, {157, 0});
  drivers::ubx_seal(frame, 0x01, 0x07);
  Line line;

  line.send({frame.begin(), frame.end()});

  ASSERT_EQ(line.fixes.size(), 1U);
  EXPECT_NEAR(line.fixes[0].time, 45319.25, 1e-9);
  EXPECT_NEAR(line.fixes[0].latitude, 48.1172680, 1e-9);
  EXPECT_NEAR(line.fixes[0].longitude, 11.5166776, 1e-9);
  EXPECT_NEAR(line.fixes[0].altitude, 545.4, 1e-9);
  EXPECT_NEAR(line.fixes[0].hdop, 1.57, 1e-9);
  EXPECT_EQ(line.fixes[0].satellites, 8);
  EXPECT_EQ(line.fixes[0].mode, 3);
}

TEST(UbxPvt, TakesThePartBeforeMidnightFromNegativeNanoseconds) {
  Line line;

  line.send(changed_pvt(8, {0, 0, 0, 0x02}, 92));
  line.send(changed_pvt(8, {0, 0, 0, 0x02, 0, 0, 0, 0, 0x00, 0x36, 0x65, 0xc4}));

  ASSERT_EQ(line.fixes.size(), 2U);
  EXPECT_NEAR(line.fixes[1].time, 86'399.0, 1e-9);
}

TEST(UbxPvt, HasAPositionOnlyWhenTheReceiverVouchesForIt) {
  const auto mode_of = [](const std::string& bytes) {
    Line line;
    line.send(bytes);
    return line.fixes.at(0).mode;
  };

  EXPECT_EQ(mode_of(changed_pvt(20, {2, 1})), 2);
  EXPECT_EQ(mode_of(changed_pvt(20, {4, 1})), 3) << "with dead reckoning";
  EXPECT_EQ(mode_of(changed_pvt(20, {3, 0})), 1) << "fix not ok";
  EXPECT_EQ(mode_of(changed_pvt(20, {1, 1})), 1) << "dead reckoning only";
  EXPECT_EQ(mode_of(changed_pvt(20, {5, 1})), 1) << "time only";
  EXPECT_EQ(mode_of(changed_pvt(78, {1})), 1) << "position marked invalid";
  EXPECT_EQ(mode_of(changed_pvt(23, {0})), 1) << "from 0 satellites";
  EXPECT_EQ(mode_of(changed_pvt(23, {1})), 3) << "from 1 satellite";
  EXPECT_EQ(mode_of(changed_pvt(78, {1}, 84)), 3) << "reserved in the shorter message";
}

TEST(UbxPvt, CallsFieldsThatCannotBeMalformed) {
  for (const std::string& bytes :
       {changed_pvt(8, {24}), changed_pvt(9, {60}), changed_pvt(10, {61}),
        changed_pvt(28, {0xff, 0xff, 0xff, 0x7f}), changed_pvt(24, {0, 0, 0, 0x80}),
        changed_pvt(16, {0, 0, 0, 0x7f}), changed_pvt(0, {}, 60)}) {
    Line line;

    line.send(bytes);

    EXPECT_EQ(line.malformed, 1);
    EXPECT_TRUE(line.fixes.empty());
  }
}

TEST(GnssStream, ReadsSentencesAndMessagesOnOneLine) {
  Line line;

  line.send(gga(at(1.0, 1.0)) + kRatePoll + gga(at(2.0, 2.0)) + "$GPGGA,broken*00\r\n" + kPvtPoll +
            gga(at(3.0, 3.0)));

  EXPECT_EQ(line.sentences, 9);
  EXPECT_EQ(line.messages, 2);
  EXPECT_EQ(line.bad, 1);
  EXPECT_EQ(line.fixes.size(), 3U);
}

TEST(GnssStream, FindsNoSentenceInsideAMessage) {
  const std::string text = gga(kFix);
  std::vector<std::uint8_t> frame(text.size() + 8);
  std::copy(text.begin(), text.end(), frame.begin() + 6);
  drivers::ubx_seal(frame, 0x04, 0x02);
  Line line;

  line.send({frame.begin(), frame.end()});

  EXPECT_EQ(line.messages, 1);
  EXPECT_EQ(line.sentences, 0);
}

TEST(GnssReader, ReportsEachEpochOnceWhenTheReceiverSendsBoth) {
  Line line;

  line.send(gga(at(1.0, 1.0)), 1.0);
  for (int second = 2; second < 6; ++second) {
    line.send(pvt(at(second, second)) + gga(at(second, -1.0)), second);
  }

  ASSERT_EQ(line.fixes.size(), 5U);
  for (const GnssFix& fix : line.fixes) EXPECT_NEAR(fix.latitude, fix.time, 1e-7);
}

TEST(GnssReader, HearsGgaAgainWhenNavPvtHasFallenSilent) {
  Line line;
  line.send(pvt(at(10.0, 1.0)), 10.0);

  line.send(gga(at(11.0, 2.0)), 11.0);
  EXPECT_EQ(line.fixes.size(), 1U);
  line.send(gga(at(12.0, 3.0)), 12.0);

  ASSERT_EQ(line.fixes.size(), 2U);
  EXPECT_NEAR(line.fixes[1].latitude, 3.0, 1e-7);
}

TEST(GnssReader, DoesNotTrustAMalformedNavPvtToSilenceGga) {
  Line line;

  line.send(changed_pvt(8, {24}) + gga(at(1.0, 1.0)), 1.0);

  EXPECT_EQ(line.malformed, 1);
  EXPECT_EQ(line.fixes.size(), 1U);
}

}  // namespace
