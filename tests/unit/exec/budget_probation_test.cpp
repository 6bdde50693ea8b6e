// SPDX-License-Identifier: LGPL-3.0-or-later
/// Probation of a core that uses more processor time than its budget.
#include <gmock/gmock.h>

#include "support/under_probation.h"

namespace mauve {
namespace {

using test::UnderProbation;

/// The clock of the test, which a job moves by the time that it takes.
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

class WithABudget : public UnderProbation {
 protected:
  void SetUp() override {
    architecture.control.task().budget = 300us;
    UnderProbation::SetUp();
    moved() = const_cast<ManualClock*>(dynamic_cast<const ManualClock*>(&deployer.clock()));
  }
};

TEST_F(WithABudget, ACoreThatTakesLongerThanItsBudgetIsRolledBackAfterSixteenJobs) {
  const std::string before = core();
  const std::uint64_t jobs = deployer.status("control").over_budget;
  ASSERT_TRUE(swap_to<Costly>());

  rolled_back_after(300ms, before,
                    "took longer than its budget: in too many jobs, the last one 350 us of 300 us");

  EXPECT_EQ(deployer.status("control").over_budget - jobs, 16U);
}

/// Takes that long in each third job.
template <int kMicroseconds>
struct Uneven : ramp::Down {
  void update() override {
    ramp::Down::update();
    if (++jobs_ % 3 == 0) moved()->advance(std::chrono::microseconds(kMicroseconds));
  }

 private:
  int jobs_ = 0;
};

TEST_F(WithABudget, AProbationThatPassesSaysHowManyJobsExceededIt) {
  ASSERT_TRUE(swap_to<Uneven<350>>({.activations = 20}));

  std::vector<Outcome> ends;
  for (int job = 0; job < 100 && ends.empty(); ++job) {
    deployer.run_for(10ms);
    ends = tend();
  }

  ASSERT_EQ(ends.size(), 1U);
  EXPECT_EQ(ends[0].kind, Outcome::Kind::passed);
  EXPECT_THAT(ends[0].reason,
              testing::MatchesRegex("20 jobs without a fault; [0-9]+ jobs of control "
                                    "used more processor time than its budget"));
}

TEST_F(WithABudget, ACoreThatUsesTwoBudgetsInEachThirdJobIsRolledBack) {
  const std::string before = core();
  ASSERT_TRUE(swap_to<Uneven<650>>({.time = 60s}));

  const Outcome end = end_after(10s);
  EXPECT_EQ(end.kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(core(), before);
}

TEST_F(WithABudget, ItDoesNotEndBeforeACoreUnderSuspicionIsJudged) {
  const std::string before = core();
  ASSERT_TRUE(swap_to<Costly>({.activations = 2, .time = 20ms}));
  deployer.run_for(50ms);
  EXPECT_TRUE(tend().empty()) << "five jobs are not enough";

  EXPECT_EQ(end_after(200ms).kind, Outcome::Kind::rolled_back);
  EXPECT_EQ(core(), before);
}

}  // namespace
}  // namespace mauve
