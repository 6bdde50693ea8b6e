// SPDX-License-Identifier: LGPL-3.0-or-later
/// The consistent cut on real threads: which job ran with which core is stamped, and checked
/// against the commit instants of the receipts.
#include <gtest/gtest.h>

#include <array>
#include <mutex>

#include "support/eventually.h"
#include "support/ramp.h"

#include <mauve/job.h>

namespace mauve {
namespace {

constexpr std::size_t kComponents = 20;
constexpr int kTransactions = 60;

/// One job: when it was released, and with the core of which transaction it ran.
struct Stamp {
  Instant release;
  int version;
};

struct StampShell : Shell {
  Property<std::int64_t> number{*this, "number", 0, "index of the component"};
};

struct Log {
  static constexpr std::size_t kRoom = 1 << 16;
  std::array<Stamp, kRoom> stamps;
  std::atomic<std::size_t> count{0};
};

std::array<Log, kComponents>& logs() {
  static auto* const all = new std::array<Log, kComponents>;
  return *all;
}

struct Stamper : Core<StampShell> {
  Stateless stateless{*this};
  Property<std::int64_t> version{*this, "version", 0, "the transaction that brought it"};
  void update() {
    Log& log = logs()[static_cast<std::size_t>(shell().number.get())];
    const std::size_t next = log.count.load(std::memory_order_relaxed);
    if (next == Log::kRoom) return;
    log.stamps[next] = {this_job().release, static_cast<int>(version.get())};
    log.count.store(next + 1, std::memory_order_release);
  }
};

struct Stampers : Architecture {
  Stampers() {
    for (std::size_t i = 0; i < kComponents; ++i) {
      auto component = std::make_shared<ComponentBase>(
          "c" + std::to_string(i),
          ComponentType{"stamper", ShellType::of<StampShell>(),
                        FsmType::of<PeriodicFsm<Stamper>>("stamper"), "stamper"},
          CoreType::of<Stamper>("stamper"));
      auto& shell = static_cast<StampShell&>(component->shell());
      static_cast<void>(shell.find_property("number")->set(Value(static_cast<std::int64_t>(i))));
      // Periods differ, so that members come to the instant at different times.
      static_cast<PeriodicFsm<Stamper>&>(component->fsm()).period =
          Duration{1ms} * static_cast<std::int64_t>(1 + i % 5);
      own(std::move(component));
    }
  }
};

Change to_version(int version) {
  Change change;
  for (std::size_t i = 0; i < kComponents; ++i) {
    Edit edit;
    edit.component = "c" + std::to_string(i);
    edit.properties.emplace_back("core.version", static_cast<std::int64_t>(version));
    change.edits.push_back(std::move(edit));
  }
  return change;
}

TEST(ConsistentCut, JobsBeforeTheInstantAreOldAndAllOthersNew) {
  for (Log& log : logs()) log.count = 0;
  Stampers architecture;
  Deployer deployer(architecture, {.realtime = Realtime::off, .admission = Admission::off});
  ASSERT_TRUE(deployer.deploy());
  std::vector<Instant> commits;  // by version, from 1
  int taken_back = 0;
  for (int i = 0; i < kTransactions; ++i) {
    const Result<Receipt> done = deployer.apply(to_version(static_cast<int>(commits.size()) + 1));
    // On a machine that is overloaded every attempt may miss its instant; then nothing changed.
    if (done) commits.push_back(deployer.t0() + done->commit.count());
    if (!done) ++taken_back;
    if (!done && done.error().code == Errc::partly) break;  // a member did not run for seconds
  }
  static_cast<void>(deployer.shutdown());

  std::size_t checked = 0;
  for (const Log& log : logs()) {
    for (std::size_t i = 0; i < log.count.load(); ++i, ++checked) {
      const Stamp& stamp = log.stamps[i];
      const auto version = static_cast<std::size_t>(stamp.version);
      if (version > commits.size()) continue;  // of the one that was in force partly
      const bool begun = version == 0 || stamp.release >= commits[version - 1];
      const bool over = version < commits.size() && stamp.release >= commits[version];
      EXPECT_TRUE(begun && !over) << "version " << version << " at release " << stamp.release;
    }
  }
  EXPECT_GT(commits.size(), 0u) << taken_back << " were taken back";
  EXPECT_GT(checked, kComponents);
}

}  // namespace
}  // namespace mauve
