// SPDX-License-Identifier: LGPL-3.0-or-later
/// One component crashes, loops and blocks, again and again; a 1 kHz component beside it misses not
/// one release, under CPU load.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include <unistd.h>

#include "rt/thread/run_guarded.h"
#include "support/campaign.h"
#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

/// Fails from its third job on.
struct Failing : ramp::Up {
  int own_jobs = 0;
  bool fails() { return ++own_jobs >= 3; }
};

struct Crashing final : Failing {
  int* volatile nobody = nullptr;
  void update() override {
    ramp::Up::update();
    if (fails()) *nobody = 1;
  }
};

struct Looping final : Failing {
  void update() override {
    ramp::Up::update();
    volatile bool forever = fails();
    while (forever) {
    }
  }
};

struct Blocking final : Failing {
  static std::array<int, 2>& ends() {
    static std::array<int, 2> pipe{};
    return pipe;
  }
  void update() override {
    ramp::Up::update();
    char byte = 0;
    if (fails() && read(ends()[0], &byte, 1) < 0) return;
  }
};

struct Pair : ramp::Two<ramp::Up> {
  Pair() {
    left.fsm().period = 1ms;
    left.task().priority = 40;
    left.task().watchdog = 5ms;
    right.fsm().period = 1ms;
    right.task().priority = 80;
  }
};

class FaultCampaign : public testing::Test {
 protected:
  void SetUp() override {
    if (!rt::kGuardsFaults) GTEST_SKIP() << "the sanitizer handles faults itself";
    if (!rt::may_use_fifo(99)) GTEST_SKIP() << "needs SCHED_FIFO: run as root";
    ASSERT_EQ(pipe(Blocking::ends().data()), 0);
  }

  /// `rounds` times: a core that fails, and its component is parked. `after`: what lets it go.
  template <typename Core>
  void run(int rounds, const char* what, void (*after)()) {
    test::campaign([&](test::Tally& tally) { run_once<Core>(rounds, what, after, tally); });
  }

 private:
  template <typename Core>
  static void run_once(int rounds, const char* what, void (*after)(), test::Tally& tally) {
    Pair architecture;
    Deployer deployer(architecture, {.realtime = Realtime::require});
    ASSERT_TRUE(deployer.deploy());
    test::UnderLoad load(tally, [&] { return deployer.status("right").missed; });
    for (int i = 0; i < rounds; ++i) {
      const Result<Receipt> done =
          deployer.swap_core("left", CoreType::of<Core>("failing"), StatePolicy::drop);
      ASSERT_TRUE(done) << to_string(done.error());
      if (deployer.status("left").state != ComponentState::running) {
        static_cast<void>(deployer.start({"left"}));
      }
      ASSERT_TRUE(test::is_faulted(deployer, "left"));
      after();
      static_cast<void>(test::tend(deployer));
      deployer.drain([](const RuntimeEvent&) {});
      load.close_window();
    }
    const ComponentStatus right = deployer.status("right");
    std::printf("%d times %s: releases of the other %llu\n", rounds, what,
                static_cast<unsigned long long>(right.releases));
    EXPECT_EQ(right.state, ComponentState::running);
  }
};

TEST_F(FaultCampaign, OthersLoseNoReleaseInCrashes) {
  run<Crashing>(300, "a crash", [] {});
}

TEST_F(FaultCampaign, OthersLoseNoReleaseInEndlessLoops) {
  run<Looping>(200, "an endless loop", [] {});
}

TEST_F(FaultCampaign, OthersLoseNoReleaseWhenThreadsAreAbandoned) {
  run<Blocking>(100, "a thread abandoned", [] { ASSERT_EQ(write(Blocking::ends()[1], "", 1), 1); });
}

}  // namespace
}  // namespace mauve
