// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rover on real threads: what the analysis proves is not exceeded by what happens.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include <mauve/architecture.h>
#include <mauve/deployer.h>

#include "arch/load.h"
#include "plugin/catalog.h"
#include "rt/thread.h"
#include "support/disturbance.h"
#include "support/test_data.h"

namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using mauve::ComponentTiming;
using mauve::Deployer;
using mauve::Duration;

constexpr Duration kWindow = 2s;
constexpr int kWindows = 10;
constexpr int kEnough = 2;

/// The rover for one window of time, watched by a probe on each CPU.
class Window {
 public:
  /// `declared` false: without its budgets, so that execution times are measured.
  Window(const std::string& file, bool declared) {
    const std::filesystem::path folder = std::filesystem::path(MAUVE_SOURCE_DIR) / "etc";
    std::filesystem::current_path(folder);  // where the paths in it begin
    mauve::arch::Problems problems;
    rover_ = mauve::arch::load(support::bytes_of(folder / file), catalog_, problems);
    for (mauve::ComponentBase* component : rover_->components()) {
      if (!declared) component->task().budget = Duration{0};
    }
    deployer_ = std::make_unique<Deployer>(
        *rover_, mauve::DeployOptions{.realtime = mauve::Realtime::require});
    EXPECT_TRUE(deployer_->deploy());
    for (const int cpu : mauve::rt::usable_cpus()) {
      probes_.push_back(std::make_unique<mauve::test::Probe>(cpu));
    }
    std::this_thread::sleep_for(kWindow);
  }

  [[nodiscard]] bool disturbed() const {
    for (const auto& probe : probes_) {
      if (probe->disturbances() > 0) return true;
    }
    return false;
  }
  /// Did the machine look fit for real time when it was measured?
  [[nodiscard]] bool bounded() const {
    for (const ComponentTiming& timing : deployer_->analyze().components) {
      if (!timing.response) return false;
    }
    return true;
  }
  /// The number of components that ended a job later than their bound.
  [[nodiscard]] int exceeded() const {
    int count = 0;
    for (const ComponentTiming& timing : deployer_->analyze().components) {
      const mauve::ComponentStatus status = deployer_->status(timing.name);
      // Of the latest start and the longest job, which need not be the same one.
      const Duration met = status.lateness_max + status.execution_max;
      EXPECT_GT(status.releases, 0U) << timing.name;
      std::printf("%-8s %-8s bound %7.1f us, met %7.1f us\n", timing.name.c_str(),
                  timing.source.c_str(), us(*timing.response), us(met));
      count += met > *timing.response ? 1 : 0;
    }
    return count;
  }

 private:
  static double us(Duration time) { return static_cast<double>(time.count()) / 1e3; }

  mauve::plugin::Catalog catalog_{{MAUVE_PLUGIN_DIR}};
  std::unique_ptr<mauve::Architecture> rover_;
  std::unique_ptr<Deployer> deployer_;
  std::vector<std::unique_ptr<mauve::test::Probe>> probes_;
};

void expect_bounds_to_hold(const std::string& file, bool declared) {
  if (!mauve::rt::may_use_fifo(99)) {
    GTEST_SKIP() << "NOT TESTED: no SCHED_FIFO here, so nothing is proved that could be exceeded";
  }
  int judged = 0;
  int unbounded = 0;
  for (int i = 0; i < kWindows && judged < kEnough; ++i) {
    const Window window(file, declared);
    if (!window.bounded()) {
      ++unbounded;
      continue;
    }
    const int exceeded = window.exceeded();
    if (exceeded > 0 && window.disturbed()) continue;
    ASSERT_EQ(exceeded, 0) << "and nothing disturbed the machine";
    ++judged;
  }
  ASSERT_LT(unbounded, kWindows) << "the rover never had bounds";
  if (judged < kEnough) GTEST_SKIP() << "NOT TESTED: the host disturbed nearly every window";
}

TEST(RoverOnThreads, EndsNoJobAfterItsBoundFromBudgets) {
  expect_bounds_to_hold("yard.json", true);
}

TEST(RoverOnThreads, EndsNoJobAfterItsBoundFromMeasuredTimes) {
  expect_bounds_to_hold("yard.json", false);
}

TEST(WholeRoverOnThreads, EndsNoJobAfterItsBoundFromBudgets) {
  expect_bounds_to_hold("rover.json", true);
}

TEST(WholeRoverOnThreads, EndsNoJobAfterItsBoundFromMeasuredTimes) {
  expect_bounds_to_hold("rover.json", false);
}

}  // namespace
