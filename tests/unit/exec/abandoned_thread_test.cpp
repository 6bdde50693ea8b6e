// SPDX-License-Identifier: LGPL-3.0-or-later
/// A thread that does not return in time from a resource: what becomes of the lock it holds, and of
/// the resource. And one that commands a device late.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <thread>

#include <unistd.h>

#include "rt/guardian/guarded_outputs.h"
#include "support/block.h"
#include "support/outcomes.h"
#include "support/pipe_device.h"
#include "support/ramp.h"

#include <mauve/detail/job.h>
#include <mauve/guarded.h>

namespace mauve {
namespace {

using test::Block;
using test::block;
using test::eventually;
using test::is_faulted;
using test::runs_on;

struct SlowMeter final : Core<EmptyShell> {
  State<ramp::Position> state{*this};
  Property<double> scale{*this, "scale", 1.0, "any"};
  /// Cores configured and not cleaned up.
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

/// The meter is the architecture's own, so that it may leave. `left` gets lost in it; `right`
/// counts down, so it never hands over a 4.
template <typename Left>
struct MeteringOf : Architecture {
  ResourceBase& meter = own(std::make_shared<ResourceBase>(
      "meter", ResourceType{"meter", ShellType::of<EmptyShell>(), CoreType::of<SlowMeter>("meter"),
                            detail::make<InterfaceBase, SlowInterface>}));
  Component<ramp::Shell, Left, ramp::Fsm> left{*this, "left"};
  Component<ramp::Shell, ramp::Down, ramp::Fsm> right{*this, "right"};

  Status on_configure() override {
    left.task().watchdog = 500ms;
    ServiceBase& write = *meter.find_service("write");
    if (Status done = left.shell().out.connect(write); !done) return done;
    return right.shell().out.connect(write);
  }
};
using Metering = MeteringOf<ramp::Up>;

class LostThread : public testing::Test {
 protected:
  void SetUp() override {
    block() = &block_;
    SlowMeter::configured() = 0;
    ASSERT_TRUE(deployer_.deploy());
    ASSERT_TRUE(eventually([&] { return block_.entered.load(); }));
  }
  /// No thread says when code is unused while an abandoned thread may run it.
  [[nodiscard]] int configured() {
    static_cast<void>(test::tend(deployer_));
    return SlowMeter::configured();
  }
  [[nodiscard]] bool becomes(int cores) {
    return eventually([&] { return configured() == cores; });
  }
  void exchange_core() {
    ASSERT_TRUE(deployer_.set("meter.core.scale", Value(2.0), StatePolicy::drop));
  }
  [[nodiscard]] bool serves() {
    const double value = 1;
    return architecture_.meter.find_service("write")->write(&value);
  }

  Block block_;
  Metering architecture_;
  Deployer deployer_{architecture_};
  ResourceLock& lock_ = architecture_.meter.lock();
};

TEST_F(LostThread, LeavesWhatItHeldPoisonedAndFree) {
  ASSERT_TRUE(is_faulted(deployer_, "left"));

  EXPECT_TRUE(lock_.poisoned());
  EXPECT_FALSE(serves());
  EXPECT_TRUE(runs_on(deployer_, "right"));
  ASSERT_TRUE(lock_.try_enter()) << "although the thread is still inside";
  lock_.leave();

  exchange_core();
  block_.let_go();
  EXPECT_TRUE(becomes(1));
}

TEST_F(LostThread, IsInAResourceThatGetsANewCoreAndServesAgain) {
  ASSERT_TRUE(is_faulted(deployer_, "left"));

  const auto kept = deployer_.set("meter.core.scale", Value(2.0));
  ASSERT_FALSE(kept) << "its state may be half written";
  EXPECT_EQ(kept.error().code, Errc::wrong_state);
  exchange_core();

  EXPECT_FALSE(lock_.poisoned());
  EXPECT_TRUE(runs_on(deployer_, "right"));
  EXPECT_TRUE(serves());
  EXPECT_EQ(configured(), 2) << "the old core stays: a thread is in it";
  const ScopedLock held(lock_);
  ASSERT_TRUE(held);
  block_.let_go();
  EXPECT_TRUE(becomes(1)) << "and goes with its thread";
  std::thread([&] { EXPECT_FALSE(lock_.try_enter()) << "held by this thread alone"; }).join();
}

TEST_F(LostThread, IsInAResourceThatMayLeave) {
  ASSERT_TRUE(is_faulted(deployer_, "left"));
  Change change;
  for (const char* component : {"left", "right"}) {
    change.edits.emplace_back().member = component;
    change.edits.back().disconnect = {"out"};
  }
  change.remove = {"meter"};

  ASSERT_TRUE(deployer_.apply(change));

  EXPECT_EQ(architecture_.find_resource("meter"), nullptr);
  EXPECT_EQ(configured(), 1) << "it stays while a thread is in it";
  block_.let_go();
  EXPECT_TRUE(becomes(0));
}

TEST_F(LostThread, ServesWhoWaitedForItsLockWhenItComesBack) {
  bool served = false;
  {
    const std::jthread waiting([&] {
      this_job().lock_bound = 30s;
      served = static_cast<bool>(ScopedLock(lock_));
    });
    EXPECT_TRUE(is_faulted(deployer_, "left"));
    exchange_core();
    block_.let_go();
  }
  EXPECT_TRUE(served);
  EXPECT_TRUE(becomes(1));
}

/// A core in quarantine is made nowhere any more, so it must be the one that failed.
TEST(ThreadLostInAResource, TakesTheChangeOfItsUserBackWithoutBlamingTheCoreOfThatUser) {
  Block forever;
  block() = &forever;
  ramp::Up::configured_cores() = 0;
  MeteringOf<ramp::Down> architecture;
  Deployer deployer(architecture);
  ASSERT_TRUE(deployer.deploy());
  Change change{{ramp::to_core<ramp::Up>("new", "left")}};
  change.edits[0].state = StatePolicy::drop;
  change.probation.emplace();
  ASSERT_TRUE(deployer.apply(change));

  const auto outcomes = test::await_outcomes(deployer);

  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_EQ(outcomes[0].kind, Outcome::Kind::rolled_back);
  EXPECT_NE(outcomes[0].reason.find("in a call of meter"), std::string::npos) << outcomes[0].reason;
  EXPECT_TRUE(outcomes[0].cores.empty());
  forever.let_go();
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(test::tend(deployer));
    return ramp::Up::configured_cores() == 0;
  })) << "its thread was joined, its core cleaned up";
}

/// The device of the next core.
test::PipeDevice*& wheels() {
  static test::PipeDevice* device = nullptr;
  return device;
}

/// Its third job waits for something else, and then commands all the same.
struct LateWheels : ramp::Up {
  Guarded stand{*this, "stand"};
  Status on_configure() override {
    if (Status done = ramp::Up::on_configure(); !done) return done;
    return stand.hold(wheels()->descriptor(), {.bytes = "stand "});
  }
  void on_cleanup() override {
    stand.drop();
    ramp::Up::on_cleanup();
  }
  void update() override {
    ramp::Up::update();
    if (state->value != 3) return;
    block()->wait();
    EXPECT_EQ(::write(wheels()->descriptor(), "drive ", 6), 6);
  }
};

class ThreadLostInADriver : public testing::Test {
 protected:
  ThreadLostInADriver() {
    block() = &block_;
    wheels() = &device_;
    EXPECT_TRUE(outputs_.expect(rt::GuardianUse::off, nullptr));
    architecture_.control.task().watchdog = 200ms;
  }
  ~ThreadLostInADriver() override {
    deployer_.reset();
    outputs_.leave();
  }
  [[nodiscard]] bool heard(const std::string& bytes) {
    return eventually([&] { return device_.bytes() == bytes; });
  }

  Block block_;
  test::PipeDevice device_;
  rt::GuardedOutputs& outputs_ = rt::GuardedOutputs::of_process();
  ramp::One<LateWheels> architecture_;
  std::optional<Deployer> deployer_{std::in_place, architecture_};
};

TEST_F(ThreadLostInADriver, HasItsOrderRepeatedAfterTheLastCommandOfItsJob) {
  ASSERT_TRUE(deployer_->deploy());
  ASSERT_TRUE(is_faulted(*deployer_, "control"));
  ASSERT_TRUE(heard("stand stand "));

  block_.let_go();

  EXPECT_TRUE(heard("stand stand drive stand stand "));
}

}  // namespace
}  // namespace mauve
