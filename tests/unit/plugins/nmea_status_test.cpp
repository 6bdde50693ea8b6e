// SPDX-License-Identifier: LGPL-3.0-or-later
/// The fields beside a position decide whether it is a fix, and each epoch is used once.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "../../../plugins/drivers/gnss/nmea_fix.h"

namespace {

using drivers::FixReader;
using rover::GnssFix;

std::vector<GnssFix> epochs_of(const std::vector<std::string>& frames) {
  FixReader reader;
  std::vector<GnssFix> epochs;
  for (const std::string& frame : frames) {
    do {
      const FixReader::Event event = reader.read(frame);
      EXPECT_NE(event, FixReader::Event::malformed) << frame;
      if (event == FixReader::Event::fix) epochs.push_back(reader.fix());
    } while (reader.unread());
  }
  if (reader.release() == FixReader::Event::fix) epochs.push_back(reader.fix());
  return epochs;
}

std::string clock_at(int second) { return std::to_string(120'000 + second) + ".00"; }

std::string gga_at(int second, const std::string& quality, const std::string& satellites,
                   const std::string& talker = "GP") {
  return talker + "GGA," + clock_at(second) + ",4334.00000,N,00128.00000,E," + quality + "," +
         satellites + ",0.9,150.0,M,48.0,M,,";
}
std::string rmc_at(int second, const std::string& status, const std::string& mode) {
  return "GPRMC," + clock_at(second) + "," + status +
         ",4334.00000,N,00128.00000,E,0.0,0.0,281126,,," + mode;
}
std::string gll_at(int second, const std::string& status, const std::string& mode) {
  return "GPGLL,4334.00000,N,00128.00000,E," + clock_at(second) + "," + status + "," + mode;
}

TEST(NmeaStatus, DeadReckoningAndWhatIsTypedInOrSimulatedIsNoFix) {
  for (const char* quality : {"0", "6", "7", "8"}) {
    const auto epochs = epochs_of({gga_at(0, quality, "09"), gga_at(1, quality, "00")});
    ASSERT_EQ(epochs.size(), 2U);
    EXPECT_EQ(epochs[0].mode, 1) << quality;
    EXPECT_EQ(epochs[0].latitude, 0.0);
    EXPECT_EQ(epochs[1].mode, 1) << quality;
  }
  for (const char* quality : {"1", "2", "3", "4", "5"}) {
    EXPECT_EQ(epochs_of({gga_at(0, quality, "09")}).at(0).mode, 3) << quality;
  }
}

TEST(NmeaStatus, VoidRmcOrGllOfTheSameEpochMakesItNoFix) {
  for (const auto& said :
       {rmc_at(0, "V", "A"), rmc_at(0, "V", ""), rmc_at(0, "A", "S"), rmc_at(0, "A", "E"),
        rmc_at(0, "A", "N"), gll_at(0, "V", "A"), gll_at(0, "A", "E")}) {
    const auto epochs = epochs_of({said, gga_at(0, "1", "09")});
    ASSERT_EQ(epochs.size(), 1U) << said;
    EXPECT_EQ(epochs[0].mode, 1) << said;
  }
  for (const auto& said :
       {rmc_at(0, "A", "A"), rmc_at(0, "A", "D"), rmc_at(0, "A", ""), gll_at(0, "A", "R"),
        std::string("GPGLL,4334.0,N,00128.0,E,120000.00")}) {
    EXPECT_EQ(epochs_of({said, gga_at(0, "1", "09")}).at(0).mode, 3) << said;
  }
  EXPECT_EQ(epochs_of({rmc_at(0, "A", "A"), gll_at(0, "V", "N"), gga_at(0, "1", "09")}).at(0).mode,
            1)
      << "one is enough";
}

TEST(NmeaStatus, GnsMakesItNoFixWhenNoSystemHasMeasured) {
  const auto gns_at = [](int second, const std::string& modes) {
    return "GNGNS," + clock_at(second) + ",4334.00000,N,00128.00000,E," + modes +
           ",09,0.9,150.0,48.0,,";
  };
  for (const char* modes : {"NN", "SS", "EE", "NEMS"}) {
    EXPECT_EQ(epochs_of({gns_at(0, modes), gga_at(0, "1", "09")}).at(0).mode, 1) << modes;
  }
  for (const char* modes : {"AN", "NA", "RR", "F", ""}) {
    EXPECT_EQ(epochs_of({gns_at(0, modes), gga_at(0, "1", "09")}).at(0).mode, 3) << modes;
  }
  const auto found =
      epochs_of({"GPGGA,,,,,,0,,,,,,,,", gns_at(0, "NN"), gga_at(1, "1", "04"), gns_at(1, "AN")});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1].mode, 3) << "the first epoch with a fix waits for its own GNS";
}

TEST(NmeaStatus, IsWaitedForWhereItComesAfterGgaAndTheLastWasVoid) {
  std::vector<std::string> frames;
  for (int second = 0; second < 6; ++second) {
    frames.push_back(gga_at(second, "1", "09"));
    frames.push_back(rmc_at(second, second < 3 ? "V" : "A", ""));
  }

  const auto epochs = epochs_of(frames);

  ASSERT_EQ(epochs.size(), 6U);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_EQ(epochs[i].mode, i < 3 ? 1 : 3) << i;
}

TEST(NmeaStatus, OfAnEpochLongAgoCountsNoMore) {
  EXPECT_EQ(epochs_of({rmc_at(0, "V", "N"), gga_at(3, "1", "09")}).at(0).mode, 1);
  EXPECT_EQ(epochs_of({rmc_at(0, "V", "N"), gga_at(30, "1", "09")}).at(0).mode, 3);
}

TEST(NmeaStatus, NoSatellitesInGgaIsAFixWhereRmcVouchesForIt) {
  const std::string three = "GNGSA,A,3,68,69,70,78,84,85,,,,,,,1.5,1.3,1.0,2";
  const std::string none = "GNGSA,A,1,,,,,,,,,,,,,,,";
  EXPECT_EQ(epochs_of({rmc_at(0, "A", "D"), gga_at(0, "2", "00"), three}).at(0).mode, 3);
  EXPECT_EQ(epochs_of({rmc_at(0, "A", "D"), three, gga_at(0, "2", "00")}).at(0).mode, 3);
  EXPECT_EQ(epochs_of({rmc_at(0, "A", "D"), none, gga_at(0, "2", "00")}).at(0).mode, 1);
  EXPECT_EQ(epochs_of({rmc_at(0, "V", "N"), three, gga_at(0, "2", "00")}).at(0).mode, 1);
  EXPECT_EQ(epochs_of({three, gga_at(0, "2", "00")}).at(0).mode, 1) << "nobody vouches";
}

TEST(NmeaNumbers, MayHaveASignZerosAndBlanks) {
  for (const char* height : {"+150.0", "+00150", " 150.0 ", "150", "150.", "0150.000"}) {
    const auto epochs = epochs_of({"GPGGA,120000.00,4334.00000,N,00128.00000,E,1, 9,+0.9," +
                                   std::string(height) + ",M,+48.0,M,,"});
    ASSERT_EQ(epochs.size(), 1U) << height;
    EXPECT_DOUBLE_EQ(epochs[0].altitude, 150.0) << height;
    EXPECT_EQ(epochs[0].satellites, 9);
  }
}

TEST(NmeaNumbers, MayBeRoundedUpToSixty) {
  const auto epochs =
      epochs_of({"GPGGA,120060.00,4360.00000,N,00159.99999,W,1,09,0.9,150.0,M,48.0,M,,",
                 "GPGGA,235960.00,4359.99999,S,00160.0000,W,1,09,0.9,150.0,M,48.0,M,,"});

  ASSERT_EQ(epochs.size(), 2U);
  EXPECT_DOUBLE_EQ(epochs[0].latitude, 44.0);
  EXPECT_DOUBLE_EQ(epochs[0].time, 12 * 3600 + 60);
  EXPECT_DOUBLE_EQ(epochs[1].longitude, -2.0);
  EXPECT_DOUBLE_EQ(epochs[1].time, 86'400.0);
}

TEST(NmeaTalkers, EachEpochIsWrittenOnceByTheTalkerWithTheMostSatellites) {
  for (const bool best_first : {true, false}) {
    std::vector<std::string> frames;
    for (int second = 0; second < 10; ++second) {
      frames.push_back(gga_at(second, "1", best_first ? "05" : "01", best_first ? "GP" : "GA"));
      frames.push_back(gga_at(second, "1", best_first ? "01" : "05", best_first ? "GA" : "GP"));
    }

    const auto epochs = epochs_of(frames);

    ASSERT_EQ(epochs.size(), 10U);
    for (std::size_t i = 1; i < 10; ++i) EXPECT_EQ(epochs[i].satellites, 5) << i;
  }
}

TEST(NmeaTalkers, OneThatIsAnEpochBehindIsNotUsed) {
  std::vector<std::string> frames;
  for (int second = 0; second < 10; ++second) {
    frames.push_back(gga_at(second, "1", "09"));
    if (second > 0) frames.push_back(gga_at(second - 1, "1", "12", "GA"));
  }

  const auto epochs = epochs_of(frames);

  ASSERT_EQ(epochs.size(), 10U);
  for (std::size_t i = 1; i < epochs.size(); ++i) EXPECT_GT(epochs[i].time, epochs[i - 1].time);
}

TEST(NmeaTalkers, OneWithoutAFixSilencesNoOther) {
  std::vector<std::string> frames;
  for (int second = 0; second < 10; ++second) {
    frames.push_back(gga_at(second + 1, "0", "00", "GA"));
    frames.push_back(gga_at(second, "1", "09"));
  }

  const auto epochs = epochs_of(frames);

  const auto fixes =
      std::count_if(epochs.begin(), epochs.end(), [](const auto& fix) { return fix.mode == 3; });
  EXPECT_GE(fixes, 9);
}

TEST(NmeaTalkers, ASentenceThatComesTwiceIsOneEpoch) {
  std::vector<std::string> frames;
  for (int second = 0; second < 8; ++second) {
    for (int i = 0; i < 2; ++i) frames.push_back(gga_at(second, "1", "09"));
    for (int i = 0; i < 2; ++i) frames.push_back(rmc_at(second, "A", "A"));
  }
  EXPECT_EQ(epochs_of(frames).size(), 8U);
}

TEST(NmeaTalkers, AChangeOfTheTalkerLosesNoEpoch) {
  std::vector<std::string> frames;
  for (int second = 0; second < 12; ++second) {
    frames.push_back(gga_at(second, "1", "09", second % 4 < 2 ? "GP" : "GN"));
  }
  EXPECT_EQ(epochs_of(frames).size(), 12U);
}

TEST(NmeaTalkers, ATalkerThatIsNotInEachEpochCostsNone) {
  for (const int every : {2, 3, 7}) {
    for (const bool best_first : {true, false}) {
      std::vector<std::string> frames;
      for (int second = 0; second < 30; ++second) {
        const std::string best = gga_at(second, "1", "07", "GL");
        const bool there = second % every != 0;
        if (there && best_first) frames.push_back(best);
        frames.push_back(gga_at(second, "1", "03", "GP"));
        frames.push_back(gga_at(second, "1", "02", "GA"));
        if (there && !best_first) frames.push_back(best);
      }

      const auto epochs = epochs_of(frames);

      ASSERT_EQ(epochs.size(), 30U) << every;
      for (int second = 0; second < 30; ++second) {
        EXPECT_EQ(epochs[static_cast<std::size_t>(second)].time, 43'200.0 + second);
        EXPECT_GE(epochs[static_cast<std::size_t>(second)].satellites, 3);
      }
    }
  }
}

TEST(NmeaTalkers, TheBestOfAnEpochIsUsedThoughItsTalkerWasNotTheBestBefore) {
  const auto epochs = epochs_of({gga_at(0, "1", "03", "GP"), gga_at(0, "1", "07", "GL"),
                                 gga_at(1, "1", "09", "GP"), gga_at(1, "1", "02", "GL"),
                                 gga_at(2, "0", "00", "GP"), gga_at(2, "1", "05", "GL")});

  ASSERT_EQ(epochs.size(), 3U);
  EXPECT_EQ(epochs[1].satellites, 9);
}

TEST(NmeaStatus, ThatDoesNotComeCostsNoEpoch) {
  std::vector<std::string> frames;
  for (int second = 0; second < 9; ++second) {
    frames.push_back(gga_at(second, "1", "09"));
    if (second % 3 != 2) frames.push_back(rmc_at(second, "V", "N"));
  }

  const auto epochs = epochs_of(frames);

  ASSERT_EQ(epochs.size(), 9U);
  for (std::size_t i = 1; i < 9; ++i) EXPECT_EQ(epochs[i].mode, 1) << i;
}

TEST(NmeaTalkers, EpochsWithoutTimeAreAllWritten) {
  const std::vector<std::string> frames(6, "GPGGA,,,,,,0,00,99.99,,,,,,");
  EXPECT_EQ(epochs_of(frames).size(), 6U);
  std::vector<std::string> changed(3, frames[0]);
  changed.insert(changed.end(), 3, "GNGGA,,,,,,0,00,99.99,,,,,,");
  EXPECT_GE(epochs_of(changed).size(), 5U) << "the first of another talker may be the same epoch";
}

}  // namespace
