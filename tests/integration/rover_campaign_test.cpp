// SPDX-License-Identifier: LGPL-3.0-or-later
/// Ten minutes of the whole robot under load. It drives to and fro between the yard and the
/// building, and its rules change the core at each door. Only the machine itself costs releases.
/// The test proves that from the trace, which it reads in slices while the robot runs.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <thread>

#include "mtrace/file.h"
#include "rt/thread/thread.h"
#include "support/daemon_process.h"
#include "support/disturbance.h"
#include "support/foreign_realtime.h"
#include "support/lost_releases.h"

namespace {

using mauve::test::DaemonProcess;
using mauve::test::Load;
using mauve::test::LossWitness;
using mauve::test::TempDir;

using std::chrono::steady_clock;

constexpr std::chrono::seconds kSlice{4};
constexpr const char* kKept = "10s";  // more than a slice, less than the memory holds

/// MAUVE_CAMPAIGN_SECONDS shortens it for a first look.
int seconds() {
  const char* said = std::getenv("MAUVE_CAMPAIGN_SECONDS");
  return said != nullptr ? std::atoi(said) : 600;
}

/// Releases lost by each component.
struct Losses {
  LossWitness witness;
  std::map<std::string, std::int64_t> alone;         ///< while the machine ran
  std::map<std::string, std::int64_t> with_machine;  ///< while it stood still
};

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

/// The trace so far into the losses; how many responses were within their bounds.
std::uint64_t look_at_slice(const DaemonProcess& rover, const std::string& file, Losses& losses) {
  const auto dumped = rover.ask({"trace", "dump", "-o", file});
  EXPECT_TRUE(dumped.contains("records")) << dumped;
  const auto slice = mauve::ctl::mtrace::read_file(file);
  EXPECT_TRUE(slice);
  if (!slice) return 0;
  for (const auto& lost : losses.witness.look(*slice)) {
    (lost.disturbed ? losses.with_machine : losses.alone)[lost.component] += lost.count;
  }
  const auto verdict = mauve::ctl::mtrace::check(*slice);
  EXPECT_EQ(slice->header.lost, 0U) << "and with them their facts";
  EXPECT_TRUE(verdict.holds()) << verdict.found << ", the first: " << verdict.first->message;
  return verdict.checked.responses;
}

TEST(RoverCampaign, MissesNoReleaseInTenMinutesUnderLoad) {
  if (!mauve::rt::may_use_fifo(99)) GTEST_SKIP() << "NOT TESTED: no SCHED_FIFO here";
  const Load load;
  DaemonProcess rover(std::filesystem::path(MAUVE_SOURCE_DIR) / "etc" / "rover.json",
                      {"--realtime", "require", "--admission", "strict"});
  ASSERT_TRUE(rover.up()) << rover.errors();
  ASSERT_TRUE(rover.ask({"trace", "start", "--for", kKept}).value("on", false)) << rover.errors();

  const TempDir place;
  Errands errands;
  Losses losses;
  std::string foreign;
  std::uint64_t judged = 0;
  const auto begin = steady_clock::now();
  for (auto next = begin; next < begin + std::chrono::seconds(seconds());) {
    next += kSlice;
    while (steady_clock::now() < next) {
      std::this_thread::sleep_for(std::chrono::seconds(1));
      errands.look(rover);
      if (foreign.empty()) foreign = mauve::test::foreign_realtime(rover.process().id());
    }
    judged += look_at_slice(rover, place / "slice.mtrace", losses);
  }

  std::printf("%d errands, %lu responses judged\n", errands.done(), judged);
  for (const auto& [name, count] : losses.with_machine) {
    std::printf("%-10s %3ld lost while the machine stood still\n", name.c_str(), count);
  }
  for (const auto& [name, count] : losses.alone) {
    ADD_FAILURE() << name << " lost " << count << "; beside it ran "
                  << (foreign.empty() ? "no other real-time program" : foreign);
  }
  EXPECT_EQ(losses.witness.gaps(), 0) << "slices that do not meet";
  EXPECT_GT(judged, 100U * static_cast<unsigned>(seconds()));
  EXPECT_GE(errands.done(), seconds() / 120);
  EXPECT_GT(rover.value("world.core.nearest").get<double>(), 0.0);
}

}  // namespace
