// SPDX-License-Identifier: LGPL-3.0-or-later
/// The resources of the localization (paper 5.1.2, 5.3): services, what they count, what survives.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "../../../plugins/localization/ekf_resource.h"
#include "../../../plugins/localization/gnss_to_utm.h"
#include "../../../plugins/world/random.h"

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/host/shared_data.h>
#include <mauve/observable.h>
#include <mauve/test_kit.h>

namespace localization {
namespace {

using rover::GnssFix;
using rover::MotionState;
using rover::Pose2D;
using rover::Twist;

constexpr Geographic kOrigin{43.5661, 1.4744};

/// A robot that drives a circle, in one component: its wheels, its receiver, its questions.
struct RobotShell : mauve::Shell {
  mauve::WritePort<Twist> twist{*this, "twist"};
  mauve::WritePort<GnssFix> fix{*this, "fix"};
  mauve::ReadPort<MotionState> predict{*this, "predict"};
  mauve::ReadPort<Pose2D> pose{*this, "pose"};
  mauve::CallPort<MotionState(double)> predict_at{*this, "predict_at"};
};

class RobotCore final : public mauve::Core<RobotShell> {
 public:
  mauve::Stateless stateless{*this};
  void update() {
    truth = moved(truth, 0.02).value;
    shell().twist.write({0.0, truth[kSpeed], truth[kTurn]});
    if (++jobs % 5 == 0) shell().fix.write(next_fix());
    status = shell().predict.read(state);
    pose_status = shell().pose.read(pose);
    ahead = shell().predict_at(static_cast<double>(mauve::job_time()) * 1e-9 + 1.0);
  }
  GnssFix next_fix() {
    const Utm utm;
    const Zone zone{31, false};
    const rover::Point2D origin = utm.forward(kOrigin, zone).value();
    const Geographic there = utm.reverse({origin.x + truth[kX] + jump, origin.y + truth[kY]}, zone);
    return {1.0, there.latitude, there.longitude, 150.0, 0.1, mode, 9};
  }

  State truth = (State() << 0.0, 0.0, 0.7, 1.0, 0.2, 0.0, 0.0, 0.0, 0.0).finished();
  double jump = 0.0;
  std::int32_t mode = 3;
  int jobs = 0;
  MotionState state;
  Pose2D pose;
  std::optional<MotionState> ahead;
  mauve::DataStatus status = mauve::DataStatus::no_data;
  mauve::DataStatus pose_status = mauve::DataStatus::no_data;
};

struct Robot : mauve::Architecture {
  mauve::Resource<GnssToUtmShell, GnssToUtmCore, GnssToUtmInterface> gnss_to_utm{*this,
                                                                                 "gnss_to_utm"};
  mauve::Resource<mauve::EmptyShell, EkfCore, EkfInterface> localization{*this, "localization"};
  mauve::Component<RobotShell, RobotCore, mauve::PeriodicFsm<RobotCore>> robot{*this, "robot"};

  mauve::Status on_configure() override {
    robot.fsm().period = std::chrono::milliseconds(20);
    RobotShell& shell = robot.shell();
    EkfInterface& ekf = localization.interface();
    for (mauve::Status done :
         {gnss_to_utm.shell().pose.connect(ekf.update_pose),
          shell.fix.connect(gnss_to_utm.interface().fix), shell.twist.connect(ekf.update_twist),
          shell.predict.connect(ekf.predict), shell.pose.connect(ekf.pose),
          shell.predict_at.connect(ekf.predict_at)}) {
      if (!done) return done;
    }
    return mauve::ok();
  }
  [[nodiscard]] double shown(mauve::CoreBase& core, std::string_view name) const {
    return std::stod(mauve::to_string(core.find_observable(name)->value()));
  }
  /// The reason of the warning `silent`, if it lasts.
  [[nodiscard]] static std::string silent(mauve::ResourceBase& resource) {
    const auto* warning =
        dynamic_cast<const mauve::Warning*>(resource.core().find_observable("silent"));
    if (warning == nullptr) return "there is no such warning";
    return warning->lasts() ? std::string(warning->reason()) : "";
  }
  [[nodiscard]] double localized(std::string_view name) {
    return shown(localization.ResourceBase::core(), name);
  }
  [[nodiscard]] double converted(std::string_view name) {
    return shown(gnss_to_utm.ResourceBase::core(), name);
  }
};

class Localization : public testing::Test {
 protected:
  void SetUp() override {
    const mauve::Status done = deployer_.deploy();
    ASSERT_TRUE(done) << to_string(done.error());
  }
  void run_for(double seconds) {
    deployer_.run_for(std::chrono::milliseconds(static_cast<int>(seconds * 1e3)));
  }
  RobotCore& core() { return robot_.robot.core(); }

  Robot robot_;
  mauve::Deployer deployer_{robot_, {.realtime = mauve::Realtime::off, .simulated = true}};
};

TEST_F(Localization, FollowsARobotFromWheelsAndSatellites) {
  run_for(0.06);
  EXPECT_FALSE(has_value(core().status)) << "no place before the third fix";
  run_for(0.5);
  EXPECT_TRUE(has_value(core().status));
  EXPECT_FALSE(has_value(core().pose_status)) << "no heading before the first metres";
  run_for(60.0);

  // The local frame begins at the first fix, five jobs from the true origin.
  ASSERT_TRUE(has_value(core().pose_status));
  EXPECT_NEAR(core().pose.x, core().truth[kX] - 0.0762, 0.1);
  EXPECT_NEAR(core().pose.y, core().truth[kY] - 0.0647, 0.1);
  EXPECT_NEAR(rover::wrap(core().pose.heading - core().truth[kHeading]), 0.0, 0.05);
  EXPECT_NEAR(core().state.x, core().pose.x, 1e-9);
  const State ahead = moved(core().truth, 1.0).value;
  ASSERT_TRUE(core().ahead);
  EXPECT_NEAR(core().ahead->x, ahead[kX] - 0.0762, 0.15);
  EXPECT_GT(core().ahead->variance_x, core().state.variance_x);
  EXPECT_EQ(robot_.converted("positions"), robot_.localized("accepted"));
  EXPECT_LT(robot_.localized("dispersion"), 0.2);
  EXPECT_EQ(robot_.converted("zone"), 31);
}

TEST_F(Localization, CountsWhatMakesSatellitesUnreliable) {
  run_for(20.0);
  ASSERT_EQ(robot_.localized("rejected"), 0);

  core().jump = 25.0;
  run_for(0.6);
  EXPECT_EQ(robot_.localized("rejected"), 6);
  EXPECT_EQ(robot_.localized("rejected_recently"), 6);
  EXPECT_GT(robot_.localized("innovation"), 9.21);
  EXPECT_GT(robot_.localized("pose_age"), 0.5);

  core().jump = 0.0;
  core().mode = 1;
  const double dispersion = robot_.localized("dispersion");
  run_for(10.0);
  EXPECT_EQ(robot_.converted("mode"), 1);
  EXPECT_EQ(robot_.converted("without_position"), 100);
  EXPECT_GT(robot_.localized("dispersion"), dispersion);
  EXPECT_GT(robot_.localized("pose_age"), 10.0);
}

TEST_F(Localization, GoesOnThroughAChangeOfAProperty) {
  run_for(20.0);
  const double accepted = robot_.localized("accepted");
  const MotionState before = core().state;

  const auto gate = deployer_.set("localization.core.gate", 2.0);
  const auto error = deployer_.set("gnss_to_utm.core.range_error", 2.5);
  run_for(1.0);

  ASSERT_TRUE(gate) << to_string(gate.error());
  ASSERT_TRUE(error) << to_string(error.error());
  EXPECT_GT(robot_.localized("accepted"), accepted);
  EXPECT_EQ(robot_.localized("rejected"), 0);
  EXPECT_NEAR(std::hypot(core().state.x - before.x, core().state.y - before.y), 1.0, 0.15);
}

TEST_F(Localization, StopsAnsweringWhereWhenNothingMeasures) {
  run_for(20.0);
  ASSERT_TRUE(deployer_.disconnect("robot.ports.twist"));
  ASSERT_TRUE(deployer_.disconnect("robot.ports.fix"));
  run_for(0.9);
  EXPECT_TRUE(has_value(core().pose_status));

  run_for(0.3);

  EXPECT_FALSE(has_value(core().pose_status));
  EXPECT_TRUE(has_value(core().status)) << "the covariance says how much a prediction is worth";
}

TEST_F(Localization, SaysWhyNothingComesOut) {
  core().mode = 1;
  run_for(4.9);
  EXPECT_EQ(robot_.silent(robot_.gnss_to_utm), "") << "not yet";
  run_for(0.3);
  EXPECT_EQ(robot_.silent(robot_.gnss_to_utm), "its receiver has no fix");
  EXPECT_EQ(robot_.silent(robot_.localization), "no position has come");

  core().mode = 3;
  run_for(10.0);
  EXPECT_EQ(robot_.silent(robot_.gnss_to_utm), "");
  EXPECT_EQ(robot_.silent(robot_.localization), "");

  ASSERT_TRUE(deployer_.disconnect("robot.ports.twist"));
  ASSERT_TRUE(deployer_.disconnect("robot.ports.fix"));
  run_for(6.2);  // blind_after and silent_after
  EXPECT_EQ(robot_.silent(robot_.localization), "nothing is measured");
}

TEST_F(Localization, DoesWithoutTheReceiverThatIsDisconnected) {
  run_for(20.0);

  ASSERT_TRUE(deployer_.disconnect("gnss_to_utm.ports.pose"));
  run_for(10.0);

  EXPECT_NEAR(core().pose.x, core().truth[kX] - 0.0762, 1.0);
  EXPECT_NEAR(core().pose.y, core().truth[kY] - 0.0647, 1.0);
}

TEST(LocalizationStart, IsWhereThePropertiesSay) {
  Robot robot;
  auto& core = robot.localization.core();
  ASSERT_TRUE(core.find_property("start_known")->set(true));
  mauve::Value::Object start{{"x", 3.0}, {"y", 4.0}, {"heading", 0.7}};
  ASSERT_TRUE(core.find_property("start")->set(start));
  mauve::Deployer deployer(robot, {.realtime = mauve::Realtime::off, .simulated = true});
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(std::chrono::milliseconds(70));

  ASSERT_TRUE(has_value(robot.robot.core().pose_status));
  EXPECT_NEAR(robot.robot.core().pose.x, 3.0, 0.1);
  EXPECT_NEAR(robot.robot.core().pose.y, 4.0, 0.1);
}

TEST(GnssToUtm, RefusesPositionsThatAreNone) {
  Robot robot;
  ASSERT_TRUE(robot.configure());
  const auto give = [&](double latitude, double longitude) {
    const GnssFix fix{1.0, latitude, longitude, 0.0, 1.0, 3, 9};
    robot.gnss_to_utm.interface().fix.write(&fix);
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  give(kNaN, 1.0);
  give(89.0, 1.0);
  EXPECT_EQ(robot.converted("zone"), 0) << "the origin waits for a position";
  for (int i = 0; i < OriginSearch::kAgree; ++i) give(43.5, 1.5);
  give(43.5, 120.0);
  give(43.5, 1e300);

  EXPECT_EQ(robot.converted("refused"), 4);
  EXPECT_EQ(robot.converted("positions"), 1);
  EXPECT_EQ(robot.localized("accepted"), 1);
  EXPECT_TRUE(robot.cleanup());
}

/// Receivers and their drivers send 0, 0 before they have a position, some of them with a mode.
TEST(GnssToUtm, TakesNoPositionAtExactlyZeroHoweverOftenItComes) {
  Robot robot;
  ASSERT_TRUE(robot.configure());
  const GnssFix zero{1.0, 0.0, 0.0, 0.0, 1.0, 3, 9};
  const GnssFix beside{1.0, 1e-7, 0.0, 0.0, 1.0, 3, 9};
  for (int i = 0; i < 30; ++i) robot.gnss_to_utm.interface().fix.write(&zero);
  EXPECT_EQ(robot.converted("zone"), 0);
  EXPECT_EQ(robot.converted("without_position"), 30);
  for (int i = 0; i < OriginSearch::kAgree; ++i) robot.gnss_to_utm.interface().fix.write(&beside);
  EXPECT_EQ(robot.converted("positions"), 1) << "a ship may be there";
  EXPECT_TRUE(robot.cleanup());
}

/// The fixes of a receiver that first says `wrong` a few times, then the right place.
struct FirstFixes {
  Robot robot;

  FirstFixes() { EXPECT_TRUE(robot.configure()); }
  ~FirstFixes() { EXPECT_TRUE(robot.cleanup()); }
  FirstFixes(const FirstFixes&) = delete;
  FirstFixes& operator=(const FirstFixes&) = delete;

  void give(const Geographic& place, int times = 1) {
    const GnssFix fix{1.0, place.latitude, place.longitude, 0.0, 1.0, 3, 9};
    for (int i = 0; i < times; ++i) robot.gnss_to_utm.interface().fix.write(&fix);
  }
  MotionState state() {
    MotionState state;
    mauve::Cursor cursor;
    EXPECT_TRUE(has_value(robot.localization.interface().predict.read(&state, cursor)));
    return state;
  }
};

TEST(GnssToUtm, TakesNoOriginFromWrongFirstFixes) {
  const Geographic sydney{-33.85, 151.2};
  for (const Geographic& place : {kOrigin, sydney}) {
    for (const Geographic& wrong : {Geographic{0.0, 0.0}, Geographic{43.5, 120.0},
                                    Geographic{place.latitude + 0.01, place.longitude}}) {
      for (const int times : {1, 2}) {
        FirstFixes receiver;
        receiver.give(wrong, times);
        receiver.give(place, 30);

        EXPECT_EQ(receiver.robot.converted("positions"), 28);
        EXPECT_EQ(receiver.robot.converted("refused"), 0);
        EXPECT_NEAR(receiver.state().x, 0.0, 0.01);
        EXPECT_NEAR(receiver.state().y, 0.0, 0.01);
      }
    }
  }
}

TEST(GnssToUtm, TakesNoOriginFromFixesThatAllDisagree) {
  FirstFixes receiver;

  for (int i = 0; i < 20; ++i) receiver.give({43.0 + 0.1 * i, 1.0});

  EXPECT_EQ(receiver.robot.converted("positions"), 0);
  EXPECT_EQ(receiver.robot.converted("zone"), 0);
}

/// On the clock of the bench, one fix a second.
struct SlowFixes {
  mauve::CoreBench<GnssToUtmShell, GnssToUtmCore> bench;

  SlowFixes() { EXPECT_TRUE(bench.configure()); }

  std::string silent_after(int seconds, const Geographic& place, double step = 0.0) {
    for (int i = 0; i < seconds; ++i) {
      bench.advance(std::chrono::seconds(1));
      bench.core().convert({1.0, place.latitude + step * i, place.longitude, 0.0, 1.0, 3, 9});
    }
    const auto* warning =
        dynamic_cast<const mauve::Warning*>(bench.core().find_observable("silent"));
    return warning->lasts() ? std::string(warning->reason()) : "";
  }
};

TEST(GnssToUtm, SaysWhyPositionsAreNotWrittenOn) {
  SlowFixes receiver;

  EXPECT_EQ(receiver.silent_after(10, {43.0, 1.0}, 0.1), "no 3 fixes in a row agree on an origin");
  EXPECT_EQ(receiver.silent_after(10, kOrigin), "");
  EXPECT_EQ(receiver.silent_after(4, {43.5, 120.0}), "") << "not yet";
  EXPECT_NE(receiver.silent_after(4, {43.5, 120.0}).find("are far from zone"), std::string::npos);
  EXPECT_EQ(receiver.silent_after(1, kOrigin), "");
}

TEST(GnssToUtm, TakesItsOriginFromTheProperties) {
  Robot robot;
  auto& core = robot.gnss_to_utm.core();
  ASSERT_TRUE(core.find_property("origin_at_first_fix")->set(false));
  ASSERT_TRUE(core.find_property("origin_latitude")->set(kOrigin.latitude));
  ASSERT_TRUE(core.find_property("origin_longitude")->set(kOrigin.longitude));
  ASSERT_TRUE(robot.configure());
  robot.robot.core().truth.head<2>() << 120.0, -45.0;

  const GnssFix fix = robot.robot.core().next_fix();
  robot.gnss_to_utm.interface().fix.write(&fix);
  MotionState state;
  mauve::Cursor cursor;
  ASSERT_TRUE(has_value(robot.localization.interface().predict.read(&state, cursor)));

  EXPECT_NEAR(state.x, 120.0, 1e-6);
  EXPECT_NEAR(state.y, -45.0, 1e-6);
  EXPECT_NEAR(state.variance_x, 0.09, 0.3) << "HDOP 0.1 times 3 m";
  EXPECT_TRUE(robot.cleanup());
}

}  // namespace
}  // namespace localization
