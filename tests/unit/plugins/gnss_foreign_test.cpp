// SPDX-License-Identifier: LGPL-3.0-or-later
/// Other senders on the line of a receiver cost no epoch, and their bytes are no damage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "../../../plugins/drivers/gnss/gnss_reader.h"
#include "../../../plugins/drivers/gnss/ubx_frame.h"
#include "../../../plugins/drivers/gnss/ubx_pvt.h"
#include "../../../plugins/world/random.h"

namespace {

using drivers::GnssReader;
using drivers::GnssStream;
using rover::GnssFix;

struct ForeignReading {
  int fixes = 0;
  int bad = 0;
  int refused = 0;
};

ForeignReading read_epochs(const std::vector<std::string>& seconds) {
  GnssStream stream;
  GnssReader reader;
  ForeignReading reading;
  for (std::size_t second = 0; second < seconds.size(); ++second) {
    for (const char byte : seconds[second]) {
      stream.push(byte);
      for (auto found = stream.next(); found != GnssStream::Event::none; found = stream.next()) {
        reading.bad += found == GnssStream::Event::bad ? 1 : 0;
        if (found == GnssStream::Event::bad) continue;
        do {
          const auto event = reader.read(found, stream, static_cast<double>(second), 100.0);
          reading.fixes += event == GnssReader::Event::fix ? 1 : 0;
          reading.refused += event == GnssReader::Event::implausible ? 1 : 0;
          reading.bad += event == GnssReader::Event::malformed ? 1 : 0;
        } while (reader.unread());
      }
    }
  }
  return reading;
}

/// The text between start and `*`, with its right checksum.
std::string sealed(char start, std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  constexpr std::string_view kHex = "0123456789ABCDEF";
  return start + std::string(text) + "*" + kHex[sum / 16U] + kHex[sum % 16U] + "\r\n";
}

/// A boat that speeds up and turns, and whose satellites and dilution change: a strict gate would
/// refuse it.
std::string boat_gga(int second) {
  std::string text(128, '\0');
  const int size =
      std::snprintf(text.data(), text.size(),
                    "GPGGA,12%02d%02d.00,4334.%05d,N,00128.%05d,E,1,%02d,%d.9,1%d.0,M,"
                    "48.0,M,,",
                    second / 60, second % 60, second * second % 997 * 3, second * second * 4,
                    5 + second * 5 % 7, 1 + second % 4, 50 + second * 7 % 11);
  text.resize(static_cast<std::size_t>(size));
  return sealed('$', text);
}

std::string boat_pvt(int second) {
  GnssFix fix;
  fix.time = 43'200.0 + second;
  fix.latitude = 43.5 + 1e-6 * second * second;
  fix.longitude = 1.5 - 2e-6 * second * second;
  fix.altitude = 150.0 + second * 7 % 11;
  fix.hdop = 1.0 + second % 4;
  fix.mode = 3;
  fix.satellites = 5 + second * 5 % 7;
  const auto frame = drivers::write_pvt(fix);
  return {frame.begin(), frame.end()};
}

int drawn(world::Random& random, int below) {
  return static_cast<int>(random.uniform(0.0, static_cast<double>(below)));
}

std::string drawn_bytes(world::Random& random, int size, int from, int below) {
  std::string bytes;
  while (static_cast<int>(bytes.size()) < size) {
    bytes.push_back(static_cast<char>(from + drawn(random, below - from)));
  }
  return bytes;
}

/// Six-bit text as AIS has it, and as logs have it: no `$`, `!`, `*`.
std::string drawn_text(world::Random& random, int size) {
  return drawn_bytes(random, size, '0', 'X');
}

std::string drawn_address(world::Random& random, int size) {
  return drawn_bytes(random, size, 'A', 'Z' + 1);
}

using Sender = std::function<std::string(world::Random&)>;

std::string ubx_of(std::string payload, std::uint8_t group, std::uint8_t id) {
  std::vector<std::uint8_t> frame(payload.size() + 8);
  std::copy(payload.begin(), payload.end(), frame.begin() + 6);
  drivers::ubx_seal(frame, group, id);
  return {frame.begin(), frame.end()};
}

std::string ubx_message(world::Random& random) {
  const int size = drawn(random, 3) == 0 ? drawn(random, 65'536) : drawn(random, 2000);
  const auto group = static_cast<std::uint8_t>(drawn(random, 256));
  return ubx_of(drawn_bytes(random, size, 0, 256), group, 0x43);
}

std::string rtcm(world::Random& random) {
  const int size = drawn(random, 1023);
  return "\xd3" + std::string(1, static_cast<char>(size / 256)) +
         drawn_bytes(random, size + 4, 0, 256);
}

std::string tag_block(world::Random& random) {
  const std::string block = sealed('\\', "g:1-2-" + std::to_string(drawn(random, 9999)));
  const std::string ais = sealed('!', "AIVDM,2,1,1,A," + drawn_text(random, 40) + ",0");
  return block.substr(0, block.size() - 2) + "\\" + ais;
}

std::string hash_log(world::Random& random) {
  char sum[9];
  std::snprintf(sum, sizeof sum, "%08x", static_cast<unsigned>(drawn(random, 1 << 30)));
  const std::string start = drawn(random, 2) == 0 ? "#" : "%";
  const std::string name = drawn_address(random, 8);
  const std::string text = drawn_text(random, 90);
  return start + name + ",COM1,0,77.5;" + text + "*" + sum + "\r\n";
}

std::string dollar_log(world::Random& random) {
  std::string log = hash_log(random);
  log[0] = '$';
  return log;
}

std::string without_checksum(world::Random& random) {
  const std::string name = drawn_address(random, 3 + drawn(random, 6));
  return "$P" + name + "," + drawn_text(random, drawn(random, 300)) + "\r\n";
}

std::string long_sentence(world::Random& random) {
  const std::string name = drawn_address(random, 3 + drawn(random, 9));
  return sealed('$', "P" + name + "," + drawn_text(random, drawn(random, 1000)));
}

std::string checksum_of_its_own(world::Random& random) {
  const std::string name = drawn_address(random, 4);
  const std::string text = drawn_text(random, 30);
  return "$P" + name + "," + text + "*" + drawn_bytes(random, 2, '0', '9' + 1) + "\r\n";
}

std::string prose(world::Random& random) {
  static const std::vector<std::string> kProse{
      "Hello! It costs $5, or $USD 7*12.\r\n",
      "# Notes: $GLGSV  for GLONASS, and $GPGSV*xy for GPS\r\n",
      "level 3*4A\r\n",
      "* * *00\r\n",
      "$*00\r\n$$$$\r\n!!\r\n",
      "AT+CSQ\r\r\nOK\r\n",
      "lat=43*2F\n",
      "$GPTXT\r\n$GPGGA,120000.00\r\n",
      "the manual has $GPRMC,123519,A,4807.038,N*00 as its example\r\n"};
  return kProse[static_cast<std::size_t>(drawn(random, static_cast<int>(kProse.size())))];
}

const std::vector<Sender> kSenders{
    [](world::Random& random) {
      return sealed('!', "AIVDM,1,1,,A," + drawn_text(random, 28) + ",0");
    },
    ubx_message,
    rtcm,
    tag_block,
    hash_log,
    dollar_log,
    without_checksum,
    long_sentence,
    checksum_of_its_own,
    prose,
    [](world::Random& random) { return drawn_bytes(random, drawn(random, 400), 0, 256) + "\r\n"; },
};

class GnssAmongOthers : public testing::TestWithParam<int> {};

TEST_P(GnssAmongOthers, NoEpochIsLostAndNothingIsDamage) {
  world::Random random(static_cast<std::uint64_t>(GetParam()));
  for (const bool ubx : {false, true}) {
    std::vector<std::string> seconds;
    for (int second = 0; second < 60; ++second) {
      std::string bytes = ubx ? boat_pvt(second) : boat_gga(second);
      for (int i = drawn(random, 4); i > 0; --i) {
        bytes +=
            kSenders[static_cast<std::size_t>(drawn(random, static_cast<int>(kSenders.size())))](
                random);
      }
      seconds.push_back(bytes);
    }
    seconds.emplace_back(2100, '\0');  // what may be a message is no longer waited for

    const ForeignReading reading = read_epochs(seconds);

    EXPECT_EQ(reading.fixes, 60) << (ubx ? "UBX" : "NMEA");
    EXPECT_EQ(reading.bad, 0) << (ubx ? "UBX" : "NMEA");
    EXPECT_EQ(reading.refused, 0) << (ubx ? "UBX" : "NMEA");
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, GnssAmongOthers, testing::Range(1, 61));

TEST(GnssAmongOthers, EachOtherSenderAloneCostsNothing) {
  for (std::size_t sender = 0; sender < kSenders.size(); ++sender) {
    world::Random random(77 + sender);
    std::vector<std::string> seconds;
    for (int second = 0; second < 150; ++second) {
      const std::string before = kSenders[sender](random);
      seconds.push_back(boat_gga(second) + before);
    }
    const ForeignReading reading = read_epochs(seconds);

    EXPECT_EQ(reading.bad, 0) << sender;
    EXPECT_EQ(reading.refused, 0) << sender;
    EXPECT_GE(reading.fixes, 149) << sender;
  }
}

TEST(GnssAmongOthers, ADamagedLineIsStillDamage) {
  std::vector<std::string> seconds;
  for (int second = 0; second < 30; ++second) {
    std::string other = sealed('$', "GPRMC," + std::to_string(second) + ",A");
    if (second > 2 && second % 3 == 0) other[9] ^= 1;
    std::string gga = boat_gga(second);
    if (second % 10 == 9) gga[30] ^= 1;
    seconds.push_back(other + gga);
  }

  EXPECT_EQ(read_epochs(seconds).bad, 12);
}

}  // namespace
