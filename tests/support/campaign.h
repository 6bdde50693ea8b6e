// SPDX-License-Identifier: LGPL-3.0-or-later
/// Campaigns: the same operation is done very often under load, and not one release is missed.
/// Releases that are missed while the machine itself stood still are counted apart. A run in which
/// the machine stood still too often is repeated.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "support/disturbance.h"

namespace mauve::test {

/// The counts of one run of a campaign.
struct Tally {
  std::uint64_t missed = 0;            ///< releases, while nothing disturbed the machine
  std::uint64_t missed_disturbed = 0;  ///< while the probe was late itself
  std::uint64_t disturbances = 0;      ///< how often it was
};

/// Load on all CPUs, and a probe on each, for one run.
class UnderLoad {
 public:
  /// `missed`: how many releases were missed so far.
  UnderLoad(Tally& tally, std::function<std::uint64_t()> missed)
      : tally_(tally), missed_(std::move(missed)) {
    for (const int cpu : rt::usable_cpus()) probes_.push_back(std::make_unique<Probe>(cpu));
    load_ = std::make_unique<Load>();
    missed_before_ = missed_();
  }

  /// The releases missed since the last call belong to one window: disturbed, or not.
  void close_window() {
    const std::uint64_t missed_now = missed_();
    const std::uint64_t missed = missed_now - std::exchange(missed_before_, missed_now);
    const std::uint64_t disturbed_now = disturbances();
    // The probe may report the same disturbance a moment later.
    if (missed > 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    tally_.disturbances = disturbances();
    const bool disturbed = tally_.disturbances != std::exchange(disturbed_before_, disturbed_now);
    (disturbed ? tally_.missed_disturbed : tally_.missed) += missed;
  }

 private:
  [[nodiscard]] std::uint64_t disturbances() const {
    std::uint64_t all = 0;
    for (const auto& probe : probes_) all += probe->disturbances();
    return all;
  }

  Tally& tally_;
  std::function<std::uint64_t()> missed_;
  std::vector<std::unique_ptr<Probe>> probes_;
  std::unique_ptr<Load> load_;
  std::uint64_t missed_before_ = 0;
  std::uint64_t disturbed_before_ = 0;
};

/// A host that held the probe up so often in one run holds others up unseen as well.
inline constexpr std::uint64_t kTooOften = 10;
inline constexpr int kRuns = 3;

enum class Verdict : std::uint8_t { passed, failed, disturbed };

/// Runs it until it can be judged, three times at most. One run without a miss is enough; so is a
/// miss that no disturbance explains, or a failure of any other kind.
inline Verdict judge(const std::function<void(Tally&)>& run) {
  for (int i = 1; i <= kRuns; ++i) {
    Tally tally;
    run(tally);
    if (testing::Test::HasFailure()) return Verdict::failed;
    std::printf("missed %llu, in disturbed windows %llu (probe late %llu times)\n",
                static_cast<unsigned long long>(tally.missed),
                static_cast<unsigned long long>(tally.missed_disturbed),
                static_cast<unsigned long long>(tally.disturbances));
    if (tally.missed == 0) return Verdict::passed;
    if (tally.disturbances < kTooOften) return Verdict::failed;
    std::printf("the host held up the probe too often to judge run %d of %d\n", i, kRuns);
  }
  return Verdict::disturbed;
}

/// The last thing of a test.
inline void campaign(const std::function<void(Tally&)>& run) {
  const Verdict verdict = judge(run);
  if (verdict == Verdict::disturbed) {
    GTEST_SKIP() << "the host held up the probe too often in each of " << kRuns
                 << " runs: use a quiet machine";
  }
  if (verdict == Verdict::failed && !testing::Test::HasFailure()) {
    ADD_FAILURE() << "a release was missed, and the machine was not disturbed";
  }
}

}  // namespace mauve::test
