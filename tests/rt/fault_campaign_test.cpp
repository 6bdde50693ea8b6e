// SPDX-License-Identifier: LGPL-3.0-or-later
/// One component crashes, loops and blocks, again and again; a 1 kHz component beside it misses not
/// one release, under CPU load.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include <unistd.h>

#include "rt/rescue.h"
#include "support/campaign.h"
#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::eventually;

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

struct Pair : Architecture {
  SharedData<double> bad_position{*this, "bad_position"};
  SharedData<double> good_position{*this, "good_position"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> bad{*this, "bad"};
  Component<ramp::Shell, ramp::Up, ramp::Fsm> good{*this, "good"};

  Pair() {
    bad.fsm().period = 1ms;
    bad.task().priority = 40;
    bad.task().watchdog = 5ms;
    good.fsm().period = 1ms;
    good.task().priority = 80;
  }
  Status on_configure() override {
    if (auto done = bad.shell().out.connect(bad_position.write_service()); !done) return done;
    return good.shell().out.connect(good_position.write_service());
  }
};

class FaultCampaign : public testing::Test {
 protected:
  void SetUp() override {
    if (!rt::kCanRescue) GTEST_SKIP() << "the sanitizer handles faults itself";
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
    test::UnderLoad load(tally, [&] { return deployer.status("good").missed; });
    for (int i = 0; i < rounds; ++i) {
      const Result<Receipt> done =
          deployer.swap_core("bad", CoreType::of<Core>("bad"), StatePolicy::drop);
      ASSERT_TRUE(done) << to_string(done.error());
      if (deployer.status("bad").state != ComponentState::running) {
        static_cast<void>(deployer.start({"bad"}));
      }
      ASSERT_TRUE(
          eventually([&] { return deployer.status("bad").state == ComponentState::faulted; }));
      after();
      Retired free;
      static_cast<void>(deployer.tend(free));
      deployer.drain([](const Happening&) {});
      load.close_window();
    }
    const ComponentStatus good = deployer.status("good");
    std::printf("%d times %s: releases of the other %llu\n", rounds, what,
                static_cast<unsigned long long>(good.releases));
    EXPECT_EQ(good.state, ComponentState::running);
  }
};

TEST_F(FaultCampaign, OthersLoseNoReleaseInCrashes) {
  run<Crashing>(300, "a crash", [] {});
}

TEST_F(FaultCampaign, OthersLoseNoReleaseInEndlessLoops) {
  run<Looping>(200, "an endless loop", [] {});
}

TEST_F(FaultCampaign, OthersLoseNoReleaseWhenThreadsAreGivenUp) {
  run<Blocking>(100, "a thread given up", [] { ASSERT_EQ(write(Blocking::ends()[1], "", 1), 1); });
}

}  // namespace
}  // namespace mauve
