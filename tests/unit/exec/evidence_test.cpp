// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace mauve::exec {
namespace {

using Verdict = Evidence::Verdict;

constexpr JobTiming kSound{};
constexpr JobTiming kOverBudget{.over_budget = true};
constexpr JobTiming kTwiceOver{.over_budget = true, .twice_over = true};
constexpr JobTiming kTooLong{.late = true, .too_long = true};
constexpr JobTiming kHeldUp{.late = true};
constexpr int kMany = 100'000;

class EvidenceTest : public testing::Test {
 protected:
  Verdict weigh(const JobTiming& job) { return evidence.weigh(job, rules); }
  /// After how many jobs like these, in turn, there is a verdict; kMany: not within so many.
  int jobs_until(Verdict verdict, const std::vector<JobTiming>& jobs) {
    for (int i = 0; i < kMany; ++i) {
      const Verdict found = weigh(jobs[static_cast<std::size_t>(i) % jobs.size()]);
      if (found == verdict) return i + 1;
      EXPECT_EQ(found, Verdict::none);
    }
    return kMany;
  }
  /// In how many of 100 probations of 3000 jobs a core is blamed whose jobs exceed the budget by
  /// chance.
  static int blamed_of_100(double share, const JobTiming& excess = kOverBudget) {
    std::mt19937 random(19);
    std::bernoulli_distribution exceeds(share);
    int blamed = 0;
    for (int i = 0; i < 100; ++i) {
      Evidence fresh;
      bool found = false;
      for (int job = 0; job < 3000 && !found; ++job) {
        found = fresh.weigh(exceeds(random) ? excess : kSound, {}) != Verdict::none;
      }
      blamed += found ? 1 : 0;
    }
    return blamed;
  }

  Evidence evidence;
  Evidence::Rules rules;
};

TEST_F(EvidenceTest, DetectsACoreThatAlwaysExceedsItsBudgetAtTheSixteenthJob) {
  EXPECT_EQ(jobs_until(Verdict::over_budget, {kOverBudget}), 16);
}

TEST_F(EvidenceTest, DetectsACoreThatExceedsItsBudgetInEverySecondJob) {
  EXPECT_LE(jobs_until(Verdict::over_budget, {kSound, kOverBudget}), 64);
}

TEST_F(EvidenceTest, IgnoresASmallExcessInEveryThirdJob) {
  EXPECT_EQ(jobs_until(Verdict::over_budget, {kOverBudget, kSound, kSound}), kMany);
}

TEST_F(EvidenceTest, DetectsACoreThatUsesTwoBudgetsInEveryThirdJob) {
  EXPECT_LE(jobs_until(Verdict::over_budget, {kTwiceOver, kSound, kSound}), 450);
}

TEST_F(EvidenceTest, ExcusesAHostThatTakesMuchTimeFromManyJobsWithinASecond) {
  std::vector<JobTiming> jobs(150, kSound);
  std::fill_n(jobs.begin(), 15, kTwiceOver);
  EXPECT_EQ(jobs_until(Verdict::over_budget, jobs), kMany);
}

TEST_F(EvidenceTest,
       BlamesNoCoreForAHostThatHitsOneJobInFiveAndDetectsOneThatIsTooSlowHalfTheTime) {
  EXPECT_EQ(blamed_of_100(0.1), 0);
  EXPECT_LE(blamed_of_100(0.2), 1);
  EXPECT_EQ(blamed_of_100(0.5), 100);
  EXPECT_LE(blamed_of_100(0.2, kTwiceOver), 1);
  EXPECT_EQ(blamed_of_100(0.4, kTwiceOver), 100);
}

TEST_F(EvidenceTest, NeedsASecondLateJobWhateverIsTolerated) {
  rules = {.tolerated = 0};
  EXPECT_EQ(jobs_until(Verdict::overruns, {kTooLong}), 2);
}

TEST_F(EvidenceTest, ToleratesSoManyLateJobsOfTheWindow) {
  rules = {.tolerated = 2, .window = 0b1111};
  EXPECT_EQ(jobs_until(Verdict::overruns, {kTooLong, kSound}), kMany);
  EXPECT_EQ(jobs_until(Verdict::overruns, {kTooLong}), 2) << "three of the last four";
}

TEST_F(EvidenceTest, RemembersLateJobsForTheWholeWindow) {
  rules = {.tolerated = 2};  // of 64 jobs
  std::vector<JobTiming> jobs(32, kSound);
  jobs[0] = kTooLong;
  EXPECT_EQ(jobs_until(Verdict::overruns, jobs), kMany) << "the third would be the 65th";

  evidence.begin_anew(false);
  jobs.pop_back();
  EXPECT_EQ(jobs_until(Verdict::overruns, jobs), 63);
}

TEST_F(EvidenceTest, ExcusesOneOfEightJobsThatOthersHeldUp) {
  std::vector<JobTiming> jobs(8, kSound);
  jobs[0] = kHeldUp;
  EXPECT_EQ(jobs_until(Verdict::overruns, jobs), kMany);
  EXPECT_EQ(jobs_until(Verdict::overruns, {kHeldUp}), 4) << "the eleventh of 64";
}

TEST_F(EvidenceTest, DoesNotCallACoreStarvedThatWasLateAsOftenBeforeTheChange) {
  const auto one_of_five = [](const auto& job) {
    for (int i = 0; i < 320; ++i) job(i % 5 == 0);
  };
  one_of_five([this](bool late) { evidence.note(late); });
  evidence.begin_anew(true);

  one_of_five([this](bool late) { ASSERT_EQ(weigh(late ? kHeldUp : kSound), Verdict::none); });

  evidence.begin_anew(false);
  EXPECT_LE(jobs_until(Verdict::overruns, {kHeldUp}), 64) << "more often than before";
}

TEST_F(EvidenceTest, IsSuspiciousUntilSoundJobsSpeakForTheCore) {
  EXPECT_FALSE(evidence.suspicious(rules));
  static_cast<void>(weigh(kOverBudget));
  EXPECT_TRUE(evidence.suspicious(rules));
  static_cast<void>(weigh(kSound));
  static_cast<void>(weigh(kSound));
  EXPECT_FALSE(evidence.suspicious(rules));
}

}  // namespace
}  // namespace mauve::exec
