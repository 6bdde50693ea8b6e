// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rover in a real daemon: no job ends after the bound that the analysis found for it. The
/// judge is check-trace. It leaves out the responses that a standstill of the machine explains,
/// and needs a machine that nothing else disturbs.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>

#include "rt/thread/thread.h"
#include "support/daemon_process.h"
#include "support/foreign_realtime.h"

namespace {

using mauve::test::DaemonProcess;
using mauve::test::eventually;
using mauve::test::foreign_realtime;
using mauve::test::TempDir;
using nlohmann::json;

constexpr int kOfEach = 5;        // responses to be judged of every component; one has 1 in 2 s
constexpr int kTogether = 2'000;  // of all of them
constexpr std::chrono::seconds kWithin{60};  // it takes 12
/// The machine may look unfit just when it is measured; then there is no bound.
constexpr int kTries = 3;

const std::filesystem::path kFolder = std::filesystem::path(MAUVE_SOURCE_DIR) / "etc";

bool judged_enough(const json& verdict, std::size_t components) {
  const json& responses = verdict["checked"]["responses_of"];
  const bool each = std::all_of(responses.begin(), responses.end(),
                                [](const json& count) { return count >= kOfEach; });
  return responses.size() == components && each && verdict["checked"]["responses"] >= kTogether;
}

/// The verdict of check-trace as soon as it had judged enough, or found a violation.
struct Judgement {
  json verdict;
  bool enough = false;
  std::string foreign;         ///< who else ran under SCHED_FIFO meanwhile
  std::filesystem::path kept;  ///< the trace of a violation

  [[nodiscard]] bool violated() const { return enough && !verdict["holds"].get<bool>(); }
};

Judgement judge(const std::filesystem::path& architecture) {
  DaemonProcess rover(architecture, {"--realtime", "require"});
  EXPECT_TRUE(rover.up()) << rover.errors();
  const TempDir place;
  const std::string file = (place / "rover.mtrace").string();
  const std::size_t components = rover.ask({"status"})["components"].size();
  EXPECT_TRUE(rover.ask({"trace", "start", "--for", "60s"}).value("on", false)) << rover.errors();
  Judgement found;
  const auto look = [&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));  // what will be judged
    if (found.foreign.empty()) found.foreign = foreign_realtime(rover.process().id());
    if (!rover.ask({"trace", "dump", "-o", file}).contains("records")) return false;
    found.verdict = rover.ask({"check-trace", file});
    return !found.verdict["holds"].get<bool>() || judged_enough(found.verdict, components);
  };
  found.enough = eventually(look, kWithin);
  if (found.violated()) {
    found.kept = std::filesystem::path(testing::TempDir()) / "beyond-its-bound.mtrace";
    std::filesystem::copy_file(file, found.kept, std::filesystem::copy_options::overwrite_existing);
  }
  if (found.violated() && !found.foreign.empty())
    rover.process().signal(SIGKILL);  // proves nothing
  return found;
}

void expect_bounds_to_hold(const std::filesystem::path& architecture) {
  if (!mauve::rt::may_use_fifo(99)) {
    GTEST_SKIP() << "NOT TESTED: no SCHED_FIFO here, so nothing is proved that could be exceeded";
  }
  Judgement last;
  for (int i = 0; i < kTries; ++i) {
    last = judge(architecture);
    if (last.enough && (!last.violated() || last.foreign.empty())) break;
    static_cast<void>(eventually([] { return foreign_realtime(0).empty(); }, kWithin));
  }
  if (!last.foreign.empty() && (last.violated() || !last.enough)) {
    GTEST_SKIP() << "NOT TESTED: another program has real-time threads, " << last.foreign;
  }
  ASSERT_TRUE(last.enough) << "too few responses were judged: " << last.verdict;
  EXPECT_FALSE(last.violated()) << last.verdict << "; the trace: " << last.kept;
  std::printf("judged: %s\nnot judged: %s\n",
              last.verdict["checked"]["responses_of"].dump().c_str(),
              last.verdict["not_checked"].dump().c_str());
}

TEST(RoverOnThreads, EndsNoJobAfterItsBoundFromBudgets) {
  expect_bounds_to_hold(kFolder / "yard.json");
}

TEST(WholeRoverOnThreads, EndsNoJobAfterItsBoundFromBudgets) {
  expect_bounds_to_hold(kFolder / "rover.json");
}

}  // namespace
