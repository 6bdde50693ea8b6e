// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <vector>

#include "../../../plugins/drivers/gnss/fix_gate.h"
#include "mauve/host/change.h"

namespace {

using drivers::FixContext;
using drivers::FixGate;
using rover::GnssFix;

constexpr double kGateLimit = 100.0;
constexpr double kMetre = 1.0 / 111'194.9;  // in degrees of latitude

/// A receiver on its way north, 20 m/s, at one fix a second of its clock and ours.
class Track {
 public:
  explicit Track(double begin = 50'000.0) : begin_(begin) {}

  static GnssFix fix(double time, double metres) {
    GnssFix fix;
    fix.time = time;
    fix.latitude = 43.0 + metres * kMetre;
    fix.longitude = 1.0;
    fix.mode = 3;
    fix.satellites = 8;
    fix.hdop = 1.0;
    return fix;
  }
  bool good() {
    ++second_;
    return admit(fix(time(), 20.0 * second_));
  }
  /// Not where it is, or not when.
  bool wrong(double metres, double seconds = 0.0) {
    ++second_;
    return admit(fix(time() + seconds, 20.0 * second_ + metres));
  }
  void silence(double seconds) { second_ += seconds; }
  bool admit(const GnssFix& fix) { return gate_.admit(fix, 1000.0 + second_, limit_); }
  void limit(double limit) { limit_ = limit; }

 private:
  [[nodiscard]] double time() const {
    const double time = begin_ + second_;
    return time < 86'400.0 ? time : time - 86'400.0;
  }

  double begin_;
  double second_ = 0.0;
  double limit_ = kGateLimit;
  FixGate gate_;
};

TEST(FixGate, LetsARobotDriveAlsoOverMidnight) {
  Track drive(86'380.0);

  for (int i = 0; i < 60; ++i) EXPECT_TRUE(drive.good()) << i;
}

TEST(FixGate, RefusesAJumpAndGoesOnWithTheNextGoodFix) {
  Track drive;
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(drive.good());

  EXPECT_FALSE(drive.wrong(1000.0));
  EXPECT_TRUE(drive.good());
  EXPECT_FALSE(drive.wrong(-1000.0));
  EXPECT_FALSE(drive.wrong(5000.0)) << "two that disagree";
  EXPECT_FALSE(drive.wrong(-9000.0)) << "three that disagree";
  EXPECT_TRUE(drive.good());
}

TEST(FixGate, RefusesAJumpInHeight) {
  Track drive;
  ASSERT_TRUE(drive.good());
  GnssFix high = Track::fix(50'001.5, 25.0);
  high.altitude = 400.0;

  EXPECT_FALSE(drive.admit(high));
  high.mode = 2;
  EXPECT_TRUE(drive.admit(high)) << "in two dimensions the height means nothing";
}

TEST(FixGate, RefusesATimeThatIsOutOfStepWithOurClock) {
  Track drive;
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(drive.good());

  EXPECT_FALSE(drive.wrong(0.0, -40.0));
  EXPECT_FALSE(drive.wrong(0.0, 600.0));
  EXPECT_TRUE(drive.good());
  EXPECT_TRUE(drive.wrong(0.0, -0.7)) << "a receiver may set its clock a little";
}

TEST(FixGate, BelievesANewPlaceThatPersists) {
  Track drive;
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(drive.good());

  EXPECT_FALSE(drive.wrong(50'000.0));
  EXPECT_FALSE(drive.wrong(50'000.0));
  EXPECT_TRUE(drive.wrong(50'000.0));
  EXPECT_TRUE(drive.wrong(50'000.0));
  EXPECT_FALSE(drive.good()) << "the old place is the jump now";
}

TEST(FixGate, IsNotLockedOutByAWrongFirstFix) {
  Track drive;
  EXPECT_TRUE(drive.wrong(1'000'000.0)) << "nothing to compare with";

  EXPECT_FALSE(drive.good());
  EXPECT_FALSE(drive.good());
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(drive.good());
}

TEST(FixGate, LetsALongTunnelPass) {
  Track drive;
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(drive.good());

  drive.silence(600.0);
  EXPECT_TRUE(drive.good());
  drive.silence(3.0 * 86'400.0);
  int admitted = 0;
  for (int i = 0; i < 3; ++i) admitted += drive.good() ? 1 : 0;

  EXPECT_GE(admitted, 1);
}

TEST(FixGate, LetsARecordingPassThatIsPlayedFasterThanLife) {
  FixGate gate;

  for (int i = 0; i < 200; ++i) {
    const double skipped = i < 100 ? 0.0 : 900.0;  // the recording itself has a hole
    EXPECT_TRUE(gate.admit(Track::fix(40'000.0 + i + skipped, 20.0 * i), 0.001 * i, kGateLimit))
        << i;
  }
}

TEST(FixGate, IsNotLockedOutWhenALineChangesItsPace) {
  FixGate gate;
  double now = 0.0;
  int refused = 0;

  for (int i = 0; i < 60; ++i) {
    now += i < 20 ? 1.0 : i < 40 ? 30.0 : 0.001;  // as sent, held up, and faster than life
    refused += gate.admit(Track::fix(50'000.0 + i, 20.0 * i), now, kGateLimit) ? 0 : 1;
  }

  EXPECT_LE(refused, FixGate::kPersists - 1);
}

TEST(FixGate, ComparesByOurClockWhenTheReceiverHasNoTime) {
  FixGate gate;

  EXPECT_TRUE(gate.admit(Track::fix(0.0, 0.0), 10.0, kGateLimit));
  EXPECT_TRUE(gate.admit(Track::fix(0.0, 90.0), 11.0, kGateLimit));
  EXPECT_FALSE(gate.admit(Track::fix(0.0, 1090.0), 12.0, kGateLimit));
}

TEST(FixGate, LetsEpochsWithoutPositionPassAndLearnsNothingFromThem) {
  Track drive;
  ASSERT_TRUE(drive.good());
  GnssFix none;

  EXPECT_TRUE(drive.admit(none));
  EXPECT_TRUE(drive.good());
}

TEST(FixGate, IsOpenWithoutALimit) {
  Track drive;
  drive.limit(0.0);

  EXPECT_TRUE(drive.good());
  EXPECT_TRUE(drive.wrong(1'000'000.0));
  EXPECT_TRUE(drive.good());
}

TEST(FixGate, MeasuresTheShortWayRoundTheDateLine) {
  FixGate gate;
  GnssFix fix = Track::fix(100.0, 0.0);
  fix.longitude = 179.9999;
  ASSERT_TRUE(gate.admit(fix, 100.0, kGateLimit));
  fix.time = 101.0;
  fix.longitude = -179.9999;

  EXPECT_TRUE(gate.admit(fix, 101.0, kGateLimit));
}

/// A receiver that stands, on a line that damages frames or does not.
class Standing {
 public:
  explicit Standing(bool damage) { context_.damage = damage; }

  GnssFix& fix() { return fix_; }
  FixContext& context() { return context_; }
  bool next() {
    ++second_;
    const bool admitted = gate_.admit(at(second_), second_, kGateLimit, context_);
    fix_ = good_;
    context_.separation = 48.0;
    return admitted;
  }

 private:
  GnssFix at(double second) {
    fix_.time += second;
    return fix_;
  }

  GnssFix good_ = Track::fix(50'000.0, 0.0);
  GnssFix fix_ = good_;
  FixContext context_{.separation = 48.0};
  FixGate gate_;
  double second_ = 0.0;
};

using Change = std::function<void(Standing&)>;
const std::vector<Change> kOdd{
    [](Standing& receiver) { receiver.fix().latitude += 2.0 * kMetre; },
    [](Standing& receiver) { receiver.fix().longitude -= 4.0 * kMetre; },
    [](Standing& receiver) { receiver.fix().altitude += 4.0; },
    [](Standing& receiver) { receiver.fix().satellites = 2; },
    [](Standing& receiver) { receiver.fix().hdop = 9.0; },
    [](Standing& receiver) { receiver.fix().time += 0.2; },
    [](Standing& receiver) { receiver.fix().mode = 2; },
    [](Standing& receiver) { receiver.fix().mode = 1; },
    [](Standing& receiver) { receiver.context().separation = 44.0; },
};

TEST(FixGateOnADamagedLine, RefusesWhateverIsOdd) {
  for (std::size_t i = 0; i < kOdd.size(); ++i) {
    Standing receiver(true);
    EXPECT_FALSE(receiver.next()) << "nothing to compare with";
    for (int epoch = 0; epoch < 5; ++epoch) ASSERT_TRUE(receiver.next());

    kOdd[i](receiver);
    EXPECT_FALSE(receiver.next()) << i;
    EXPECT_TRUE(receiver.next()) << i;
  }
}

TEST(FixGateOnADamagedLine, BelievesTheSecondThatIsOddInTheSameWay) {
  for (std::size_t i = 0; i < kOdd.size(); ++i) {
    Standing receiver(true);
    for (int epoch = 0; epoch < 5; ++epoch) receiver.next();

    kOdd[i](receiver);
    EXPECT_FALSE(receiver.next()) << i;
    kOdd[i](receiver);
    EXPECT_TRUE(receiver.next()) << i;
  }
}

TEST(FixGateOnADamagedLine, LetsPassWhatAnotherSentenceConfirms) {
  Standing receiver(true);
  for (int epoch = 0; epoch < 5; ++epoch) receiver.next();

  receiver.fix().latitude += 8.0 * kMetre;
  receiver.fix().hdop = 9.0;
  receiver.context().confirmed = receiver.context().dilution_known = true;
  EXPECT_TRUE(receiver.next());
}

TEST(FixGate, LosesNothingOddOnALineThatDamagesNothing) {
  for (std::size_t i = 0; i < kOdd.size(); ++i) {
    Standing receiver(false);
    for (int epoch = 0; epoch < 5; ++epoch) ASSERT_TRUE(receiver.next());

    kOdd[i](receiver);
    EXPECT_TRUE(receiver.next()) << i;
  }
}

}  // namespace
