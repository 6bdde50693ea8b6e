// SPDX-License-Identifier: LGPL-3.0-or-later
/// 1000 transactions over 20 components under CPU load: not one release missed, and each of them a
/// consistent cut.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "support/campaign.h"
#include "support/eventually.h"
#include "support/stampers.h"

namespace mauve {
namespace {

constexpr int kTransactions = 1000;

std::uint64_t missed_by_all(const Deployer& deployer) {
  std::uint64_t missed = 0;
  for (const ComponentStatus& component : deployer.status()) missed += component.missed;
  return missed;
}

void change_all(test::Tally& tally) {
  stampers::clear_logs();
  stampers::Architecture architecture(80);
  Deployer deployer(architecture, {.realtime = Realtime::require, .admission = Admission::off});
  ASSERT_TRUE(deployer.deploy());
  test::UnderLoad load(tally, [&] { return missed_by_all(deployer); });
  std::vector<Instant> commits;  // by version, from 1
  std::uint64_t attempts = 0;
  for (int version = 1; version <= kTransactions; ++version) {
    const Result<Receipt> done = deployer.apply(stampers::to_version(version));
    ASSERT_TRUE(done) << to_string(done.error());
    attempts += done->attempts;
    commits.push_back(deployer.t0() + done->commit.count());
    ASSERT_TRUE(test::eventually([&] { return stampers::all_ran(version); }));
    deployer.drain([](const RuntimeEvent&) {});
    load.close_window();
  }
  static_cast<void>(deployer.shutdown());
  const stampers::Cut cut = stampers::check(commits);
  std::printf("%d transactions, %llu attempts, %zu jobs, %zu violations\n", kTransactions,
              static_cast<unsigned long long>(attempts), cut.jobs, cut.violations.size());
  EXPECT_THAT(cut.violations, testing::IsEmpty());
  EXPECT_GE(cut.jobs, stampers::kCount * kTransactions);
}

TEST(TransactionCampaign, LosesNoReleaseAndCutsConsistentlyIn1000TransactionsUnderLoad) {
  if (!rt::may_use_fifo(99)) GTEST_SKIP() << "needs SCHED_FIFO: run as root or grant CAP_SYS_NICE";
  test::campaign(change_all);
}

}  // namespace
}  // namespace mauve
