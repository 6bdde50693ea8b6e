// SPDX-License-Identifier: LGPL-3.0-or-later
/// Hooks that do not return while a change is prepared: the thread that runs them is abandoned,
/// and another one goes on.
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <optional>
#include <thread>

#include "model/job/abandonable_thread.h"
#include "support/eventually.h"
#include "support/ramp.h"

namespace mauve {
namespace {

using test::eventually;

/// While this is true, the hooks of this file do not return.
std::atomic<bool>& closed() {
  static std::atomic<bool> closed{true};
  return closed;
}
void wait_until_open() {
  while (closed()) std::this_thread::yield();
}

struct StuckHook : ramp::Up {
  Status on_configure() override {
    Status done = Up::on_configure();
    wait_until_open();
    return done;
  }
};
struct StuckConstructor : ramp::Up {
  StuckConstructor() { wait_until_open(); }
};
struct Refusing : ramp::Up {
  ~Refusing() override { wait_until_open(); }
  Status on_configure() override { return invalid(step, "is not to its liking"); }
};

class Abandoned : public testing::Test {
 protected:
  void SetUp() override {
    closed() = true;
    configured_ = ramp::Up::configured_cores();
    ASSERT_TRUE(deployer.deploy());
  }
  void TearDown() override { open(); }

  template <typename T>
  static Edit edit() {
    Edit edit;
    edit.member = "control";
    edit.core = CoreType::of<T>("test/core");
    return edit;
  }
  /// Prepares on a thread that can be abandoned.
  template <typename T>
  void prepare() {
    thread_ = std::thread([this] {
      thread_in_hook.begin_here();
      prepared.emplace(deployer.prepare({{edit<T>()}}));
    });
  }
  bool is_in(const std::string& hook) {
    return eventually([&] { return thread_in_hook.hook() == hook; });
  }
  bool leave() {
    return eventually([&] { return thread_in_hook.abandon(); });
  }
  void open() {
    closed() = false;
    if (thread_.joinable()) thread_.join();
  }

  ramp::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
  AbandonableThread thread_in_hook;
  std::optional<Result<PreparedChange>> prepared;
  int configured_ = 0;
  std::thread thread_;
};

TEST_F(Abandoned, AnotherThreadPreparesTheNextChangeAndTheLateOneIsCleanedUp) {
  prepare<StuckHook>();
  ASSERT_TRUE(is_in("control.core on_configure"));
  ASSERT_TRUE(leave());

  deployer.run_for(50ms);
  const Result<Receipt> next = deployer.swap_core<ramp::Down>("control");
  deployer.run_for(20ms);

  ASSERT_TRUE(next) << to_string(next.error());
  EXPECT_EQ(ramp::read(architecture.position), 3.0);
  EXPECT_EQ(deployer.status("control").missed, 0u);

  open();
  ASSERT_FALSE(*prepared);
  EXPECT_EQ(prepared->error().code, Errc::timed_out);
  EXPECT_EQ(ramp::Up::configured_cores(), configured_) << "cleaned up where it was made";
  EXPECT_EQ(deployer.generation(), 2u);
}

TEST_F(Abandoned, AConstructorIsDropped) {
  prepare<StuckConstructor>();
  ASSERT_TRUE(is_in("control.core constructor"));
  ASSERT_TRUE(leave());
  ASSERT_TRUE(deployer.swap_core<ramp::Up>("control"));

  open();

  EXPECT_FALSE(*prepared);
  EXPECT_EQ(deployer.generation(), 2u);
}

TEST_F(Abandoned, ADestructorOfWhatWasRefusedHoldsNobodyUp) {
  prepare<Refusing>();
  ASSERT_TRUE(is_in("control destructor"));
  ASSERT_TRUE(leave());

  EXPECT_TRUE(deployer.swap_core<ramp::Up>("control"));
}

TEST_F(Abandoned, ARollbackGetsIntoTheBooks) {
  Change change{{edit<ramp::Down>()}};
  change.probation.emplace();
  ASSERT_TRUE(deployer.apply(change));
  prepare<StuckHook>();
  ASSERT_TRUE(is_in("control.core on_configure"));
  ASSERT_TRUE(deployer.undo());
  deployer.run_for(50ms);
  EXPECT_EQ(deployer.generation(), 2u) << "who prepares relies on the model";

  ASSERT_TRUE(leave());

  Retired retired;
  EXPECT_EQ(deployer.tend(retired).size(), 1u);
  EXPECT_EQ(deployer.generation(), 3u);
}

TEST_F(Abandoned, WhoIsNotLeftIsWaitedFor) {
  prepare<StuckHook>();
  ASSERT_TRUE(is_in("control.core on_configure"));
  auto other = std::async(std::launch::async,
                          [&] { return deployer.prepare({{edit<ramp::Down>()}}).has_value(); });

  open();

  EXPECT_TRUE(prepared->has_value());
  EXPECT_TRUE(other.get());
  EXPECT_FALSE(thread_in_hook.abandoned());
}

}  // namespace
}  // namespace mauve
