// SPDX-License-Identifier: LGPL-3.0-or-later
// mauved locks its memory: a robot computer pays for each stack that it locks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "rt/thread/stack.h"
#include "rt/thread/thread.h"
#include "support/daemon_process.h"
#include "support/process_usage.h"
#include "support/rights.h"

namespace mauve::test {
namespace {

/// The bound that docs/promises.md has for etc/yard.json.
constexpr std::int64_t kMostOfYard = 40'000'000;

/// A mapping that no file backs, in bytes, from /proc/PROCESS/smaps.
struct Mapping {
  std::string name;
  std::size_t size = 0;
  std::size_t resident = 0;
  bool locked = false;
};

std::vector<Mapping> mappings_without_file(pid_t process) {
  std::vector<Mapping> all;
  std::ifstream smaps("/proc/" + std::to_string(process) + "/smaps");
  for (std::string line; std::getline(smaps, line);) {
    std::istringstream words(line);
    std::string first;
    std::size_t kilobytes = 0;
    words >> first;
    if (first.back() != ':') {
      std::string skipped;
      all.emplace_back();
      words >> skipped >> skipped >> skipped >> skipped >> all.back().name;
    } else if (first == "VmFlags:") {
      all.back().locked = line.find(" lo") != std::string::npos;
    } else if (words >> kilobytes) {
      if (first == "Size:") all.back().size = kilobytes * 1024;
      if (first == "Rss:") all.back().resident = kilobytes * 1024;
    }
  }
  std::erase_if(all, [](const Mapping& one) { return !one.name.empty(); });
  return all;
}

class LockedMemory : public testing::Test {
 protected:
  void SetUp() override {
    if (!rt::may_use_fifo(99)) GTEST_SKIP() << "SKIPPED: no right to SCHED_FIFO";
    if (!may_lock_memory()) GTEST_SKIP() << kMemoryNotLocked;
    daemon_.emplace(MAUVE_SOURCE_DIR "/etc/yard.json",
                    std::vector<std::string>{"--realtime", "require"});
    ASSERT_TRUE(daemon_->up()) << daemon_->errors();
  }
  [[nodiscard]] pid_t process() { return daemon_->process().id(); }

  std::optional<DaemonProcess> daemon_;
};

TEST_F(LockedMemory, OfTheYardIsSmall) {
  const auto used = resident_bytes(process());
  EXPECT_GT(used, 0);
  EXPECT_LE(used, kMostOfYard);
}

/// The stack of [factory] is locked too, but only as far as hooks have used it.
TEST_F(LockedMemory, HoldsNoLargeStackOfAThreadThatDoesNotUseIt) {
  std::size_t ordinary = 0;
  std::size_t of_hooks = 0;
  for (const Mapping& one : mappings_without_file(process())) {
    if (one.size == rt::kOrdinaryStack && one.resident == one.size && one.locked) ++ordinary;
    if (one.size != rt::kHookStack) continue;
    ++of_hooks;
    EXPECT_LT(one.resident, one.size / 4);
    EXPECT_TRUE(one.locked) << "what it has used stays in memory";
  }
  EXPECT_GE(ordinary, 8U) << "those of mauved are locked as a whole";
  EXPECT_EQ(of_hooks, 1U);
}

}  // namespace
}  // namespace mauve::test
