// SPDX-License-Identifier: LGPL-3.0-or-later
/// Our reading of real receivers against gpsd's reading of the same bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "../../../plugins/drivers/gnss/gnss_reader.h"
#include "../../../plugins/drivers/gnss/ubx_pvt.h"
#include "../../../plugins/world/random.h"
#include "support/gpsd_check.h"
#include "support/test_data.h"

namespace {

using drivers::GnssReader;
using drivers::GnssStream;
using rover::GnssFix;

constexpr double kSpeedLimit = 100.0;  // the default of the driver
constexpr double kAtOnce = 1e9;        // bytes a second

struct Reading {
  std::vector<GnssFix> fixes;
  std::uint64_t bad = 0;
  std::uint64_t malformed = 0;
  std::uint64_t implausible = 0;
};

/// The reading that the driver makes of the bytes when they come at `rate` bytes a second. At a
/// limit of 0 m/s its gate lets every fix through.
Reading read(std::string_view bytes, double rate, double speed_limit = kSpeedLimit) {
  GnssStream stream;
  GnssReader reader;
  Reading reading;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    stream.push(bytes[i]);
    for (auto found = stream.next(); found != GnssStream::Event::none; found = stream.next()) {
      if (found == GnssStream::Event::bad) {
        ++reading.bad;
        continue;
      }
      const double now = static_cast<double>(i) / rate;
      do {
        const auto event = reader.read(found, stream, now, speed_limit);
        if (event == GnssReader::Event::fix) reading.fixes.push_back(reader.fix());
        reading.malformed += event == GnssReader::Event::malformed ? 1U : 0U;
        reading.implausible += event == GnssReader::Event::implausible ? 1U : 0U;
      } while (reader.unread());
    }
  }
  return reading;
}

std::vector<std::filesystem::path> logs(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".log") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

void expect_same(const GnssFix& fix, const support::GpsdReport& report) {
  EXPECT_EQ(fix.mode, report.mode);
  EXPECT_NEAR(fix.latitude, report.latitude.value_or(fix.latitude), 1e-7);
  EXPECT_NEAR(fix.longitude, report.longitude.value_or(fix.longitude), 1e-7);
  EXPECT_NEAR(fix.altitude, report.altitude.value_or(fix.altitude), 1e-3);
  EXPECT_NEAR(fix.time, report.time.value_or(fix.time), 1e-3);
}

/// gpsd counts the satellites that GSA names; our reader takes the number in GGA, which one
/// receiver changes an epoch earlier. Date, speed and track, which gpsd reports too, are not in a
/// GnssFix.
void expect_same_sky(const GnssFix& fix, const support::GpsdEpoch& epoch, int& other_count) {
  for (const double hdop : epoch.dilutions) EXPECT_NEAR(fix.hdop, hdop, 0.006);
  if (epoch.satellites && *epoch.satellites != fix.satellites) ++other_count;
}

TEST(GnssReference, EveryEpochOfEveryReceiverIsAsGpsdReadsItAtAnyPace) {
  const auto folder = support::test_data("nmea");
  if (!folder) GTEST_SKIP() << support::kNoTestData;
  std::size_t compared = 0;

  for (const auto& path : logs(*folder)) {
    SCOPED_TRACE(path.filename());
    const std::string bytes = support::bytes_of(path);
    const auto epochs = support::gpsd_epochs(path.string() + ".chk");
    // An epoch a second as the receiver sent them, a line slower than that, and all at once.
    const double pace = static_cast<double>(bytes.size()) / static_cast<double>(epochs.size());
    for (const double rate : {pace, pace / 1.2, kAtOnce}) {
      const Reading reading = read(bytes, rate);

      EXPECT_EQ(reading.bad, 0U);
      EXPECT_EQ(reading.malformed, 0U);
      EXPECT_EQ(reading.implausible, 0U);
      ASSERT_EQ(reading.fixes.size(), epochs.size());
      int other_count = 0;
      for (std::size_t i = 0; i < epochs.size(); ++i) {
        SCOPED_TRACE(epochs[i].gga);
        for (const auto& report : epochs[i].reports) {
          expect_same(reading.fixes[i], report);
          ++compared;
        }
        expect_same_sky(reading.fixes[i], epochs[i], other_count);
      }
      EXPECT_EQ(other_count, path.filename() == "telit-he910.log" ? 3 : 0);
    }
  }

  EXPECT_GT(compared, 3000U);
}

// Recordings that are odd, and what our gate makes of them, of which gpsd has none.
struct OddRecording {
  std::string_view name;
  std::size_t modes = 0;          // reports of another mode
  std::uint64_t bad = 0;          // sentences
  std::uint64_t implausible = 0;  // epochs, at the limit of the driver
};
constexpr OddRecording kOddRecordings[] = {
    // Bytes are missing all through it, and the receiver starts anew.
    {"gp-320fw-2019-04-07-coldboot.log", 0, 13, 1},
    // Its GSA says two dimensions; gpsd believes the height in the next GGA.
    {"haicom-305N.log", 3, 0, 0},
    {"nmea-fuzzy-cases.log", 0, 0, 2},  // put together from several hours
    {"quectel-eg25-g.log", 0, 0, 1},    // a height 116 m above that of the second before
};

TEST(GnssReference, MoreReceiversAreAsGpsdReadsThem) {
  const auto folder = support::test_data("nmea_more");
  if (!folder) GTEST_SKIP() << support::kNoTestData;
  std::size_t compared = 0;

  for (const auto& path : logs(*folder)) {
    SCOPED_TRACE(path.filename());
    const std::string name = path.filename().string();
    const auto* const found =
        std::find_if(std::begin(kOddRecordings), std::end(kOddRecordings),
                     [&](const OddRecording& odd) { return odd.name == name; });
    const OddRecording odd = found != std::end(kOddRecordings) ? *found : OddRecording{};
    const std::string bytes = support::bytes_of(path);
    const auto epochs = support::gpsd_epochs(path.string() + ".chk");
    const double pace = static_cast<double>(bytes.size()) / static_cast<double>(epochs.size());
    const Reading reading = read(bytes, pace, 0.0);
    std::size_t missing = 0;
    std::size_t modes = 0;
    for (const auto& epoch : epochs) {
      for (const auto& report : epoch.reports) {
        if (!report.time || report.mode < 2) continue;
        const auto fix = std::find_if(
            reading.fixes.begin(), reading.fixes.end(),
            [&](const GnssFix& ours) { return std::abs(ours.time - *report.time) < 1e-3; });
        missing += fix == reading.fixes.end() ? 1U : 0U;
        if (fix == reading.fixes.end()) continue;
        modes += fix->mode != report.mode ? 1U : 0U;
        if (fix->mode == report.mode) expect_same(*fix, report);
        ++compared;
      }
    }

    EXPECT_EQ(missing, 0U);
    EXPECT_EQ(modes, odd.modes);
    EXPECT_EQ(reading.bad, odd.bad);
    EXPECT_EQ(reading.malformed, 0U);
    EXPECT_EQ(reading.implausible, 0U);
    EXPECT_EQ(read(bytes, pace).implausible, odd.implausible);
    for (std::size_t i = 1; i < reading.fixes.size(); ++i) {
      EXPECT_TRUE(reading.fixes[i].mode == 1 || reading.fixes[i].time != reading.fixes[i - 1].time)
          << "an epoch twice";
    }
  }

  EXPECT_GT(compared, 1000U);
}

TEST(GnssReference, ALineThatDamagesLittleLosesNothingElse) {
  const auto folder = support::test_data("nmea");
  if (!folder) GTEST_SKIP() << support::kNoTestData;
  ASSERT_FALSE(logs(*folder).empty());

  for (const auto& path : logs(*folder)) {
    SCOPED_TRACE(path.filename());
    std::string bytes = support::bytes_of(path);
    const Reading clean = read(bytes, kAtOnce);
    // Two sentences of an epoch in the middle that are no GGA, and we begin within a sentence.
    bytes.erase(0, bytes.find('$') + 10);
    std::size_t at = bytes.find("GGA", bytes.size() / 2);
    for (int i = 0; i < 2; ++i) {
      at = bytes.find('$', at + 1);
      if (at != std::string::npos && bytes.substr(at + 3, 3) != "GGA") bytes[at + 8] ^= 1;
    }
    const Reading reading = read(bytes, kAtOnce);

    EXPECT_GT(reading.bad, 0U);
    EXPECT_EQ(reading.implausible, 0U);
    EXPECT_GE(reading.fixes.size() + 1, clean.fixes.size()) << "the first may have been cut";
  }
}

/// Flips bits of the line: each one with a chance of 1 %, or one bit in 1 % of the bytes.
enum class Damage : std::uint8_t { bits, bytes };

std::string damaged(std::string bytes, Damage damage, std::uint64_t seed) {
  world::Random random(seed);
  const auto flip = [](char& byte, unsigned bit) {
    byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1U << bit));
  };
  for (char& byte : bytes) {
    if (damage == Damage::bits) {
      for (unsigned bit = 0; bit < 8; ++bit) {
        if (random.uniform(0.0, 1.0) < 0.01) flip(byte, bit);
      }
    } else if (random.uniform(0.0, 1.0) < 0.01) {
      flip(byte, static_cast<unsigned>(random.uniform(0.0, 8.0)));
    }
  }
  return bytes;
}

/// The fate of the epochs of damaged recordings.
struct Toll {
  std::size_t sent = 0;
  std::size_t used = 0;
  std::size_t wrong = 0;      // used, but not one of the clean epochs in every field
  std::size_t misplaced = 0;  // of these, more than 1.1 m from its place
  std::uint64_t caught = 0;   // by the gate
  std::uint64_t malformed = 0;
  std::uint64_t bad = 0;
};

bool same(const GnssFix& a, const GnssFix& b) {
  return a.time == b.time && a.latitude == b.latitude && a.longitude == b.longitude &&
         a.altitude == b.altitude && a.mode == b.mode && a.satellites == b.satellites &&
         a.hdop == b.hdop;
}

double metres(const GnssFix& a, const GnssFix& b) {
  constexpr double kMetresPerDegree = 111'195.0;
  return std::hypot(a.latitude - b.latitude,
                    (a.longitude - b.longitude) * std::cos(a.latitude / 57.296)) *
         kMetresPerDegree;
}

/// Metres from where the receiver was at that time.
double error(const GnssFix& fix, const std::vector<GnssFix>& clean) {
  const auto nearest =
      std::min_element(clean.begin(), clean.end(), [&](const GnssFix& a, const GnssFix& b) {
        return std::abs(a.time - fix.time) < std::abs(b.time - fix.time);
      });
  return metres(fix, *nearest);
}

void add(const Reading& reading, const std::vector<GnssFix>& clean, Toll& toll) {
  toll.sent += clean.size();
  toll.used += reading.fixes.size();
  toll.caught += reading.implausible;
  toll.malformed += reading.malformed;
  toll.bad += reading.bad;
  for (const GnssFix& fix : reading.fixes) {
    const auto equal = [&](const GnssFix& epoch) { return same(fix, epoch); };
    if (std::any_of(clean.begin(), clean.end(), equal)) continue;
    ++toll.wrong;
    if (fix.mode > 1 && error(fix, clean) > 1.1) ++toll.misplaced;
  }
}

/// The same epochs as a receiver says them in UBX.
std::string in_ubx(const std::vector<GnssFix>& epochs) {
  std::string bytes;
  for (const GnssFix& fix : epochs) {
    const auto frame = drivers::write_pvt(fix);
    bytes.append(frame.begin(), frame.end());
  }
  return bytes;
}

Toll toll_of(Damage damage, const std::filesystem::path& folder, bool ubx = false) {
  constexpr std::uint64_t kSeeds = 50;
  Toll toll;
  for (const auto& path : logs(folder)) {
    std::string bytes = support::bytes_of(path);
    std::vector<GnssFix> clean = read(bytes, kAtOnce).fixes;
    if (ubx) {
      bytes = in_ubx(clean);
      clean = read(bytes, kAtOnce).fixes;
    }
    const double pace = static_cast<double>(bytes.size()) / static_cast<double>(clean.size());
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      add(read(damaged(bytes, damage, seed), pace), clean, toll);
    }
  }
  std::printf(
      "epochs sent %zu, used %zu, refused by the gate %llu, malformed %llu, bad frames %llu, "
      "used though damaged %zu, of these more than 1.1 m off %zu\n",
      toll.sent, toll.used, static_cast<unsigned long long>(toll.caught),
      static_cast<unsigned long long>(toll.malformed), static_cast<unsigned long long>(toll.bad),
      toll.wrong, toll.misplaced);
  return toll;
}

// A checksum of eight bits lets some damage through; of that, what is as small as the changes from
// epoch to epoch cannot be distinguished from them. The bounds are those of the rest.
TEST(GnssDamage, OneFlippedBitInAHundredBytesLeavesHalfOfTheEpochsAndFewWrongOnes) {
  const auto folder = support::test_data("nmea");
  if (!folder) GTEST_SKIP() << support::kNoTestData;

  const Toll toll = toll_of(Damage::bytes, *folder);

  EXPECT_GT(toll.used, toll.sent * 4 / 10);
  EXPECT_GT(toll.caught, 0U);
  EXPECT_LE(toll.wrong, toll.used / 2000);
  EXPECT_EQ(toll.misplaced, 0U);
}

TEST(GnssDamage, OneFlippedBitInAHundredBitsLeavesFewEpochsAndHardlyAWrongOne) {
  const auto folder = support::test_data("nmea");
  if (!folder) GTEST_SKIP() << support::kNoTestData;

  const Toll toll = toll_of(Damage::bits, *folder);

  EXPECT_GT(toll.used, 0U);
  // The very first sentence of a line may be right by accident, before any damage was seen.
  EXPECT_LE(toll.wrong, 3U);
  EXPECT_EQ(toll.misplaced, 0U);
}

// Fletcher's sum does not see two flipped top bits an even distance apart.
TEST(GnssDamage, UbxLeavesAsFewWrongEpochsAsNmea) {
  const auto folder = support::test_data("nmea");
  if (!folder) GTEST_SKIP() << support::kNoTestData;

  const Toll bytes = toll_of(Damage::bytes, *folder, true);
  const Toll bits = toll_of(Damage::bits, *folder, true);

  EXPECT_GT(bytes.used, bytes.sent * 3 / 10);
  EXPECT_GT(bytes.caught, 0U);
  EXPECT_LE(bytes.wrong, bytes.used / 1000);
  EXPECT_EQ(bytes.misplaced, 0U);
  EXPECT_EQ(bits.wrong, 0U);
}

}  // namespace
