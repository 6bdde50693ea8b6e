// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "../../../plugins/drivers/gnss/nmea_fix.h"
#include "../../../plugins/drivers/gnss/nmea_frame.h"
#include "../../../plugins/drivers/gnss/nmea_write.h"
#include "../../../plugins/world/random.h"

namespace {

using drivers::FixReader;
using drivers::FrameReader;
using rover::GnssFix;

constexpr std::string_view kGga =
    "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n";
constexpr std::string_view kRmc =
    "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A\r\n";

struct NmeaReading {
  std::vector<GnssFix> fixes;
  std::uint32_t good = 0;
  std::uint32_t bad = 0;
};

NmeaReading read(std::string_view bytes) {
  FrameReader frames;
  FixReader fixes;
  NmeaReading reading;
  for (const char byte : bytes) {
    if (frames.push(byte) != FrameReader::Event::frame) continue;
    if (fixes.read(frames.frame()) == FixReader::Event::fix) reading.fixes.push_back(fixes.fix());
  }
  reading.good = frames.good();
  reading.bad = frames.bad();
  return reading;
}

/// `$text*hh\r\n` with the right checksum.
std::string sentence(std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  constexpr std::string_view kHex = "0123456789ABCDEF";
  return "$" + std::string(text) + "*" + kHex[sum / 16U] + kHex[sum % 16U] + "\r\n";
}

TEST(NmeaFrame, ReadsThePublishedSentences) {
  const NmeaReading reading = read(std::string(kGga) + std::string(kRmc));

  EXPECT_EQ(reading.good, 2U);
  EXPECT_EQ(reading.bad, 0U);
  ASSERT_EQ(reading.fixes.size(), 1U);
  EXPECT_NEAR(reading.fixes[0].latitude, 48.1173, 1e-7);
  EXPECT_NEAR(reading.fixes[0].longitude, 11.0 + 31.0 / 60.0, 1e-7);
  EXPECT_DOUBLE_EQ(reading.fixes[0].altitude, 545.4);
  EXPECT_DOUBLE_EQ(reading.fixes[0].time, 12 * 3600 + 35 * 60 + 19);
  EXPECT_EQ(reading.fixes[0].satellites, 8);
  EXPECT_DOUBLE_EQ(reading.fixes[0].hdop, 0.9);
}

TEST(NmeaFrame, RefusesTheWebCopyThatDroppedAnEmptyField) {
  const NmeaReading reading =
      read("$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,*47\r\n");

  EXPECT_EQ(reading.good, 0U);
  EXPECT_EQ(reading.bad, 1U);
}

TEST(NmeaFrame, CountsEverySingleFlippedBitBehindTheAddressOnceAndReadsTheNextSentence) {
  for (std::size_t place = 0; place + 2 < kGga.size(); ++place) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::string bytes = std::string(kRmc) + std::string(kGga);
      char& byte = bytes[kRmc.size() + place];
      byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1U << bit));
      const bool inside = place > 6 && place + 5 < kGga.size();
      const bool cut = byte == '\r' || byte == '\n' || byte == '$' || byte == '*';

      const NmeaReading reading = read(bytes + std::string(kRmc) + std::string(kGga));

      EXPECT_EQ(reading.good, 3U) << "byte " << place << " bit " << bit;
      EXPECT_LE(reading.bad, 1U) << "byte " << place << " bit " << bit;
      EXPECT_TRUE(!inside || cut || reading.bad == 1) << "byte " << place << " bit " << bit;
      ASSERT_EQ(reading.fixes.size(), 1U);
    }
  }
}

TEST(NmeaFrame, ATruncatedSentenceCostsNoOtherOne) {
  for (std::size_t length = 1; length + 2 < kGga.size(); ++length) {
    const std::string cut(kGga.substr(0, length));

    for (const std::string& bytes : {cut + std::string(kGga), cut + "\r\n" + std::string(kGga)}) {
      const NmeaReading reading = read(bytes);

      EXPECT_EQ(reading.good, 1U) << bytes;
      EXPECT_EQ(reading.bad, 0U) << bytes;
    }
  }
}

TEST(NmeaFrame, CountsEveryMissingByteBehindTheAddressOnce) {
  for (std::size_t place = 0; place + 2 < kGga.size(); ++place) {
    std::string bytes = std::string(kRmc) + std::string(kGga);
    bytes.erase(kRmc.size() + place, 1);
    const bool inside = place > 6 && place + 5 < kGga.size();

    const NmeaReading reading = read(bytes + std::string(kGga));

    EXPECT_EQ(reading.good, 2U) << place;
    EXPECT_LE(reading.bad, 1U) << place;
    EXPECT_TRUE(!inside || reading.bad == 1) << place;
  }
}

TEST(NmeaFrame, SkipsCommentsAndBinaryWithoutCountingThem) {
  const std::string bytes =
      "# Notes: $GLGSV  for GLONASS sats, and $GPGSV for GNSS\r\n\xb5\x62\x01" +
      std::string(3, '\0') + "\xff\r\n" + std::string(kGga);

  const NmeaReading reading = read(bytes);

  EXPECT_EQ(reading.good, 1U);
  EXPECT_EQ(reading.bad, 0U);
}

TEST(NmeaFrame, BoundsTheLengthOfASentence) {
  const std::string longest = sentence("GPTXT," + std::string(FrameReader::kLongest - 6, 'x'));
  const std::string longer = sentence("GPTXT," + std::string(FrameReader::kLongest - 5, 'x'));

  EXPECT_EQ(read(longest).good, 1U);
  EXPECT_EQ(read(longer).good, 0U);
  EXPECT_EQ(read(longer + std::string(kGga)).good, 1U);
  EXPECT_EQ(read("$GP" + std::string(1020, 'x') + std::string(kGga)).good, 1U) << "of its line";
  EXPECT_EQ(read("$GPTXT," + std::string(1'000'000, 'x') + "\r\n" + std::string(kGga)).good, 1U);
}

TEST(NmeaFrame, SurvivesAMegabyteOfNoise) {
  world::Random random(7);
  FrameReader frames;
  FixReader fixes;

  for (int i = 0; i < 1'000'000; ++i) {
    const char byte = static_cast<char>(static_cast<int>(random.uniform(0.0, 256.0)));
    if (frames.push(byte) == FrameReader::Event::frame) (void)fixes.read(frames.frame());
  }
  FrameReader::Event last = FrameReader::Event::none;
  for (const char byte : "\r\n" + std::string(kGga)) {
    const FrameReader::Event event = frames.push(byte);
    if (event != FrameReader::Event::none) last = event;
  }

  EXPECT_EQ(last, FrameReader::Event::frame);
}

TEST(NmeaFix, TakesEmptyFieldsAsNoFix) {
  const NmeaReading reading = read("$GPGGA,,,,,,0,,,,M,,M,,*66\r\n");

  ASSERT_EQ(reading.fixes.size(), 1U);
  EXPECT_EQ(reading.fixes[0].mode, 1);
  EXPECT_EQ(reading.bad, 0U);
}

TEST(NmeaFix, KnowsTwoAndThreeDimensions) {
  const std::string flat = sentence("GPGGA,1,4807.038,N,01131.000,E,1,04,0.9,,M,,M,,");
  const std::string solid = sentence("GPGGA,2,4807.038,N,01131.000,E,1,04,0.9,10,M,,M,,");
  const std::string last = sentence("GPGGA,3,4807.038,N,01131.000,E,1,04,0.9,10,M,,M,,");
  const std::string two = sentence("GPGSA,A,2,01,02,03,,,,,,,,,,1,1,1");

  const NmeaReading reading = read(flat + solid + two + last);

  ASSERT_EQ(reading.fixes.size(), 3U);
  EXPECT_EQ(reading.fixes[0].mode, 2);
  EXPECT_EQ(reading.fixes[1].mode, 3);
  EXPECT_EQ(reading.fixes[2].mode, 2);
}

TEST(NmeaFix, APositionFromZeroSatellitesIsNoFix) {
  // A receiver that was searching sent this position, 3.8 m away from its first real one.
  const NmeaReading reading =
      read("$GPGGA,194050.00,4221.8237733,N,07101.9411707,W,1,00,3.3,10.835,M,-33.320,M,,*62\r\n" +
           sentence("GPGGA,1,4807.038,N,01131.000,E,1,0,0.9,10,M,,M,,") +
           sentence("GPGGA,2,4807.038,N,01131.000,E,1,01,0.9,10,M,,M,,"));

  ASSERT_EQ(reading.fixes.size(), 3U);
  EXPECT_EQ(reading.bad, 0U);
  EXPECT_EQ(reading.fixes[0].mode, 1);
  EXPECT_EQ(reading.fixes[0].satellites, 0);
  EXPECT_EQ(reading.fixes[1].mode, 1);
  EXPECT_EQ(reading.fixes[2].mode, 3) << "one satellite";
}

TEST(NmeaFix, APositionThatDoesNotSayTheNumberOfSatellitesIsAFix) {
  const NmeaReading reading = read(sentence("GPGGA,2,4807.038,N,01131.000,E,1,,0.9,10,M,,M,,"));

  ASSERT_EQ(reading.fixes.size(), 1U);
  EXPECT_EQ(reading.fixes[0].mode, 3);
}

TEST(NmeaFix, CallsFieldsThatCannotBeMalformed) {
  FixReader fixes;

  for (const char* frame :
       {"GPGGA,123519,4867.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,",
        "GPGGA,123519,9107.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,",
        "GPGGA,123519,4807.038,X,01131.000,E,1,08,0.9,545.4,M,46.9,M,,",
        "GPGGA,123519,nan,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,",
        "GPGGA,996519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,", "GPGGA,123519,4807.038,N",
        "GPGSA,A,9", "GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,+-5,M,46.9,M,,",
        "GPGGA,123519,4860.001,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,"}) {
    EXPECT_EQ(fixes.read(frame), FixReader::Event::malformed) << frame;
  }
}

TEST(NmeaFix, IgnoresSentencesOfTheManufacturer) {
  FixReader fixes;

  EXPECT_EQ(fixes.read("PUBX,GGA,1"), FixReader::Event::ignored);
  EXPECT_EQ(fixes.read(""), FixReader::Event::ignored);
}

TEST(NmeaWriter, WritesWhatTheReaderReads) {
  drivers::NmeaWriter writer;

  for (const double latitude : {43.5661, -33.9, 59.999999999, 0.00001}) {
    GnssFix fix{3661.25, latitude, -1.4744, 151.37, 0.9, 3, 9};
    const NmeaReading reading = read(writer.compose(fix, 0.6, 271.5));

    EXPECT_EQ(reading.good, 3U);
    EXPECT_EQ(reading.bad, 0U);
    ASSERT_EQ(reading.fixes.size(), 1U);
    EXPECT_NEAR(reading.fixes[0].latitude, latitude, 1e-9);
    EXPECT_NEAR(reading.fixes[0].longitude, -1.4744, 1e-9);
    EXPECT_NEAR(reading.fixes[0].altitude, 151.37, 1e-9);
    EXPECT_DOUBLE_EQ(reading.fixes[0].time, 3661.25);
    EXPECT_EQ(reading.fixes[0].mode, 3);
    EXPECT_EQ(reading.fixes[0].satellites, 9);
  }
}

TEST(NmeaWriter, WritesTwoDimensionsAndNoFixAtAll) {
  drivers::NmeaWriter writer;
  GnssFix fix{1.0, 43.0, 1.0, 0.0, 2.0, 2, 3};

  EXPECT_EQ(read(writer.compose(fix, 0.0, 0.0)).fixes.at(0).mode, 2);
  fix.mode = 1;
  EXPECT_EQ(read(writer.compose(fix, 0.0, 0.0)).fixes.at(0).mode, 1);
}

/// GGA of this second at this minute of latitude, with RMC or GLL before it.
drivers::FixContext context_of(FixReader& fixes, int second, const char* minutes,
                               const std::string& said) {
  const std::string time = "1235" + std::to_string(second);
  if (!said.empty()) {
    fixes.read("GPRMC," + time + ",A," + said + ",N,01131.000,E,022.4,084.4,230394,003.1,W");
  }
  const std::string gga =
      "GPGGA," + time + "," + minutes + ",N,01131.0000,E,1,08,0.9,545.4,M,46.9,M,,";
  EXPECT_EQ(fixes.read(gga), FixReader::Event::fix);
  return fixes.context();
}

TEST(NmeaFix, IsConfirmedByRmcToTheDigitsThatBothCarry) {
  FixReader fixes;
  EXPECT_TRUE(context_of(fixes, 10, "4807.0387", "4807.038").confirmed) << "cut";
  EXPECT_TRUE(context_of(fixes, 11, "4807.0387", "4807.039").confirmed) << "rounded";
  EXPECT_TRUE(context_of(fixes, 12, "4807.0387", "4807.03871").confirmed);
  EXPECT_FALSE(context_of(fixes, 13, "4807.0387", "4807.041").confirmed);
  EXPECT_FALSE(context_of(fixes, 14, "4807.0387", "").confirmed) << "of another second";
  EXPECT_DOUBLE_EQ(fixes.context().separation, 46.9);
}

TEST(NmeaFix, IsDeniedOnlyByAReceiverThatSaidTheSameBefore) {
  FixReader fixes;
  EXPECT_FALSE(context_of(fixes, 10, "4807.0387", "4807.138").denied) << "its habit, perhaps";
  EXPECT_FALSE(context_of(fixes, 11, "4807.0387", "4807.138").denied);
  for (int second = 12; second < 20; ++second) {
    EXPECT_TRUE(context_of(fixes, second, "4807.0387", "4807.038").confirmed);
  }

  EXPECT_TRUE(context_of(fixes, 20, "4807.0387", "4807.138").denied);
  EXPECT_FALSE(context_of(fixes, 21, "4807.0387", "").denied);
}

TEST(NmeaFix, KnowsTheDilutionThatGsaSaid) {
  FixReader fixes;
  EXPECT_FALSE(context_of(fixes, 10, "4807.0387", "").dilution_known);
  fixes.read("GPGSA,A,3,17,28,06,01,30,20,26,13,,,,,1.8,0.9,1.5");
  EXPECT_TRUE(context_of(fixes, 11, "4807.0387", "").dilution_known);
  fixes.read("GPGSA,A,3,17,28,06,01,30,20,26,13,,,,,1.8,1.1,1.5");
  EXPECT_FALSE(context_of(fixes, 12, "4807.0387", "").dilution_known);
}

}  // namespace
