// SPDX-License-Identifier: LGPL-3.0-or-later
/// Ten minutes of the whole robot under load: it drives to and fro between the yard and the
/// building, its rules change the core at each door, and nothing misses a release.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "rt/thread.h"
#include "support/daemon_process.h"
#include "support/disturbance.h"

namespace {

using mauve::test::DaemonProcess;
using mauve::test::Load;
using mauve::test::Probe;

using Counts = std::map<std::string, std::int64_t>;

/// MAUVE_CAMPAIGN_SECONDS shortens it for a first look.
int seconds() {
  const char* said = std::getenv("MAUVE_CAMPAIGN_SECONDS");
  return said != nullptr ? std::atoi(said) : 600;
}

Counts missed(const DaemonProcess& rover) {
  Counts counts;
  const auto status = rover.ask({"status"});
  for (const auto& one : status["components"]) counts[one["name"]] = one["missed"];
  return counts;
}

std::uint64_t disturbances(const std::vector<std::unique_ptr<Probe>>& probes) {
  std::uint64_t sum = 0;
  for (const auto& probe : probes) sum += probe->disturbances();
  return sum;
}

/// Sends the robot on when it is where it should go.
class Errands {
 public:
  void look(const DaemonProcess& rover) {
    const auto reached = rover.value("navigation.core.goals_reached");
    if (!reached.is_number() || reached.get<int>() < done_ + 1) return;
    ++done_;
    const auto answer =
        rover.ask({"set", kGoals.at(static_cast<std::size_t>(done_) % 2), "--probation", "off"});
    EXPECT_EQ(answer.value("state", ""), "applied") << answer;
  }
  [[nodiscard]] int done() const { return done_; }

 private:
  static constexpr std::array<const char*, 2> kGoals{R"(mission.core.goal={"x":16.6,"y":7.9})",
                                                     R"(mission.core.goal={"x":1.0,"y":0.0})"};
  int done_ = 0;
};

TEST(RoverCampaign, MissesNoReleaseInTenMinutesUnderLoad) {
  if (!mauve::rt::may_use_fifo(99)) GTEST_SKIP() << "NOT TESTED: no SCHED_FIFO here";
  const Load load;
  DaemonProcess rover(std::filesystem::path(MAUVE_SOURCE_DIR) / "etc" / "rover.json",
                      {"--realtime", "require", "--admission", "strict"});
  ASSERT_TRUE(rover.up()) << rover.errors();
  std::vector<std::unique_ptr<Probe>> probes;
  for (const int cpu : mauve::rt::usable_cpus()) probes.push_back(std::make_unique<Probe>(cpu));

  Errands errands;
  Counts lost_alone;      // while the machine ran
  Counts lost_with_host;  // while it stood still
  int disturbed = 0;
  Counts before = missed(rover);
  for (int window = 0; window < seconds(); ++window) {
    const std::uint64_t quiet = disturbances(probes);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    errands.look(rover);
    Counts now = missed(rover);
    const bool stood_still = disturbances(probes) > quiet;
    disturbed += stood_still ? 1 : 0;
    for (const auto& [name, count] : now) {
      (stood_still ? lost_with_host : lost_alone)[name] += count - before[name];
    }
    before = std::move(now);
  }

  std::printf("%d windows of a second, %d disturbed by the host; %d errands\n", seconds(),
              disturbed, errands.done());
  for (const auto& [name, count] : lost_with_host) {
    if (count > 0) std::printf("%-10s %3ld lost in disturbed windows\n", name.c_str(), count);
  }
  for (const auto& [name, count] : lost_alone) EXPECT_EQ(count, 0) << name;
  EXPECT_GE(errands.done(), seconds() / 120);
  EXPECT_GT(rover.value("world.core.nearest").get<double>(), 0.0);
  if (disturbed * 2 > seconds()) GTEST_SKIP() << "NOT TESTED: the host disturbed half of it";
}

}  // namespace
