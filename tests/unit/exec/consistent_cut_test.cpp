// SPDX-License-Identifier: LGPL-3.0-or-later
/// The consistent cut on real threads: which job ran with which core is stamped, and checked
/// against the commit instants of the receipts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/stampers.h"

namespace mauve {
namespace {

constexpr int kTransactions = 60;

TEST(ConsistentCut, JobsBeforeTheInstantAreOldAndAllOthersNew) {
  stampers::clear_logs();
  stampers::Architecture architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off, .admission = Admission::off});
  ASSERT_TRUE(deployer.deploy());
  std::vector<Instant> commits;  // by version, from 1
  int revoked = 0;
  for (int i = 0; i < kTransactions; ++i) {
    const Result<Receipt> done =
        deployer.apply(stampers::to_version(static_cast<int>(commits.size()) + 1));
    // On a machine that is overloaded every attempt may miss its instant; then nothing changed.
    if (done) commits.push_back(deployer.t0() + done->commit.count());
    if (!done) ++revoked;
    if (!done && done.error().code == Errc::partly) break;  // a member did not run for seconds
  }
  static_cast<void>(deployer.shutdown());

  const stampers::Cut cut = stampers::check(commits);
  EXPECT_THAT(cut.violations, testing::IsEmpty());
  EXPECT_GT(commits.size(), 0u) << revoked << " were revoked";
  EXPECT_GT(cut.jobs, stampers::kCount);
}

TEST(ConsistentCut, IsViolatedByOneJobOnTheWrongSideOfAnInstant) {
  stampers::clear_logs();
  stampers::logs()[0].note(10, 0);
  stampers::logs()[0].note(20, 1);
  EXPECT_THAT(stampers::check({11}).violations, testing::IsEmpty());
  EXPECT_THAT(stampers::check({10}).violations, testing::SizeIs(1)) << "old at the instant";
  EXPECT_THAT(stampers::check({21}).violations, testing::SizeIs(1)) << "new before it";
  stampers::logs()[0].note(30, 0);
  EXPECT_THAT(stampers::check({11}).violations, testing::SizeIs(1)) << "old again after it";
}

}  // namespace
}  // namespace mauve
