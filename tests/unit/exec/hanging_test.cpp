// SPDX-License-Identifier: LGPL-3.0-or-later
/// A deployment with a job that does not end.
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::eventually;

struct Hanging : ramp::Up {
  void update() override {
    while (!released().load()) std::this_thread::sleep_for(1ms);
    shell().out.write(5.0);
  }
  static std::atomic<bool>& released() {
    static std::atomic<bool> flag{false};
    return flag;
  }
};

/// No guard ends its jobs.
struct HangingArchitecture : ramp::One<Hanging> {
  HangingArchitecture() { control.task().watchdog = 1h; }
};

TEST(Deployer, TakesAChangeBackWhenTheComponentNeverEndsItsJob) {
  Hanging::released() = false;
  HangingArchitecture architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([&] { return deployer.status("control").releases == 1; }));
  const auto names_its_time = [](const Error& error) {
    return error.message.find(" ms of the last ") != std::string::npos;
  };

  const Result<Receipt> refused =
      test::refused_for([&] { return deployer.swap_core<ramp::Down>("control"); }, names_its_time);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::timed_out);
  EXPECT_TRUE(names_its_time(refused.error()));
  EXPECT_EQ(deployer.generation(), 1u);
  Hanging::released() = true;
  EXPECT_TRUE(eventually([&] { return deployer.status("control").releases > 3; }));
  EXPECT_TRUE(eventually([&] { return deployer.swap_core<ramp::Down>("control").has_value(); }))
      << "the mailbox is free again";
}

/// Two that run: one never ends its job until it is released, the other is well.
struct HangingBeside : HangingArchitecture {
  SharedData<double> other_position{*this, "other_position"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> other{*this, "other"};
  Status on_configure() override {
    if (auto done = other.shell().out.connect(other_position.write_service()); !done) return done;
    return HangingArchitecture::on_configure();
  }
};

class HangingDeployer : public testing::Test {
 protected:
  void SetUp() override {
    Hanging::released() = false;
    ASSERT_TRUE(deployer.deploy());
    ASSERT_TRUE(eventually([&] { return deployer.status("control").releases == 1; }));
  }
  void TearDown() override { Hanging::released() = true; }

  HangingBeside architecture;
  Deployer deployer{architecture, {.realtime = Realtime::off}};
};

TEST_F(HangingDeployer, WritesSafeValuesForACoreThatHangsWhenItIsStopped) {
  const Result<Receipt> stopped = deployer.stop({"control", "other"});

  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, Errc::partly);
  EXPECT_EQ(stopped.error().at, "control");
  EXPECT_EQ(ramp::read(architecture.position), -1.0);
  EXPECT_EQ(deployer.status("other").state, ComponentState::stopped);
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
}

TEST_F(HangingDeployer, ParksACoreThatHungAsSoonAsItsJobEnds) {
  ASSERT_FALSE(deployer.stop({"control"}));
  const Result<Receipt> refused = deployer.swap_core<ramp::Down>("control");
  ASSERT_FALSE(refused) << "the order to park is in its mailbox";
  EXPECT_EQ(refused.error().code, Errc::conflict);

  Hanging::released() = true;

  EXPECT_TRUE(
      eventually([&] { return deployer.status("control").state == ComponentState::stopped; }));
  EXPECT_TRUE(eventually([&] { return deployer.swap_core<ramp::Down>("control").has_value(); }));
  EXPECT_TRUE(deployer.start({"control"}));
}

TEST_F(HangingDeployer, StopsTheOthersWhileAChangeWaitsForACoreThatHangs) {
  Result<PreparedChange> change = deployer.prepare({{ramp::to_core<ramp::Down>("ramp/down")}});
  ASSERT_TRUE(change);
  const std::shared_ptr<Ongoing> swapping = deployer.begin(*change);
  const std::shared_ptr<Ongoing> stopping = deployer.begin_stop_all();
  EXPECT_FALSE(swapping->advance());

  EXPECT_TRUE(eventually([&] {
    return !stopping->advance() && deployer.status("other").state == ComponentState::stopped;
  }));

  EXPECT_FALSE(swapping->advance()) << "the stop of the other did not wait for it";
  EXPECT_FALSE(deployer.wait(*swapping));
  const Result<Receipt> stopped = deployer.wait(*stopping);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, Errc::partly);
  EXPECT_EQ(stopped.error().at, "control");
}

TEST(Deployer, ReportsHowLateAJobIsThatDoesNotEnd) {
  Hanging::released() = false;
  HangingArchitecture architecture;
  architecture.control.fsm().period = 1ms;
  Deployer deployer(architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer.deploy());

  EXPECT_TRUE(eventually([&] { return deployer.status("control").late > 20ms; }));
  EXPECT_EQ(deployer.status("control").state, ComponentState::running);
  EXPECT_EQ(deployer.status("control").overruns, 0u) << "counted when the job has ended";

  Hanging::released() = true;
  EXPECT_TRUE(eventually([&] { return deployer.status("control").late == Duration{0}; }));
}

TEST(Deployer, ShutsDownInBoundedTimeAndWritesSafeValuesForACoreThatHangs) {
  Hanging::released() = false;
  // Never freed: a thread stays in them.
  static auto* const architecture = new HangingBeside;
  static auto* const deployer = new Deployer(*architecture, {.realtime = Realtime::off});
  ASSERT_TRUE(deployer->deploy());
  ASSERT_TRUE(eventually([&] { return deployer->status("control").releases == 1; }));

  const std::vector<std::string> abandoned_threads = deployer->shutdown(1ms);

  EXPECT_EQ(abandoned_threads, std::vector<std::string>{"control"}) << "the other one is well";
  EXPECT_EQ(ramp::read(architecture->position), -1.0);
}

TEST_F(HangingDeployer, IsNotAbandonedWhenItIsOnlyLateOnAnOrdinaryThread) {
  auto names =
      std::async(std::launch::async, [this] { return deployer.shutdown(1ms, test::kPatience); });
  EXPECT_TRUE(eventually([&] { return ramp::read(architecture.position) == -1.0; }));
  Hanging::released() = true;  // only when its safe value was written on its behalf
  EXPECT_TRUE(names.get().empty());
  EXPECT_EQ(deployer.status("control").state, ComponentState::stopped);
  EXPECT_EQ(ramp::read(architecture.position), -1.0);
}

}  // namespace
}  // namespace mauve
