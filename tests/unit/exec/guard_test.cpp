// SPDX-License-Identifier: LGPL-3.0-or-later
/// Cores that do not return, on real threads. The bound is wide, so that no healthy job runs into
/// it on a loaded machine.
#include <gtest/gtest.h>

#include <array>
#include <thread>

#include <unistd.h>

#include "rt/rescue.h"
#include "rt/thread.h"
#include "support/outcomes.h"
#include "support/ramp.h"

#include <mauve/job.h>

namespace mauve {
namespace {

using test::await_outcomes;
using test::eventually;
using test::is_faulted;
using test::runs_on;
constexpr Duration kBound = 500ms;
constexpr double kValue = 1;

/// A call into the system that does not return until it is let go.
class Block {
 public:
  Block() {
    if (pipe(ends_.data()) != 0) std::abort();
  }
  ~Block() {
    for (const int end : ends_) close(end);
  }
  void wait() {
    entered.store(true);
    char byte = 0;
    if (read(ends_[0], &byte, 1) < 0) return;
  }
  void let_go() const {
    if (write(ends_[1], "", 1) < 0) std::abort();
  }
  std::atomic<bool> entered{false};

 private:
  std::array<int, 2> ends_{};
};

/// Of the test that runs.
Block*& block() {
  static Block* one = nullptr;
  return one;
}

struct Endless final : ramp::Up {
  volatile bool forever = true;
  void update() override {
    ramp::Up::update();
    while (state->value >= 4 && forever) {
    }
  }
};

/// Blocks in its fourth job, and tells what came of the write after it.
struct Blocked final : ramp::Up {
  void update() override {
    ramp::Up::update();
    if (state->value != 4) return;
    block()->wait();
    late_write() = shell().out.write(1234.0) ? 1 : 0;
  }
  /// -1: not done yet.
  static std::atomic<int>& late_write() {
    static std::atomic<int> result{-1};
    return result;
  }
};

/// In its fourth job it waits for somebody who takes its processor away.
struct Displaced final : ramp::Up {
  static std::atomic<bool>& waits() {
    static std::atomic<bool> waits{false};
    return waits;
  }
  static std::atomic<bool>& displaced() {
    static std::atomic<bool> displaced{false};
    return displaced;
  }
  void update() override {
    ramp::Up::update();
    if (state->value != 4) return;
    waits() = true;
    while (!displaced()) {
    }
  }
};

/// `left` does not return.
template <typename Core>
struct Two : ramp::FallingBack<Core, ramp::Down> {
  explicit Two(FaultPolicy::Action action = FaultPolicy::Action::fallback)
      : ramp::FallingBack<Core, ramp::Down>(action) {
    this->left.task().watchdog = kBound;
  }
};

class Guard : public testing::Test {
 protected:
  void SetUp() override {
    block() = &block_;
    Blocked::late_write() = -1;
    ramp::Up::configured_cores() = 0;
  }
  Block block_;
};

TEST_F(Guard, DoesNotBlameAJobThatAMoreUrgentThreadKeepsFromItsProcessor) {
  if (!rt::may_use_fifo(90))
    GTEST_SKIP() << "NOT TESTED: nothing is more urgent without SCHED_FIFO";
  constexpr Duration kShort = 100ms;
  const int cpu = rt::usable_cpus().front();
  Displaced::waits() = false;
  Displaced::displaced() = false;
  Two<Displaced> architecture;
  architecture.left.task().watchdog = kShort;
  architecture.left.task().cpus = {cpu};
  Deployer deployer(architecture, {.realtime = Realtime::require});
  rt::Thread urgent;  // there before the job: who started it then might be late
  ASSERT_TRUE(urgent.start({"urgent", 90, {cpu}}, [&] {
    while (!Displaced::waits()) std::this_thread::sleep_for(1ms);
    const MonotonicClock clock;
    const Instant end = clock.now() + (3 * kShort).count();
    while (clock.now() < end) {
    }
    Displaced::displaced() = true;
  }));
  const Status up = deployer.deploy();
  if (!up) Displaced::waits() = true;
  urgent.join();
  ASSERT_TRUE(up);
  const std::uint64_t before = deployer.status("left").releases;

  EXPECT_TRUE(eventually([&] { return deployer.status("left").releases > before + 2; }));
  EXPECT_TRUE(test::tend(deployer).empty());
  EXPECT_TRUE(runs_on(deployer, "left"));
}

TEST_F(Guard, EndsAnEndlessLoopAndTheFallbackCoreTakesOver) {
  if (!rt::kCanRescue) GTEST_SKIP() << "under a sanitizer a loop cannot be ended";
  Two<Endless> architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  const auto outcomes = await_outcomes(deployer);

  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::fell_back);
  EXPECT_EQ(outcomes[0].reason, "its job ran longer than 500 ms");
  EXPECT_TRUE(runs_on(deployer, "left"));
  EXPECT_TRUE(runs_on(deployer, "right"));
  EXPECT_TRUE(deployer.shutdown().empty()) << "the same thread goes on: nobody is left behind";
}

TEST_F(Guard, GivesUpAThreadThatIsInTheSystemAndAFreshOneGoesOn) {
  Two<Blocked> architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  const auto outcomes = await_outcomes(deployer);

  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::fell_back);
  EXPECT_EQ(deployer.status("left").core, "ramp/down");
  EXPECT_TRUE(runs_on(deployer, "left"));
  EXPECT_TRUE(runs_on(deployer, "right"));
  EXPECT_GE(deployer.status("left").releases, 4u) << "it counts on";
  EXPECT_EQ(ramp::Up::configured_cores(), 1) << "nobody cleans up what a thread is in";
  EXPECT_LT(ramp::read(architecture.left_position), 1.0) << "nothing is taken from that core";

  block_.let_go();
  EXPECT_TRUE(eventually([] { return Blocked::late_write() != -1; }));
  EXPECT_EQ(Blocked::late_write(), 0) << "what it still writes is dropped";
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(test::tend(deployer));
    return ramp::Up::configured_cores() == 0;
  })) << "its thread was joined, its core cleaned up";
  EXPECT_TRUE(runs_on(deployer, "left"));
  EXPECT_TRUE(deployer.shutdown().empty());
}

TEST_F(Guard, ParksAComponentWithoutAFallbackCoreAndItStartsAgain) {
  Two<Blocked> architecture(FaultPolicy::Action::stop);
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  ASSERT_TRUE(is_faulted(deployer, "left"));
  EXPECT_EQ(deployer.status("left").fault, "its job ran longer than 500 ms");
  EXPECT_EQ(ramp::read(architecture.left_position), -1.0) << "the safe value";

  ASSERT_TRUE(deployer.swap_core<ramp::Down>("left"));
  ASSERT_TRUE(deployer.start({"left"}));
  EXPECT_TRUE(runs_on(deployer, "left"));
  block_.let_go();
  EXPECT_TRUE(eventually([] { return Blocked::late_write() == 0; }));
  EXPECT_TRUE(runs_on(deployer, "left"));
}

TEST_F(Guard, AChangeOfAComponentThatHangsEndsWithIt) {
  Two<Blocked> architecture(FaultPolicy::Action::stop);
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([&] { return block_.entered.load(); }));

  static_cast<void>(deployer.swap_core<ramp::Down>("left"));

  ASSERT_TRUE(is_faulted(deployer, "left"));
  EXPECT_TRUE(eventually([&] { return !deployer.status("left").changing; }));
  if (deployer.status("left").core != "ramp/down") {
    ASSERT_TRUE(
        deployer.swap_core("left", CoreType::of<ramp::Down>("ramp/down")));  // taken back in time
  }
  ASSERT_TRUE(deployer.start({"left"}));
  EXPECT_TRUE(runs_on(deployer, "left"));
  block_.let_go();
  EXPECT_TRUE(eventually([] { return Blocked::late_write() == 0; }));
}

TEST_F(Guard, AShutdownLeavesBehindWhatAThreadIsStillIn) {
  // Never freed: a thread stays in them.
  static auto* const kept = new std::vector<std::pair<Two<Blocked>*, Block*>>;
  const auto [architecture, forever] = kept->emplace_back(new Two<Blocked>, new Block);
  block() = forever;
  auto deployer = std::make_unique<Deployer>(*architecture);
  ASSERT_TRUE(deployer->deploy());
  ASSERT_EQ(await_outcomes(*deployer).size(), 1u);

  EXPECT_EQ(deployer->shutdown(), std::vector<std::string>{"left"});
  deployer.reset();
  forever->let_go();
  EXPECT_TRUE(eventually([] { return Blocked::late_write() == 0; }));
}

// --- a resource that is held

struct SlowMeter final : Core<EmptyShell> {
  State<ramp::Position> state{*this};
  Property<double> scale{*this, "scale", 1.0, "any"};
  static std::atomic<int>& configured() {
    static std::atomic<int> cores{0};
    return cores;
  }
  Status on_configure() override {
    ++configured();
    return ok();
  }
  void on_cleanup() override { --configured(); }
  void note(const double& value) {
    if (value == 4) block()->wait();
  }
};
struct SlowInterface : Interface<SlowMeter> {
  WriteService<double> write{*this, "write", &SlowMeter::note};
};

/// `right` counts down, so it never hands over a 4.
struct Shared : Architecture {
  Shared() { SlowMeter::configured() = 0; }
  Resource<EmptyShell, SlowMeter, SlowInterface> meter{*this, "meter"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> left{*this, "left"};
  Component<ramp::Shell, ramp::Down, ramp::Fsm> right{*this, "right"};
  Status on_configure() override {
    left.task().watchdog = kBound;
    if (auto done = left.shell().out.connect(meter.interface().write); !done) return done;
    return right.shell().out.connect(meter.interface().write);
  }
};

#if defined(__SANITIZE_THREAD__)
constexpr bool kWatchesRaces = true;
#else
constexpr bool kWatchesRaces = false;
#endif
/// A thread that never returns has told nobody that it read which core to run.
constexpr const char* kNoOrder =
    "NOT TESTED: to the thread sanitizer a lost thread and who takes its place are in no order";

/// The meter has another core, and nobody is in the old one any more.
bool is_left(Deployer& deployer) {
  return eventually([&] {
    static_cast<void>(test::tend(deployer));
    return SlowMeter::configured() == 1;
  });
}

TEST_F(Guard, WhatALostThreadHoldsIsPoisonedAndFreedAtOnce) {
  if (kWatchesRaces) GTEST_SKIP() << kNoOrder;
  Shared architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());

  ASSERT_TRUE(is_faulted(deployer, "left"));

  Gate& gate = architecture.meter.gate();
  EXPECT_TRUE(gate.poisoned());
  EXPECT_FALSE(architecture.meter.interface().write.write(&kValue));
  EXPECT_TRUE(runs_on(deployer, "right"));
  ASSERT_TRUE(gate.try_enter()) << "although the thread is still inside";
  gate.leave();
  ASSERT_TRUE(deployer.set("meter.core.scale", Value(2.0), StatePolicy::drop));
  block_.let_go();
  EXPECT_TRUE(is_left(deployer));
}

TEST_F(Guard, AResourceThatALostThreadIsInGetsANewCoreAndServesAgain) {
  if (kWatchesRaces) GTEST_SKIP() << kNoOrder;
  Shared architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(is_faulted(deployer, "left"));
  Gate& gate = architecture.meter.gate();

  const auto kept = deployer.set("meter.core.scale", Value(2.0));
  ASSERT_FALSE(kept) << "its state may be half written";
  EXPECT_EQ(kept.error().code, Errc::wrong_state);
  ASSERT_TRUE(deployer.set("meter.core.scale", Value(2.0), StatePolicy::drop));
  EXPECT_TRUE(runs_on(deployer, "right"));

  EXPECT_FALSE(gate.poisoned());
  EXPECT_TRUE(architecture.meter.interface().write.write(&kValue));
  EXPECT_EQ(SlowMeter::configured(), 2) << "the old core stays: a thread is in it";

  Entry entry(gate);
  ASSERT_TRUE(entry);
  block_.let_go();
  EXPECT_TRUE(is_left(deployer)) << "and goes with its thread";
  std::thread([&] { EXPECT_FALSE(gate.try_enter()) << "held by this thread alone"; }).join();
}

/// The resource is the architecture's own, so that it may leave.
struct WithOwned : Architecture {
  ResourceBase& meter = own(std::make_shared<ResourceBase>(
      "meter", ResourceType{"meter", ShellType::of<EmptyShell>(), CoreType::of<SlowMeter>("meter"),
                            detail::make<InterfaceBase, SlowInterface>}));
  Component<ramp::Shell, ramp::Up, ramp::Fsm> left{*this, "left"};
  Status on_configure() override {
    left.task().watchdog = kBound;
    return left.shell().out.connect(*meter.find_service("write"));
  }
};

TEST_F(Guard, AResourceThatALostThreadIsInMayLeave) {
  SlowMeter::configured() = 0;
  WithOwned architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(is_faulted(deployer, "left"));
  Change change;
  change.edits.resize(1);
  change.edits[0].component = "left";
  change.edits[0].disconnect = {"out"};
  change.remove = {"meter"};

  ASSERT_TRUE(deployer.apply(change));

  EXPECT_EQ(architecture.find_resource("meter"), nullptr);
  static_cast<void>(test::tend(deployer));
  EXPECT_EQ(SlowMeter::configured(), 1) << "it stays while a thread is in it";
  block_.let_go();
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(test::tend(deployer));
    return SlowMeter::configured() == 0;
  }));
}

TEST_F(Guard, WhoWaitsForTheLockOfALostThreadIsServedWhenThatComesBack) {
  if (kWatchesRaces) GTEST_SKIP() << kNoOrder;
  Shared architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  ASSERT_TRUE(eventually([&] { return block_.entered.load(); }));
  bool served = false;
  std::thread waiting([&] {
    this_job().lock_bound = 30s;
    const Entry entry(architecture.meter.gate());
    served = static_cast<bool>(entry);
  });

  ASSERT_TRUE(is_faulted(deployer, "left"));
  ASSERT_TRUE(deployer.set("meter.core.scale", Value(2.0), StatePolicy::drop));
  block_.let_go();

  waiting.join();
  EXPECT_TRUE(served);
  EXPECT_TRUE(is_left(deployer));
}

}  // namespace
}  // namespace mauve
