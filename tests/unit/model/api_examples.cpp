// SPDX-License-Identifier: LGPL-3.0-or-later
/// The examples of the programming interface: the headers show the parts between two marks `//!
/// [Name]`. They are compiled and run here, so that an example is never out of date.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include <mauve/element.h>
#include <mauve/guarded.h>
#include <mauve/host/architecture.h>
#include <mauve/host/ring_buffer.h>
#include <mauve/host/shared_data.h>
#include <mauve/test_kit.h>

namespace mauve::examples {

struct Pose {
  double x = 0, y = 0;
};
struct Velocity {
  double forward = 0;
};

//! [Bounded]
struct Scan {
  mauve::Bounded<float, 1080> ranges;  // trivially copyable: it may be sent through a port
};
//! [Bounded]

//! [Text]
struct Fix {
  mauve::Text<16> station = std::string_view("toulouse");
};
//! [Text]

//! [Plausible]
struct CruiseShell : mauve::Shell {
  mauve::WritePort<Velocity> command{
      *this, "command", mauve::Safe{Velocity{}},
      mauve::Plausible<Velocity>{[](const Velocity& v, const Velocity&) { return v.forward < 2; }}};
};
//! [Plausible]

//! [Shell]
struct DriveShell : mauve::Shell {
  mauve::ReadPort<Pose> pose{*this, "pose"};
  mauve::WritePort<Velocity> command{*this, "command", mauve::Safe{Velocity{}}};
  mauve::CallPort<double(double)> predict{*this, "predict", mauve::Need::optional};
  mauve::EventPort<> reset{*this, "reset", mauve::Need::optional};
};
//! [Shell]

//! [Core]
class DriveCore : public mauve::Core<DriveShell> {
 public:
  using Contract = DriveCore;
  static constexpr const char* contract = "example/drive/1";

  virtual void update() = 0;  // [rt], called by the state machine
};
//! [Core]

//! [State]
struct Travelled {
  double distance = 0;
};
class Straight : public DriveCore {
 public:
  mauve::State<Travelled> travelled{*this};  // the next core continues with it

  void update() override { travelled->distance += 0.01; }
};
//! [State]

//! [Converts]
struct Odometer {
  double metres = 0;
};
class Counting final : public DriveCore {
  mauve::State<Odometer> odometer{*this};
  mauve::Converts<Travelled, Odometer> from_travelled{
      odometer, [](const Travelled& old, Odometer& now) noexcept { now.metres = old.distance; }};

 public:
  void update() override { odometer->metres += 0.01; }
};
//! [Converts]

//! [Stateless]
class Halt final : public DriveCore {
  mauve::Stateless nothing_to_hand_over{*this};

 public:
  void update() override { shell().command.write(Velocity{}); }
};
//! [Stateless]

//! [Parameters]
struct Gains {
  double kp = 1.0;  // the default of property core.kp
  double ki = 0.0;

  static auto parameters() {
    using mauve::parameter;
    return std::tuple{
        parameter("kp", &Gains::kp, "of the error", {.unit = "1/s", .min = 0.0, .max = 9.0}),
        parameter("ki", &Gains::ki, "of its sum", {.min = 0.0})};
  }
};

class Tuned final : public mauve::Core<mauve::EmptyShell> {
 public:
  mauve::Parameters<Gains> gains{*this};

  double output(double error, double sum) const { return gains->kp * error + gains->ki * sum; }
};
//! [Parameters]

class ToGoal final : public DriveCore {
 public:
  //! [Property]
  mauve::Property<double> speed{
      *this, "speed", 0.3, "at most", {.unit = "m/s", .min = 0.0, .max = 1.0}};
  //! [Property]
  //! [Observable]
  mauve::Observable<double> distance{*this, "distance", 0.0, "to the goal", "m"};
  //! [Observable]
  //! [Warning]
  mauve::Warning lost{*this, "lost", "there is no pose"};  // in update(): lost.begin("no map")
  //! [Warning]
  //! [TraceEvent]
  mauve::TraceEvent near{*this, "near"};  // in update(): near(distance);
  //! [TraceEvent]
  //! [SlowState]
  mauve::SlowState<std::string> map{*this};

  mauve::Status on_configure() override {
    return map ? mauve::ok() : map.set(std::string(1'000'000, ' '));  // the next core shares it
  }
  //! [SlowState]

  void update() override {
    //! [ReadPort]
    const Pose pose = shell().pose.read();
    if (!mauve::has_value(shell().pose.status())) return;  // not connected, or nothing written yet
    //! [ReadPort]
    distance = std::hypot(pose.x, pose.y);
    near(distance);
    //! [log]
    if (distance < 0.1) mauve::log(mauve::LogLevel::info, "arrived, {} m away", distance.get());
    //! [log]
    //! [WritePort]
    if (!shell().command.write(Velocity{speed})) shell().reset();  // nobody got the value
    //! [WritePort]
    //! [CallPort]
    const std::optional<double> soon = shell().predict(0.1);  // empty when nothing answers
    //! [CallPort]
    //! [EventPort]
    if (soon && *soon < 0) shell().reset();
    //! [EventPort]
  }
};

//! [Fsm]
struct DriveFsm : mauve::Fsm<DriveCore> {
  Exec drive{*this, "drive", &DriveCore::update};
  Sync pace{*this, "pace", 10ms, "between two steps"};

  mauve::Status on_configure() override {
    start_at(drive);
    drive.then(pace);
    pace.then(drive);
    return mauve::ok();
  }
};
//! [Fsm]

//! [PeriodicFsm]
using UsualFsm = mauve::PeriodicFsm<DriveCore>;  // update() every 10 ms
//! [PeriodicFsm]

class FilterCore : public mauve::Core<mauve::EmptyShell> {
 public:
  std::optional<Pose> newest() { return pose_; }
  void correct(const Pose& pose) { pose_ = pose; }
  double predict(double seconds) { return pose_ ? pose_->x + seconds : 0; }
  void forget() { pose_.reset(); }

 private:
  std::optional<Pose> pose_;
};

//! [Interface]
struct FilterInterface : mauve::Interface<FilterCore> {
  //! [ReadService]
  mauve::ReadService<Pose> read{*this, "read", &FilterCore::newest};
  //! [ReadService]
  //! [WriteService]
  mauve::WriteService<Pose> correct{*this, "correct", &FilterCore::correct};
  //! [WriteService]
  //! [CallService]
  mauve::CallService<double(double)> predict{*this, "predict", &FilterCore::predict};
  //! [CallService]
  //! [EventService]
  mauve::EventService<> forget{*this, "forget", &FilterCore::forget};
  //! [EventService]
};
//! [Interface]

//! [Guarded]
class Motor final : public mauve::Core<mauve::EmptyShell> {
  mauve::Guarded stand{*this, "stand"};
  int device = -1;  // opened with O_NONBLOCK before hold()

  mauve::Status on_configure() override {
    return stand.hold(device, {.bytes = "SPEED 0\n", .times = 3, .apart = 20ms});
  }
  void on_cleanup() override { stand.drop(); }  // then close the device
};
//! [Guarded]

//! [Result]
mauve::Result<double> half(double value) {
  if (value < 0) return mauve::refuse(mauve::Errc::invalid_value, "half", "must not be negative");
  return value / 2;
}
//! [Result]

//! [Architecture]
struct Robot : mauve::Architecture {
  //! [Component]
  mauve::Component<DriveShell, ToGoal, UsualFsm> drive{*this, "drive"};
  //! [Component]
  //! [Resource]
  mauve::Resource<mauve::EmptyShell, FilterCore, FilterInterface> filter{*this, "filter"};
  //! [Resource]
  //! [RingBuffer]
  mauve::RingBuffer<Pose> corrections{*this, "corrections"};
  //! [RingBuffer]
  //! [SharedData]
  mauve::SharedData<Velocity> command{*this, "command"};
  //! [SharedData]

  Robot() {
    drive.shell().pose.connect(filter.interface().read);
    drive.shell().command.connect(command.write_service());
    drive.shell().predict.connect(filter.interface().predict);
    drive.shell().reset.connect(filter.interface().forget);
  }
};
//! [Architecture]

TEST(ApiExamples, ParametersAreReadAsAStruct) {
  mauve::CoreBench<mauve::EmptyShell, Tuned> bench;
  bench.core().gains = {.kp = 2.0, .ki = 0.5};
  ASSERT_TRUE(bench.configure());
  EXPECT_EQ(bench.core().output(3.0, 4.0), 8.0);
}

TEST(ApiExamples, CoreBenchTestsACoreWithoutThreads) {
  //! [CoreBench]
  mauve::CoreBench<DriveShell, ToGoal> bench;
  bench.core().speed = 0.5;
  ASSERT_TRUE(bench.configure());
  bench.give(bench.shell().pose, Pose{3, 4});
  bench.core().update();
  EXPECT_EQ(bench.core().distance, 5);
  EXPECT_EQ(bench.written(bench.shell().command)->forward, 0.5);
  //! [CoreBench]
}

TEST(ApiExamples, ComponentBenchRunsAComponentOnSimulatedTime) {
  //! [ComponentBench]
  mauve::ComponentBench<DriveShell, Straight, UsualFsm> bench;
  ASSERT_TRUE(bench.deploy());
  bench.run_for(95ms);
  EXPECT_EQ(bench.status().releases, 10U);  // at 0, 10, ... 90 ms
  //! [ComponentBench]
  EXPECT_NEAR(bench.core().travelled->distance, 0.1, 1e-9);
}

TEST(ApiExamples, ASwapOfACoreWithItselfChangesNoOutput) {
  //! [difference_when_renewed]
  using Bench = mauve::ComponentBench<DriveShell, ToGoal, UsualFsm>;
  EXPECT_EQ(mauve::difference_when_renewed<Bench>(
                20, [](Bench& bench) { ASSERT_TRUE(bench.deploy()); },
                [](Bench& bench, int step) {
                  bench.ports().give(bench.shell().pose, Pose{3.0 + step, 4.0});
                  bench.run_for(10ms);
                }),
            "");
  //! [difference_when_renewed]
}

TEST(ApiExamples, RunTogether) {
  //! [Deployer]
  Robot robot;
  mauve::Deployer deployer{robot, {.realtime = mauve::Realtime::off, .simulated = true}};
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(25ms);
  ASSERT_TRUE(deployer.set("drive.core.speed", 0.5));  // a change of the running system
  EXPECT_EQ(deployer.status("drive").releases, 3U);
  //! [Deployer]
  EXPECT_EQ(*half(3), 1.5);
  EXPECT_FALSE(half(-3));
  static_assert(sizeof(Scan) > 4 * 1080);
  EXPECT_EQ(Fix{}.station.view(), "toulouse");
}

TEST(ApiExamples, ReplaceOneAnother) {
  mauve::ComponentBench<DriveShell, Straight, DriveFsm> bench;
  ASSERT_TRUE(bench.deploy());
  const auto swapped = bench.deployer().swap_core<Halt>("component");
  EXPECT_FALSE(swapped);  // Halt would lose the state of Straight
  EXPECT_TRUE(bench.deployer().swap_core<Counting>("component"));  // Counting converts it
}

}  // namespace mauve::examples
