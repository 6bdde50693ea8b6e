// SPDX-License-Identifier: LGPL-3.0-or-later
/// No heap call on a real-time path: jobs, ports, resources, swaps, stop, start, events.
#include <gtest/gtest.h>

#include <sys/resource.h>

#include "rt/heap_probe.h"
#include "rt/thread/thread.h"
#include "support/eventually.h"
#include "support/positions.h"
#include "support/rights.h"

namespace mauve {
namespace {

using test::eventually;

/// The findings of a job of this thread.
struct Watch {
  std::atomic<long> faults{0};
  std::atomic<int> jobs{0};
};
Watch& watch() {
  static Watch instance;
  return instance;
}

long minor_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt;
}

/// Watches its own thread from its first job on, logs, reads and writes.
struct Watched : ramp::Up {
  Watched() = default;
  void update() override {
    heap::watch_this_thread(true);
    static_cast<void>(shell().speed.read());
    log(LogLevel::debug, "at {} after {} jobs", state->value, jobs.get());
    ramp::Up::update();
    // The first jobs of a new core may touch memory for the first time; the ones after may not.
    const long faults = minor_faults();
    if (++seen_ > 3) watch().faults += faults - last_;
    last_ = faults;
    ++watch().jobs;
  }

 private:
  int seen_ = 0;
  long last_ = 0;
};

struct Watching : Architecture {
  SharedData<double> position{*this, "position"};
  RingBuffer<double> queue{*this, "queue"};
  Component<ramp::Shell, Watched, ramp::Fsm> control{*this, "control"};
  Status on_configure() override {
    control.fsm().period = 1ms;
    if (auto done = control.shell().speed.connect(queue.read_service()); !done) return done;
    return control.shell().out.connect(position.write_service());
  }
};

/// To and fro between states of two types, one of them as large as can be converted.
struct WatchedThere final : Watched {
  Converts<ramp::PositionV3, ramp::Position> back{
      state,
      [](const ramp::PositionV3& old, ramp::Position& now) noexcept { now.value = old.metres; }};
};
struct WatchedHere final : ramp::RampCore {
  State<ramp::PositionV3> state{*this};
  Converts<ramp::Position, ramp::PositionV3> from{
      state,
      [](const ramp::Position& old, ramp::PositionV3& now) noexcept { now.metres = old.value; }};
  void update() override {
    ++watch().jobs;
    shell().out.write(++state->metres);
  }
};

void drain_quietly(Deployer& deployer) {
  deployer.drain([](const RuntimeEvent&) {});
}

TEST(RealTimePath, CallsNoHeapInJobsAndSwaps) {
  Watching architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([] { return watch().jobs > 20; }));
  const std::size_t before = heap::calls();

  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(deployer.swap_core<Watched>("control"));
    ASSERT_TRUE(deployer.set("control.core.step", 2.0 + i % 2));
    drain_quietly(deployer);
  }
  ASSERT_TRUE(deployer.disconnect("control.ports.out"));
  ASSERT_TRUE(deployer.connect("control.ports.out", "position.write"));
  ASSERT_TRUE(deployer.stop({"control"}));
  ASSERT_TRUE(deployer.start({"control"}));
  const int jobs = watch().jobs;
  ASSERT_TRUE(eventually([&] { return watch().jobs > jobs + 100; }));

  EXPECT_EQ(heap::calls() - before, 0u);
}

/// Records events of its own besides.
struct WatchedRecorder final : Watched {
  TraceEvent event{*this, "event"};
  void update() override {
    Watched::update();
    event(state->value);
  }
};

TEST(RealTimePath, CallsNoHeapWhileEverythingIsTraced) {
  set_trace_mode(TraceMode::detail);
  Watching architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.swap_core<WatchedRecorder>("control"));
  const int first = watch().jobs;
  ASSERT_TRUE(eventually([&] { return watch().jobs > first + 20; }));
  const std::size_t before = heap::calls();
  std::size_t recorded = 0;
  const auto collect = [&] {
    deployer.drain_trace([&](const TraceRecord& record) {
      recorded += record.kind == TraceKind::user || record.kind == TraceKind::call ? 1 : 0;
    });
  };
  collect();
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(deployer.swap_core<WatchedRecorder>("control"));
    collect();
  }
  const int jobs = watch().jobs;
  ASSERT_TRUE(eventually([&] { return watch().jobs > jobs + 100; }));
  collect();
  set_trace_mode(TraceMode::jobs);

  EXPECT_EQ(heap::calls() - before, 0u);
  EXPECT_GT(recorded, 300u) << "two ports and an event each job";
}

TEST(RealTimePath, CallsNoHeapWhenAStateIsConverted) {
  Watching architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  const int first = watch().jobs;
  ASSERT_TRUE(eventually([&] { return watch().jobs > first + 20; }));
  const std::size_t before = heap::calls();

  for (int i = 0; i < 20; ++i) {
    const Result<Receipt> here = deployer.swap_core<WatchedHere>("control");
    ASSERT_TRUE(here) << to_string(here.error());
    EXPECT_EQ(here->components[0].bytes, sizeof(ramp::Position));
    const Result<Receipt> there = deployer.swap_core<WatchedThere>("control");
    ASSERT_TRUE(there) << to_string(there.error());
    EXPECT_EQ(there->components[0].bytes, kMaxConverted);
    drain_quietly(deployer);
  }
  const int jobs = watch().jobs;
  ASSERT_TRUE(eventually([&] { return watch().jobs > jobs + 20; }));

  EXPECT_EQ(heap::calls() - before, 0u);
}

TEST(RealTimePath, CallsNoHeapWhenStatisticsAreReadAndReset) {
  Watching architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  const int first = watch().jobs;
  ASSERT_TRUE(eventually([&] { return watch().jobs > first + 20; }));
  const std::size_t before = heap::calls();

  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(deployer.reset_statistics("control"));
    ASSERT_TRUE(eventually([&] { return deployer.statistics("control").response.count > 2; }));
  }

  EXPECT_EQ(heap::calls() - before, 0u);
}

TEST(RealTimePath, TakesNoPageFaultOnceItRuns) {
  if (!rt::may_use_fifo(99)) GTEST_SKIP() << "SKIPPED: no right to SCHED_FIFO";
  if (!test::may_lock_memory()) GTEST_SKIP() << test::kMemoryNotLocked;
  Watching architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(deployer.realtime());
  const int jobs = watch().jobs;
  ASSERT_TRUE(eventually([&] { return watch().jobs > jobs + 50; }));
  watch().faults = 0;

  for (int i = 0; i < 20; ++i) ASSERT_TRUE(deployer.swap_core<Watched>("control"));
  const int after = watch().jobs;
  ASSERT_TRUE(eventually([&] { return watch().jobs > after + 200; }));

  EXPECT_EQ(watch().faults, 0);
}

TEST(HeapProbe, SeesAHeapCall) {
  heap::watch_this_thread(true);
  const std::size_t before = heap::calls();
  auto* volatile memory = new int(1);
  const std::size_t after = heap::calls();
  delete memory;
  heap::watch_this_thread(false);

  EXPECT_GT(after, before) << "a detector that sees nothing proves nothing";
}

}  // namespace
}  // namespace mauve
