// SPDX-License-Identifier: LGPL-3.0-or-later
/// The moments at which a component no longer commands its device, and the order that the device
/// gets then. The clock of the components is moved by hand.
#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>

#include <mauve/guarded.h>
#include <mauve/host/user_stops.h>

#include "rt/guardian/guarded_outputs.h"
#include "support/outcomes.h"
#include "support/pipe_device.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::PipeDevice;
using test::tend;

PipeDevice*& wheels_device() {
  static PipeDevice* left = nullptr;
  return left;
}
PipeDevice*& other_wheels_device() {
  static PipeDevice* other = nullptr;
  return other;
}

/// Commands a device by each job, though none of its commands is seen here.
template <PipeDevice*& (*kDevice)()>
struct WheelsDriver : ramp::Up {
  mauve::Guarded stand{*this, "stand"};

  Status on_configure() override {
    if (Status ready = ramp::Up::on_configure(); !ready) return ready;
    return open();
  }
  Status open() { return stand.hold(kDevice()->descriptor(), {.bytes = "stand "}); }
  void on_cleanup() override {
    stand.drop();
    ramp::Up::on_cleanup();
  }
};
using Wheels = WheelsDriver<wheels_device>;
using OtherWheels = WheelsDriver<other_wheels_device>;

struct SameWheels : Wheels {};

/// Throws in its third job.
struct FailingWheels : Wheels {
  void update() override {
    if (state->value == 2) throw std::runtime_error("no answer");
    Wheels::update();
  }
};

/// Wheels that obey what another component writes, which has a safe value.
struct CruiseAndWheels : Architecture {
  SharedData<double> speed{*this, "speed"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> cruise{*this, "cruise"};
  Component<ramp::Shell, Wheels, ramp::Fsm> control{*this, "control"};

  Status on_configure() override {
    if (Status done = cruise.shell().out.connect(speed.write_service()); !done) return done;
    return control.shell().speed.connect(speed.read_service());
  }
};

struct FailingOtherWheels : OtherWheels {
  void update() override { throw std::runtime_error("no answer"); }
};

class SafeOrdersOfTasks : public testing::Test {
 protected:
  SafeOrdersOfTasks() {
    wheels_device() = &left_;
    other_wheels_device() = &other_;
    EXPECT_TRUE(outputs_.expect(rt::GuardianUse::off, nullptr));
  }
  ~SafeOrdersOfTasks() override {
    deployer_.reset();
    architecture_.reset();
    outputs_.leave();
  }

  template <typename Core>
  ramp::One<Core>& make() {
    auto made = std::make_unique<ramp::One<Core>>();
    ramp::One<Core>& one = *made;
    architecture_ = std::move(made);
    return one;
  }
  void deploy(UserStops* kept = nullptr) {
    DeployOptions how;
    how.simulated = true;
    how.stops = kept;
    deployer_ = std::make_unique<Deployer>(*architecture_, how);
    ASSERT_TRUE(deployer_->deploy());
  }
  void swap(const Edit& edit, bool on_probation = false) {
    Change change{{edit}};
    if (on_probation) change.probation.emplace();
    const auto done = deployer_->apply(change);
    ASSERT_TRUE(done) << to_string(done.error());
  }
  /// At least so many orders and nothing else. Two reasons for an order may come one after the
  /// other, and a core that goes takes its device with it after the first one.
  [[nodiscard]] static bool gets(PipeDevice& device, std::size_t orders) {
    const std::string order = "stand ";
    return test::eventually([&] {
      const std::string& all = device.bytes();
      if (all.size() < orders * order.size()) return false;
      for (std::size_t at = 0; at < all.size(); at += order.size()) {
        if (all.compare(at, order.size(), order) != 0) return false;
      }
      return true;
    });
  }
  /// The core in force.
  [[nodiscard]] Wheels& wheels() const {
    return static_cast<Wheels&>(*architecture_->find_component("control")->bundle()->core);
  }
  [[nodiscard]] ComponentState state() const { return deployer_->status("control").state; }

  PipeDevice left_;
  PipeDevice other_;
  rt::GuardedOutputs& outputs_ = rt::GuardedOutputs::of_process();
  UserStops kept_;  // outlives the deployer
  std::unique_ptr<Architecture> architecture_;
  std::unique_ptr<Deployer> deployer_;
};

TEST_F(SafeOrdersOfTasks, GoOutAtAFaultThatStopsTheComponent) {
  make<FailingWheels>();
  deploy();
  deployer_->run_for(15ms);
  EXPECT_EQ(left_.bytes(), "");

  deployer_->run_for(20ms);

  EXPECT_EQ(state(), ComponentState::faulted);
  EXPECT_TRUE(gets(left_, 2));
}

TEST_F(SafeOrdersOfTasks, GoOutAtAFaultBeforeTheFallbackTakesOver) {
  auto& architecture = make<FailingWheels>();
  architecture.control.task().on_fault.action = FaultPolicy::Action::fallback;
  architecture.control.fall_back_to(
      ComponentBase::Fallback{CoreType::of<ramp::Down>("ramp/down"), {}});
  deploy();

  deployer_->run_for(25ms);
  EXPECT_TRUE(gets(left_, 2)) << "the third job failed, and no other ran";
  deployer_->run_for(30ms);

  EXPECT_EQ(tend(*deployer_).size(), 1U);
  EXPECT_EQ(deployer_->status("control").core, "ramp/down");
}

TEST_F(SafeOrdersOfTasks, GoOutToTheDeviceThatADriverLeaves) {
  make<Wheels>();
  deploy();
  deployer_->run_for(20ms);

  swap(ramp::to_core<OtherWheels>("other"));

  EXPECT_TRUE(gets(left_, 1));
  deployer_->run_for(20ms);
  EXPECT_EQ(state(), ComponentState::running);
  EXPECT_EQ(other_.bytes(), "");
}

TEST_F(SafeOrdersOfTasks, StayWhenTheNextCoreHasTheDevice) {
  make<Wheels>();
  deploy();
  deployer_->run_for(20ms);

  swap(ramp::to_core<SameWheels>("same"));
  deployer_->run_for(20ms);
  ASSERT_TRUE(deployer_->stop({"control"}));

  EXPECT_TRUE(gets(left_, 2)) << "by the stop alone";
}

TEST_F(SafeOrdersOfTasks, GoOutToTheDeviceThatARollbackLeaves) {
  make<Wheels>();
  deploy();
  deployer_->run_for(20ms);
  swap(ramp::to_core<FailingOtherWheels>("failing"), true);

  deployer_->run_for(30ms);
  static_cast<void>(tend(*deployer_));

  EXPECT_EQ(state(), ComponentState::running);
  EXPECT_NE(deployer_->status("control").core, "failing");
  EXPECT_TRUE(gets(other_, 1));
}

TEST_F(SafeOrdersOfTasks, WaitForNoWriterInAStopOfAll) {
  architecture_ = std::make_unique<CruiseAndWheels>();
  deploy();
  deployer_->run_for(20ms);

  const auto stop = deployer_->begin_stop_all();
  deployer_->run_for(10ms);
  static_cast<void>(stop->advance());

  EXPECT_EQ(state(), ComponentState::stopped) << "its writer may be kept from the processor";
  EXPECT_TRUE(gets(left_, 2));
}

TEST_F(SafeOrdersOfTasks, GoOutAtAStopAlsoOfWhatStandsAlready) {
  make<Wheels>();
  deploy();
  deployer_->run_for(20ms);

  ASSERT_TRUE(deployer_->stop({"control"}));
  EXPECT_TRUE(gets(left_, 2));
  ASSERT_TRUE(deployer_->stop({"control"}));
  EXPECT_TRUE(gets(left_, 4));
  ASSERT_TRUE(deployer_->stop_all());
  EXPECT_TRUE(gets(left_, 6));
}

TEST_F(SafeOrdersOfTasks, GoOutAtAStartThatLeavesItStopped) {
  kept_.stop("control", {1000, "yesterday", 0});
  make<Wheels>();

  deploy(&kept_);

  EXPECT_TRUE(gets(left_, 2));
  EXPECT_EQ(state(), ComponentState::stopped);
}

TEST_F(SafeOrdersOfTasks, GoOutToADeviceThatComesBackToAComponentThatStands) {
  make<Wheels>();
  deploy();
  deployer_->run_for(20ms);
  wheels().stand.drop();
  ASSERT_TRUE(deployer_->stop({"control"}));
  EXPECT_EQ(left_.bytes(), "");

  ASSERT_TRUE(wheels().open());
  EXPECT_TRUE(gets(left_, 2));

  ASSERT_TRUE(deployer_->start({"control"}));
  deployer_->run_for(20ms);
  wheels().stand.drop();
  ASSERT_TRUE(wheels().open());
  ASSERT_TRUE(deployer_->stop({"control"}));
  EXPECT_TRUE(gets(left_, 4)) << "none while it ran";
}

TEST_F(SafeOrdersOfTasks, GoOutToADeviceThatComesBackWhileTheComponentRecovers) {
  auto& architecture = make<FailingWheels>();
  architecture.control.task().on_fault.action = FaultPolicy::Action::fallback;
  architecture.control.fall_back_to(
      ComponentBase::Fallback{CoreType::of<ramp::Down>("ramp/down"), {}});
  deploy();
  deployer_->run_for(15ms);
  wheels().stand.drop();
  deployer_->run_for(10ms);
  EXPECT_EQ(left_.bytes(), "");

  ASSERT_TRUE(wheels().open());

  EXPECT_TRUE(gets(left_, 2));
}

}  // namespace
}  // namespace mauve
