// SPDX-License-Identifier: LGPL-3.0-or-later
/// Measurements that contradict the response time analysis, on a clock that is moved by hand.
#include <gtest/gtest.h>

#include <thread>

#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve {
namespace {

ManualClock*& moved() {
  static ManualClock* clock = nullptr;
  return clock;
}

/// Takes 350 us in every job.
struct Costly : ramp::Down {
  void update() override {
    ramp::Down::update();
    moved()->advance(350us);
  }
};

class Contradictions : public testing::Test {
 protected:
  void SetUp() override {
    architecture.control.task().budget = 300us;
    ASSERT_TRUE(deployer.deploy());
    moved() = const_cast<ManualClock*>(dynamic_cast<const ManualClock*>(&deployer.clock()));
    deployer.run_for(95ms);
  }
  std::vector<std::string> found() { return deployer.analyze().contradictions; }

  ramp::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(Contradictions, AreNoneWhileJobsKeepTheirBudgets) { EXPECT_TRUE(found().empty()); }

TEST_F(Contradictions, NameAJobThatTakesLongerThanItsBudgetUntilAnotherCoreRuns) {
  ASSERT_TRUE(deployer.apply({{ramp::to_core<Costly>("Costly")}}));
  deployer.run_for(100ms);

  const std::string jobs = std::to_string(deployer.statistics("control").over_budget);
  EXPECT_EQ(found(), std::vector<std::string>{
                         "control used up to 350us of processor time, its budget is 300us (" +
                         jobs + " jobs over it); the proof below assumes 300us"});

  ASSERT_TRUE(deployer.apply({{ramp::to_core<ramp::Down>("Down")}}));
  deployer.run_for(100ms);
  EXPECT_TRUE(found().empty()) << "the core that runs keeps its budget";
}

TEST_F(Contradictions, NameMissedReleases) {
  moved()->advance(50ms);
  deployer.run_for(50ms);

  const std::uint64_t missed = deployer.statistics("control").missed;
  ASSERT_GT(missed, 1U);
  EXPECT_EQ(found(),
            std::vector<std::string>{"control missed " + std::to_string(missed) + " releases"});
}

/// `why` compares these jobs with the budget and the longest job of the present core.
TEST_F(Contradictions, CountJobsOverTheBudgetAnewWithAnotherBudgetOrCore) {
  const auto over = [&] { return deployer.status("control").over_present_budget; };
  const auto set_budget = [&](Duration budget) {
    Edit edit;
    edit.member = "control";
    edit.task = architecture.control.bundle()->task;
    edit.task->budget = budget;
    ASSERT_TRUE(deployer.apply(Change{{edit}}));
    deployer.run_for(100ms);
  };
  ASSERT_TRUE(deployer.apply({{ramp::to_core<Costly>("Costly")}}));
  deployer.run_for(100ms);
  EXPECT_GT(over(), 0U);

  set_budget(400us);
  EXPECT_EQ(over(), 0U) << "jobs of 350 us";
  EXPECT_GT(deployer.status("control").over_budget, 0U);

  set_budget(200us);
  EXPECT_GT(over(), 0U);
  ASSERT_TRUE(deployer.apply({{ramp::to_core<ramp::Down>("Down")}}));
  deployer.run_for(100ms);
  EXPECT_EQ(over(), 0U);
}

/// `show` has both beside each other.
TEST_F(Contradictions, AreNoneBetweenTheLastAndTheLongestJobOfAnotherCore) {
  ASSERT_TRUE(deployer.apply({{ramp::to_core<Costly>("Costly")}}));
  deployer.run_for(100ms);
  ASSERT_EQ(deployer.status("control").elapsed_last, 350us);

  ASSERT_TRUE(deployer.apply({{ramp::to_core<ramp::Down>("Down")}}));

  EXPECT_EQ(deployer.status("control").elapsed_max, 0us);
  EXPECT_EQ(deployer.status("control").elapsed_last, 0us);
}

/// Its jobs last longer than its budget, and use next to nothing of a processor.
struct Sleepy : ramp::Down {
  void update() override {
    ramp::Down::update();
    std::this_thread::sleep_for(50ms);
  }
};

TEST(BudgetOnThreads, IsOfProcessorTimeAndNotOfTheTimeThatAJobLasts) {
  ramp::Architecture architecture;
  architecture.control.task().budget = 25ms;
  architecture.control.task().watchdog = 1h;
  Deployer deployer{architecture, {.realtime = Realtime::off}};
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.apply({{ramp::to_core<Sleepy>("Sleepy")}}));

  EXPECT_TRUE(test::eventually([&] { return deployer.status("control").elapsed_max >= 50ms; }));

  EXPECT_EQ(deployer.status("control").over_present_budget, 0U);
  static_cast<void>(deployer.shutdown(test::kPatience, test::kPatience));
}

}  // namespace
}  // namespace mauve
