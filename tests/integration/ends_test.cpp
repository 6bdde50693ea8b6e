// SPDX-License-Identifier: LGPL-3.0-or-later
// No end leaves an output live: a base that is ordered to drive, and every way in which the
// component that orders it, or mauved as a whole, may end. The bytes on its line are looked at from
// outside. MAUVE_ENDS: how often each (1). MAUVE_END: only that of this name. With
// MAUVE_ENDS_LOAD=1 beside ordinary threads that want every CPU.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "rt/thread/run_guarded.h"
#include "rt/thread/thread.h"
#include "support/daemon_process.h"
#include "support/disturbance.h"
#include "support/fake_base.h"
#include "support/guarded.h"
#include "support/memory_group.h"
#include "support/raw_client.h"

#include <mauve/host/clock.h>

namespace mauve::test {
namespace {

using Json = nlohmann::json;

struct End {
  const char* name;
  int signal;  // 0: the component ends in the way of this name
};

constexpr const char* kOutOfMemory = "out of memory";

constexpr const char* kForeign = "foreign thread";
constexpr const char* kStop = "mauvectl stop";
constexpr const char* kStopAsked = "stop on a socket";
constexpr const char* kStopAll = "mauvectl stop --all";
constexpr const char* kStopSource = "stop of its source";
constexpr const char* kGuardianStops = "SIGSTOP of guardian";

constexpr std::array<End, 32> kEnds{{
    {"SIGKILL", SIGKILL}, {"SIGSTOP", SIGSTOP}, {"SIGQUIT", SIGQUIT}, {"SIGUSR1", SIGUSR1},
    {"SIGALRM", SIGALRM}, {"SIGXCPU", SIGXCPU}, {"SIGSEGV", SIGSEGV}, {"SIGABRT", SIGABRT},
    {"SIGTERM", SIGTERM}, {"throw", 0},         {"write nowhere", 0}, {"full stack", 0},
    {"abort", 0},         {"terminate", 0},     {"free twice", 0},    {"exit", 0},
    {"quick_exit", 0},    {"_exit", 0},         {"exit_group", 0},    {"pthread_exit", 0},
    {"exec", 0},          {"close all", 0},     {"loop", 0},          {"loop above all", 0},
    {"sleep", 0},         {kOutOfMemory, 0},    {kForeign, 0},        {kStop, 0},
    {kStopAll, 0},        {kStopSource, 0},     {kStopAsked, 0},      {kGuardianStops, 0},
}};

bool is_out_of_memory(const End& end) { return std::string_view(end.name) == kOutOfMemory; }

int times() {
  const char* const said = std::getenv("MAUVE_ENDS");
  return said == nullptr ? 1 : std::max(1, std::atoi(said));
}

/// Above all that this machine has to do otherwise: it notes when each order was written.
constexpr int kAboveAll = 98;

/// A thread of another program, above all components, on the CPU of the driver. On all CPUs it
/// would keep the kernel from handing over any byte of the pseudo-terminal.
class Foreign {
 public:
  void begin(int cpu) {
    EXPECT_TRUE(thread_.start({"foreign", 80, {cpu}, 64 * 1024}, [this] {
      const Instant begin = MonotonicClock().now();
      while (!ends_ && Duration{MonotonicClock().now() - begin} < 3s) continue;
    }));
  }
  ~Foreign() {
    ends_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> ends_{false};
  rt::Thread thread_;
};

int cpu_of_driver(const Json& status) {
  for (const Json& row : status["components"]) {
    if (row["name"] == "base") return row["cpus"].at(0);
  }
  return 0;
}

constexpr std::string_view kAsk =
    R"({"jsonrpc":"2.0","id":1,"method":"component.stop","params":{"components":["base"]}})"
    "\n";

/// The act from outside, or the word to the component. Those that are one system call are made by
/// an urgent thread, since its wait for a processor is no part of the way.
void bring_about(const End& end, DaemonProcess& daemon, const TempDir& place, Foreign& foreign,
                 const Json& status, const RawClient& asker, Instant& begin) {
  const std::string_view name = end.name;
  const pid_t guardian = status["guardian"]["process"];
  if (name == kForeign) return foreign.begin(cpu_of_driver(status));
  if (name == kStopAsked) {
    EXPECT_TRUE(asker.send(kAsk));
    return;
  }
  if (name == kStop) return static_cast<void>(daemon.ask({"stop", "base"}));
  if (name == kStopAll) return static_cast<void>(daemon.ask({"stop", "--all"}));
  if (name == kStopSource) return static_cast<void>(daemon.ask({"stop", "cruise"}));
  place.write("next", end.name);
  const rt::Boost urgent(kAboveAll);
  begin = MonotonicClock().now();
  if (end.signal != 0) return daemon.process().signal(end.signal);
  if (name == kGuardianStops) return static_cast<void>(kill(guardian, SIGSTOP));
  std::filesystem::rename(place / "next", place / "how");
}

/// The time of a try until the base stood for good, and the longest time for which a CPU let not
/// even its most urgent thread run.
struct Try {
  double after = 0;        // ms
  double stood_still = 0;  // ms

  auto operator<=>(const Try&) const = default;
};

/// Nothing: it did not stand.
std::optional<Try> end_one(const End& end, const MemoryGroup& group) {
  const TempDir place;
  FakeBase base(kAboveAll);
  Json file = guarded_architecture(base.path());
  file["plugins"].push_back("ends");
  file["components"]["cruise"]["type"] = "ends/ender";
  file["components"]["cruise"]["properties"] = {{"core.file", (place / "how").string()}};
  DaemonProcess daemon(
      place.write("ends.json", file.dump()),
      {"--realtime", "require", "--guardian", "require", "--plugin-dir", MAUVE_ENDS_DIR});
  constexpr std::chrono::minutes kToStart{2};  // beside a load; the ends are judged, not the start
  Foreign foreign;
  if (!daemon.up(kToStart) || !eventually([&] { return base.drives() > 3; })) {
    ADD_FAILURE() << daemon.errors();
    return {};
  }

  if (is_out_of_memory(end)) {
    EXPECT_TRUE(group.take(daemon.process().id(), 64 << 20));
  }

  const Json status = daemon.ask({"status"});
  if (!status["guardian"].is_object()) {
    ADD_FAILURE() << status << daemon.errors();
    return {};
  }
  const RawClient asker(daemon.socket());  // mauvectl is a program that has to start first
  std::deque<Probe> probes;
  for (const int cpu : rt::usable_cpus()) probes.emplace_back(cpu);
  base.measure();
  Instant begin = MonotonicClock().now();
  bring_about(end, daemon, place, foreign, status, asker, begin);
  const bool stood = eventually(
      [&] {
        const Instant since = base.stands_since();
        return since != 0 && MonotonicClock().now() - since > Duration{300ms}.count();
      },
      std::chrono::seconds(4));
  const Instant since = base.stands_since();
  daemon.process().signal(SIGKILL);
  if (!stood || since == 0) {
    ADD_FAILURE() << end.name << ": it drives on\n" << daemon.errors();
    return {};
  }
  Instant still = 0;
  for (const Probe& probe : probes) still = std::max(still, probe.worst());
  if (since < begin) {
    ADD_FAILURE() << end.name << ": it stood before that; a CPU stood still for "
                  << static_cast<double>(still) * 1e-6 << " ms\n"
                  << daemon.errors();
    return {};
  }
  return Try{static_cast<double>(since - begin) * 1e-6, static_cast<double>(still) * 1e-6};
}

class NoEnd : public testing::Test {
 protected:
  void SetUp() override {
    if (!rt::may_use_fifo(kAboveAll))
      GTEST_SKIP() << "NOT TESTED: silence is watched in real time only";
    if (!rt::kGuardsFaults) GTEST_SKIP() << "NOT TESTED: a sanitizer handles faults in its own way";
    std::signal(SIGQUIT, SIG_DFL);  // a shell lets its background jobs ignore it, and so mauved
    if (std::getenv("MAUVE_ENDS_LOAD") != nullptr) load_.emplace();
  }

  /// Those by lack of memory, or all others, as far as they were asked for; how many.
  int bring_about_all(bool out_of_memory) {
    const char* const only = std::getenv("MAUVE_END");
    int count = 0;
    for (const End& end : kEnds) {
      if (is_out_of_memory(end) != out_of_memory) continue;
      if (only != nullptr && std::string_view(only) != end.name) continue;
      ++count;
      expect_safe(end);
    }
    return count;
  }

  const MemoryGroup group_;

 private:
  void expect_safe(const End& end) {
    std::vector<Try> tries;
    for (int i = 0; i < times(); ++i) {
      if (const auto one = end_one(end, group_)) tries.push_back(*one);
    }
    std::sort(tries.begin(), tries.end());
    if (tries.empty()) return;
    std::printf(
        "%-19s safe %2zu of %2d, after p50 %6.1f ms, at most %6.1f ms (CPU stood %5.1f ms)\n",
        end.name, tries.size(), times(), tries[tries.size() / 2].after, tries.back().after,
        tries.back().stood_still);
    std::fflush(stdout);
  }

  std::optional<Load> load_;
};

constexpr const char* kNotAskedFor = "NOT TESTED: MAUVE_END names none of these";

TEST_F(NoEnd, LeavesAnOutputLive) {
  if (bring_about_all(false) == 0) GTEST_SKIP() << kNotAskedFor;
}

TEST_F(NoEnd, ByLackOfMemoryLeavesAnOutputLive) {
  if (!group_) GTEST_SKIP() << "NOT TESTED: no memory control group can be made here";
  if (bring_about_all(true) == 0) GTEST_SKIP() << kNotAskedFor;
}

}  // namespace
}  // namespace mauve::test
