// SPDX-License-Identifier: LGPL-3.0-or-later
/// 10,000 core swaps on a 1 kHz component under CPU load, and not one release missed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <thread>
#include <vector>

#include "support/campaign.h"
#include "support/ramp.h"

namespace mauve {
namespace {

constexpr int kSwaps = 10'000;

void report(std::uint64_t attempts, std::uint64_t releases, std::vector<std::int64_t> pauses) {
  std::sort(pauses.begin(), pauses.end());
  std::printf(
      "%d swaps, %llu attempts, releases %llu, pause p50 %lld ns, p99 %lld ns, max %lld ns\n",
      kSwaps, static_cast<unsigned long long>(attempts), static_cast<unsigned long long>(releases),
      static_cast<long long>(pauses[kSwaps / 2]), static_cast<long long>(pauses[kSwaps * 99 / 100]),
      static_cast<long long>(pauses.back()));
}

void swap_to_and_fro(test::Tally& tally) {
  ramp::Architecture architecture;
  architecture.control.fsm().period = 1ms;
  architecture.control.task().priority = 80;
  Deployer deployer(architecture, {.realtime = Realtime::require});
  ASSERT_TRUE(deployer.deploy());
  test::UnderLoad load(tally, [&] { return deployer.status("control").missed; });
  std::uint64_t attempts = 0;
  std::vector<std::int64_t> pauses;
  for (int i = 0; i < kSwaps; ++i) {
    const Result<Receipt> done = i % 2 == 0 ? deployer.swap_core<ramp::Down>("control")
                                            : deployer.swap_core<ramp::Up>("control");
    ASSERT_TRUE(done) << to_string(done.error());
    attempts += done->attempts;
    pauses.push_back(done->components[0].pause.count());
    deployer.drain([](const RuntimeEvent&) {});
    // The new core runs at least one job before the next swap.
    const std::uint64_t releases = deployer.status("control").releases;
    while (deployer.status("control").releases == releases) std::this_thread::sleep_for(50us);
    load.close_window();
  }
  ASSERT_TRUE(deployer.stop({"control"}));
  const ComponentStatus control = deployer.status("control");
  report(attempts, control.releases, std::move(pauses));
  EXPECT_EQ(control.releases + control.missed,
            static_cast<std::uint64_t>(control.next_release.count() / 1'000'000))
      << "no release was lost from the logical clock";
}

TEST(SwapCampaign, LosesNoReleaseIn10000SwapsUnderLoad) {
  if (!rt::may_use_fifo(99)) GTEST_SKIP() << "needs SCHED_FIFO: run as root or grant CAP_SYS_NICE";
  test::campaign(swap_to_and_fro);
}

}  // namespace
}  // namespace mauve
