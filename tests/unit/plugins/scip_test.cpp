// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "../../../plugins/drivers/laser/scip_write.h"
#include "../../../plugins/drivers/recording/recording.h"
#include "../../../plugins/world/random.h"
#include "../../../plugins/world/world.h"
#include "support/test_data.h"

namespace {

namespace scip = drivers::scip;
using scip::Limits;
using scip::ReplyReader;
using scip::ReplyWriter;
using scip::Request;
using Event = ReplyReader::Event;
using Values = std::vector<std::uint32_t>;

/// A URG-04LX, as its manual shows it.
constexpr Limits kUrg{20, 5600, 1024, 44, 725, 384, 600};

/// The output of a stream: scans, replies and the count of damaged ones.
struct Heard {
  std::vector<Values> scans;
  std::vector<std::string> replies;
  int bad = 0;
};

void hear(ReplyReader& reader, std::string_view bytes, Heard& heard) {
  for (const char byte : bytes) {
    switch (reader.push(byte)) {
      case Event::scan:
        heard.scans.emplace_back(reader.values().begin(), reader.values().end());
        break;
      case Event::reply:
        heard.replies.push_back(std::string(reader.command()) + std::string(reader.status()));
        break;
      case Event::bad:
        ++heard.bad;
        break;
      case Event::none:
        break;
    }
  }
}

Heard hear(std::string_view bytes, const Request& request = {}) {
  ReplyReader reader;
  reader.expect(request);
  Heard heard;
  hear(reader, bytes, heard);
  return heard;
}

Values some_values(std::size_t count, std::uint64_t seed) {
  world::Random random(seed);
  Values values;
  for (std::size_t i = 0; i < count; ++i) {
    values.push_back(static_cast<std::uint32_t>(random.uniform(0.0, 262'143.0)));
  }
  return values;
}

TEST(Scip, CodesNumbersAsTheSpecificationShows) {
  std::array<char, 2> two{};
  std::array<char, 3> three{};
  std::array<char, 4> four{};
  scip::encode(1234, two);
  scip::encode(5432, three);
  scip::encode(16'000'000, four);

  EXPECT_EQ(std::string(two.begin(), two.end()), "CB");
  EXPECT_EQ(std::string(three.begin(), three.end()), "1Dh");
  EXPECT_EQ(std::string(four.begin(), four.end()), "m2@0");
  EXPECT_EQ(scip::decode("CB"), 1234U);
  EXPECT_EQ(scip::decode("1Dh"), 5432U);
  EXPECT_EQ(scip::decode("m2@0"), 16'000'000U);
  EXPECT_FALSE(scip::decode("1D/"));
  EXPECT_FALSE(scip::decode("1Dp"));
}

TEST(Scip, SumsAsTheManualShows) {
  EXPECT_EQ(scip::checksum("00"), 'P');
  EXPECT_EQ(scip::checksum("99"), 'b');
  EXPECT_EQ(scip::checksum("DMIN:20"), '4');
  EXPECT_EQ(scip::checksum("DMAX:5600"), '_');
  EXPECT_EQ(scip::checksum("AMAX:725"), 'o');
}

constexpr const char* kUrgSays =
    "PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co., Ltd.);n\nDMIN:20;4\nDMAX:5600;_\nARES:1024;\\\n"
    "AMIN:44;7\nAMAX:725;o\nAFRT:384;6\nSCAN:600;e\n\n";

TEST(Scip, ReadsWhatAScannerSaysOfItself) {
  ReplyReader reader;
  Heard heard;
  hear(reader, kUrgSays, heard);

  EXPECT_EQ(heard.replies, std::vector<std::string>{"PP00"});
  EXPECT_TRUE(reader.limits().usable());
  EXPECT_EQ(reader.limits().dmin, 20);
  EXPECT_EQ(reader.limits().dmax, 5600);
  EXPECT_EQ(reader.limits().ares, 1024);
  EXPECT_EQ(reader.limits().amin, 44);
  EXPECT_EQ(reader.limits().amax, 725);
  EXPECT_EQ(reader.limits().afrt, 384);
  EXPECT_EQ(reader.limits().scan, 600);
}

TEST(Scip, AcceptsASumThatLeavesACommentOut) {
  std::string says = kUrgSays;
  const std::string plain = "SCAN:600;e";
  says.replace(says.find(plain), plain.size(), "SCAN:600<-turns;e");
  ReplyReader reader;
  Heard heard;
  hear(reader, says, heard);

  EXPECT_EQ(heard.bad, 0);
  EXPECT_EQ(reader.limits().scan, 600);
}

TEST(Scip, RefusesLimitsThatLackOneOrAreNoNumber) {
  std::string lacking = "\n" + std::string(kUrgSays);
  lacking.erase(lacking.find("AFRT"), std::string_view("AFRT:384;6\n").size());
  std::string wrong = "\n" + std::string(kUrgSays);
  const std::string field = std::string("AFRT:-84;") + scip::checksum("AFRT:-84");
  wrong.replace(wrong.find("AFRT:384;6"), 10, field);

  for (const std::string& says : {lacking, wrong}) {
    const Heard heard = hear(says);
    EXPECT_TRUE(heard.replies.empty()) << says;
    EXPECT_EQ(heard.bad, 1) << says;
  }
}

TEST(Scip, KnowsLimitsThatCannotBe) {
  EXPECT_TRUE(kUrg.usable());
  Limits limits = kUrg;
  limits.ares = 0;
  EXPECT_FALSE(limits.usable());
  limits = kUrg;
  limits.amax = 43;
  EXPECT_FALSE(limits.usable());
  limits = kUrg;
  limits.amax = 44 + 1024;
  EXPECT_FALSE(limits.usable()) << "more than a turn";
  limits = kUrg;
  limits.dmax = 20;
  EXPECT_FALSE(limits.usable());
  EXPECT_FALSE(Limits{}.usable());
}

TEST(Scip, AsksForEverythingInClustersThatFit) {
  const Request request = Request::all(kUrg, 3);
  const auto text = request.text();
  const Request fine = Request::all({20, 60'000, 5760, 0, 4320, 2160, 2400}, 3);

  EXPECT_EQ(std::string(text.begin(), text.end()), "MD0044072501000");
  EXPECT_EQ(request.values(), 682U);
  EXPECT_EQ(Request::parse({text.data(), text.size()}), request);
  EXPECT_EQ(fine.cluster, 4);
  EXPECT_LE(fine.values(), scip::kMostValues);
  EXPECT_FALSE(Request::parse("MD00440725010"));
  EXPECT_FALSE(Request::parse("MD004407x501000"));
  EXPECT_FALSE(Request::parse("MD0725004401000"));
  EXPECT_FALSE(Request::parse("MD0000900001000")) << "more values than a scan holds";
}

TEST(Scip, DecodesScansOfBothWidthsAndEveryLengthOfTheLastLine) {
  ReplyWriter writer;
  for (int characters : {2, 3}) {
    for (int last = 0; last < 200; ++last) {
      const Request request{0, last, 1, characters};
      Values values = some_values(request.values(), static_cast<std::uint64_t>(last));
      if (characters == 2) {
        for (std::uint32_t& value : values) value &= 0xfffU;
      }
      const Heard heard = hear(writer.scan(request, 7, values), request);
      ASSERT_EQ(heard.scans, std::vector<Values>{values}) << last;
    }
  }
}

TEST(Scip, DecodesTheSmallestOfEachCluster) {
  ReplyWriter writer;
  const Request request{10, 16, 3, 3};
  const Values values{5, 9, 7, 30, 20, 40, 8};

  const Heard heard = hear(writer.scan(request, 0, values), request);

  ASSERT_EQ(heard.scans.size(), 1U);
  EXPECT_EQ(heard.scans[0], (Values{5, 20, 8}));
}

TEST(Scip, TurnsValuesIntoMetresAndDirections) {
  rover::LaserScan scan;
  const Request request{383, 386, 1, 3};
  const Values values{19, 20, 5599, 5600};
  scip::show(request, kUrg, values, scan);

  EXPECT_FLOAT_EQ(scan.ranges[0], 0.0F) << "an error code";
  EXPECT_FALSE(scan.valid(0));
  EXPECT_TRUE(scan.valid(1));
  EXPECT_TRUE(scan.valid(2));
  EXPECT_FALSE(scan.valid(3));
  EXPECT_GE(scan.ranges[3], scan.range_max) << "nothing in sight";
  EXPECT_NEAR(scan.angle(1), 0.0, 1e-6) << "AFRT looks ahead";
  EXPECT_NEAR(scan.angle(2), 2.0 * std::numbers::pi / 1024.0, 1e-6) << "anticlockwise";
  EXPECT_FALSE(scip::blind(kUrg, values));
  EXPECT_TRUE(scip::blind(kUrg, Values{0, 19, 6}));
  EXPECT_TRUE(scip::blind(kUrg, Values{}));
}

TEST(Scip, ReachesNoFartherThanTwoCharactersSay) {
  rover::LaserScan scan;
  scip::show({384, 384, 1, 2}, kUrg, Values{4095}, scan);

  EXPECT_FALSE(scan.valid(0)) << "cut to 12 bits: 4.095 m or more";
}

TEST(Scip, MapsHalfDegreeBeamsOfTheWorldToSteps) {
  world::Map map;
  map.add({{2.0, 0.5}, 0.4});
  world::Random random(1);
  rover::LaserScan seen;
  world::cast(map, {}, {}, random, seen);
  const Limits limits = scip::limits_of(seen, 2400);
  std::array<std::uint32_t, scip::kMostValues> steps{};
  ASSERT_EQ(scip::measure(seen, 65'533, steps), 541U);
  rover::LaserScan shown;
  const Request request = Request::all(limits, 3);
  scip::show(request, limits, std::span(steps).first(541), shown);

  EXPECT_EQ(limits.ares, 720);
  EXPECT_EQ(limits.amin, 90);
  EXPECT_EQ(limits.afrt, 360);
  EXPECT_EQ(limits.amax, 630);
  ASSERT_EQ(shown.ranges.size(), seen.ranges.size());
  for (std::size_t beam = 0; beam < 541; ++beam) {
    ASSERT_NEAR(shown.angle(beam), seen.angle(beam), 1e-4);
    ASSERT_EQ(shown.valid(beam), seen.valid(beam)) << beam;
    if (!seen.valid(beam)) continue;
    ASSERT_NEAR(shown.ranges[beam], seen.ranges[beam], 0.0006);
  }
}

TEST(Scip, HasNoLimitsForAWorldWithoutAScan) {
  rover::LaserScan strange;
  EXPECT_FALSE(scip::limits_of(strange, 600).usable());
  strange.ranges.resize(3);
  strange.angle_increment = std::nanf("");
  strange.range_max = 5.0F;
  EXPECT_FALSE(scip::limits_of(strange, 600).usable());
}

TEST(Scip, BeginsInTheMiddleWithoutCountingWhatItMissed) {
  ReplyWriter writer;
  const Request request{0, 99, 1, 3};
  const Values values = some_values(100, 1);
  std::string stream(writer.scan(request, 0, values));
  stream = stream.substr(40) + stream;

  const Heard heard = hear(stream, request);

  EXPECT_EQ(heard.scans.size(), 1U);
  EXPECT_EQ(heard.bad, 0);
}

TEST(Scip, CountsADamagedScanOnceAndReadsTheNext) {
  ReplyWriter writer;
  const Request request{0, 99, 1, 3};
  const Values values = some_values(100, 1);
  const std::string good(writer.scan(request, 0, values));
  std::string damaged = good;
  damaged[60] = static_cast<char>(damaged[60] ^ 1);
  damaged[200] = static_cast<char>(damaged[200] ^ 1);
  const std::string cut = good.substr(0, 100) + good.substr(good.size() - 2);

  const Heard heard = hear(good + damaged + good + cut + good, request);

  EXPECT_EQ(heard.scans.size(), 3U);
  EXPECT_EQ(heard.bad, 2);
}

TEST(Scip, SkipsGarbageWithoutEnd) {
  ReplyWriter writer;
  const Request request{0, 9, 1, 3};
  const std::string good(writer.scan(request, 0, some_values(10, 1)));

  const Heard heard = hear(good + std::string(100'000, 'x') + "\n\n" + good, request);

  EXPECT_EQ(heard.scans.size(), 2U);
  EXPECT_EQ(heard.bad, 1);
}

TEST(Scip, BelievesNoScanThatWasNotAskedFor) {
  ReplyWriter writer;
  const std::string other(writer.scan({0, 8, 1, 3}, 0, some_values(9, 1)));

  const Heard heard = hear("\n" + other, {0, 9, 1, 3});

  EXPECT_TRUE(heard.scans.empty());
  EXPECT_EQ(heard.bad, 1);
}

TEST(Scip, NeverUsesAScanInWhichAnyBitFlipped) {
  ReplyWriter writer;
  const Request request{90, 160, 1, 3};
  const Values values = some_values(request.values(), 5);
  const std::string good(writer.scan(request, 123'456, values));
  int survived = 0;

  for (std::size_t byte = 0; byte < good.size(); ++byte) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::string flipped = good;
      flipped[byte] = static_cast<char>(static_cast<unsigned char>(flipped[byte]) ^ (1U << bit));
      const Heard heard = hear("\n" + flipped + good + good, request);
      for (const Values& scan : heard.scans) ASSERT_EQ(scan, values) << byte << "." << bit;
      ASSERT_FALSE(heard.scans.empty()) << "it goes on at the next empty line";
      survived += heard.scans.size() == 3 ? 1 : 0;
    }
  }

  EXPECT_LT(survived, 30) << "only the count of remaining scans, which does not matter";
}

TEST(Scip, SaysTheSameHoweverTheStreamIsCutAndDamaged) {
  world::Random random(11);
  ReplyWriter writer;
  const Request request{0, 150, 1, 3};
  for (int round = 0; round < 200; ++round) {
    std::string stream;
    std::vector<Values> sent;
    for (int i = 0; i < 5; ++i) {
      sent.push_back(some_values(151, static_cast<std::uint64_t>(round * 5 + i)));
      stream += writer.scan(request, 0, sent.back());
    }
    const auto pick = [&] {
      return static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(stream.size())));
    };
    for (int i = round % 4; i > 0; --i) stream.erase(pick(), pick() % 40);
    const Heard heard = hear("\n" + stream, request);

    EXPECT_GE(heard.scans.size() + 2U * static_cast<unsigned>(round % 4), 5U);
    std::size_t next = 0;
    for (const Values& scan : heard.scans) {
      while (next < sent.size() && sent[next] != scan) ++next;
      ASSERT_LT(next++, sent.size()) << "a scan that was never sent, or out of order";
    }
  }
}

TEST(Scip, CarriesARealRecordingUnchanged) {
  const auto path = support::test_data("lidar/exp2.dat");
  if (!path) GTEST_SKIP() << support::kNoTestData;
  const auto recording = drivers::Recording::load(*path);
  ASSERT_TRUE(recording);
  ReplyWriter writer;
  ReplyReader reader;
  const Request request = Request::all(kUrg, 3);
  reader.expect(request);
  rover::LaserScan before;
  rover::LaserScan after;
  std::array<std::uint32_t, scip::kMostValues> steps{};

  for (std::size_t i = 0; i < recording->size(); ++i) {
    recording->show(i, before);
    const std::size_t count = scip::measure(before, 5600, steps);
    Heard heard;
    hear(reader, writer.scan(request, 0, std::span(steps).first(count)), heard);
    ASSERT_EQ(heard.scans.size(), 1U) << i;
    scip::show(request, kUrg, heard.scans[0], after);
    ASSERT_EQ(after.ranges.size(), before.ranges.size());
    for (std::size_t beam = 0; beam < count; ++beam) {
      ASSERT_EQ(after.valid(beam), before.valid(beam)) << i << ": " << beam;
      if (!before.valid(beam)) continue;
      ASSERT_FLOAT_EQ(after.ranges[beam], before.ranges[beam]);
    }
  }
}

}  // namespace
