// SPDX-License-Identifier: LGPL-3.0-or-later
// When the orders of guarded outputs go out, with no guardian.
#include "rt/guardian/guarded_component.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "rt/guardian/guarded_outputs.h"
#include "support/eventually.h"
#include "support/pipe_device.h"

namespace mauve::rt {
namespace {

using test::PipeDevice;

/// `drives` has a core that holds an output, and commands its device.
class SafeOrders : public testing::Test {
 protected:
  SafeOrders() {
    EXPECT_TRUE(outputs_.expect(GuardianUse::off, nullptr));
    drives_.emplace("drives");
    drives_->put_in_force(&core_, &shell_, true);
  }
  ~SafeOrders() override {
    drives_.reset();
    outputs_.leave();
  }

  /// The address of the holder is that of the owner, too: each holds one output.
  [[nodiscard]] Status hold(const int& holder, const PipeDevice& device,
                            const std::string& name = "drives.core.stand") {
    return outputs_.hold({&holder, &holder, name}, device.descriptor(), {.bytes = "stand "});
  }
  void drop(const int& holder) { outputs_.drop(&holder); }
  [[nodiscard]] static bool gets(PipeDevice& device, const std::string& bytes) {
    return test::eventually([&] { return device.bytes() == bytes; });
  }

  const int core_ = 1;
  const int next_core_ = 2;
  const int shell_ = 3;
  GuardedOutputs& outputs_ = GuardedOutputs::of_process();
  PipeDevice device_;
  PipeDevice other_device_;
  std::optional<GuardedComponent> drives_;
};

TEST_F(SafeOrders, GoOutWhenNoJobCommandsAnyMore) {
  ASSERT_TRUE(hold(core_, device_));
  EXPECT_TRUE(drives_->holds_any());

  drives_->stand();

  EXPECT_TRUE(gets(device_, "stand stand "));
}

TEST_F(SafeOrders, OfOtherComponentsStay) {
  GuardedComponent near("drive");
  GuardedComponent longer("drives2");
  ASSERT_TRUE(hold(core_, device_));

  near.stand();
  longer.stand();
  drop(core_);

  EXPECT_FALSE(near.holds_any());
  EXPECT_FALSE(longer.holds_any());
  EXPECT_EQ(device_.bytes(), "");
}

TEST_F(SafeOrders, GoOutBeforeTheDeviceIsLetGo) {
  ASSERT_TRUE(hold(core_, device_));

  drives_->stand();
  drop(core_);

  EXPECT_EQ(device_.bytes(), "stand stand ");
}

TEST_F(SafeOrders, GoOutAlsoWhenTheComponentGoesAtOnce) {
  ASSERT_TRUE(hold(core_, device_));

  drives_->stand();
  drives_.emplace("drives");
  drop(core_);

  EXPECT_EQ(device_.bytes(), "stand stand ");
}

TEST_F(SafeOrders, DoNotDisturbAComponentThatRunsAgain) {
  ASSERT_TRUE(hold(core_, device_));
  drives_->stand();
  ASSERT_TRUE(test::eventually([&] { return !device_.bytes().empty(); }));
  drives_->put_in_force(&core_, &shell_, true);
  drop(core_);
  const std::string before = device_.bytes();

  ASSERT_TRUE(hold(core_, device_));
  drop(core_);

  EXPECT_EQ(device_.bytes(), before);
}

TEST_F(SafeOrders, GoOutToADeviceThatTheNextCoreDoesNotHold) {
  ASSERT_TRUE(hold(core_, device_));
  ASSERT_TRUE(hold(next_core_, other_device_));

  drives_->put_in_force(&next_core_, &shell_, true);
  drop(core_);
  drop(next_core_);

  EXPECT_EQ(device_.bytes(), "stand stand ");
  EXPECT_EQ(other_device_.bytes(), "");
}

TEST_F(SafeOrders, StayWhileTheNextCoreHoldsTheDevice) {
  ASSERT_TRUE(hold(core_, device_));
  ASSERT_TRUE(hold(next_core_, device_));

  drives_->put_in_force(&next_core_, &shell_, true);
  drop(core_);

  EXPECT_EQ(device_.bytes(), "");
}

TEST_F(SafeOrders, StayWhileAnotherComponentCommandsTheDevice) {
  GuardedComponent successor("wheels");
  successor.put_in_force(&next_core_, &shell_, true);
  ASSERT_TRUE(hold(core_, device_));
  ASSERT_TRUE(hold(next_core_, device_, "wheels.core.stand"));

  drives_->stand();
  drop(core_);

  EXPECT_EQ(device_.bytes(), "");
}

TEST_F(SafeOrders, OfTheShellOutliveItsCores) {
  ASSERT_TRUE(hold(shell_, device_, "drives.shell.stand"));

  drives_->put_in_force(&next_core_, &shell_, true);
  drop(next_core_);
  EXPECT_EQ(device_.bytes(), "");

  drives_->put_in_force(&next_core_, &shell_, false);
  EXPECT_TRUE(gets(device_, "stand stand "));
}

TEST_F(SafeOrders, GoOutWhenTheDeviceComesBackWhileNoJobCommands) {
  ASSERT_TRUE(hold(core_, device_));
  drop(core_);
  drives_->stand();

  ASSERT_TRUE(hold(core_, device_));

  EXPECT_TRUE(gets(device_, "stand stand "));
}

TEST_F(SafeOrders, StayWhenTheDeviceComesBackWhileJobsCommand) {
  ASSERT_TRUE(hold(core_, device_));
  drop(core_);

  ASSERT_TRUE(hold(core_, device_));
  drop(core_);

  EXPECT_EQ(device_.bytes(), "");
}

/// Its hooks may be writing to the device.
TEST_F(SafeOrders, StayWhileACoreIsPreparedForAComponentThatStands) {
  drives_->stand();

  ASSERT_TRUE(hold(next_core_, device_));
  drop(next_core_);

  EXPECT_EQ(device_.bytes(), "");
}

TEST_F(SafeOrders, GoOutWhenAComponentThatStandsTakesACoreWithAnotherDevice) {
  drives_->stand();
  ASSERT_TRUE(hold(next_core_, other_device_));

  drives_->put_in_force(&next_core_, &shell_, false);

  EXPECT_TRUE(gets(other_device_, "stand stand "));
}

TEST_F(SafeOrders, GoOutBeforeAnEndInOrder) {
  ASSERT_TRUE(hold(core_, device_));

  drives_->stand();
  outputs_.say_goodbye();

  EXPECT_EQ(device_.bytes(), "stand stand ");
}

TEST_F(SafeOrders, GoOutOnceMoreWhenAnAbandonedJobEnds) {
  ASSERT_TRUE(hold(core_, device_));
  drives_->stand();
  ASSERT_TRUE(gets(device_, "stand stand "));

  drives_->repeat();

  EXPECT_TRUE(gets(device_, "stand stand stand stand "));
}

TEST_F(SafeOrders, StayWhenAnAbandonedJobEndsWhileAnotherOneCommands) {
  ASSERT_TRUE(hold(core_, device_));

  drives_->repeat();
  drop(core_);

  EXPECT_EQ(device_.bytes(), "");
}

TEST_F(SafeOrders, AreCountedWhenTheyFallDueSoThatOlderCommandsAreDropped) {
  EXPECT_EQ(outputs_.times_due(&core_), nullptr) << "it holds nothing";
  ASSERT_TRUE(hold(core_, device_));
  const std::atomic<std::uint32_t>* const times = outputs_.times_due(&core_);
  const std::uint32_t before = *times;

  drives_->put_in_force(&core_, &shell_, false);
  EXPECT_EQ(*times, before + 1);
  drives_->put_in_force(&core_, &shell_, true);
  drives_->repeat();
  EXPECT_EQ(*times, before + 1) << "a job commands";
  drives_->put_in_force(&next_core_, &shell_, true);
  EXPECT_EQ(*times, before + 2) << "the core left it";
}

TEST_F(SafeOrders, AreNotCountedWhenTheNextCoreCommandsTheDevice) {
  ASSERT_TRUE(hold(core_, device_));
  ASSERT_TRUE(hold(next_core_, device_));
  const std::uint32_t before = *outputs_.times_due(&core_);

  drives_->put_in_force(&next_core_, &shell_, true);

  EXPECT_EQ(*outputs_.times_due(&core_), before) << "the last command of the core before counts";
}

TEST_F(SafeOrders, GoOutOnceMoreToTheDeviceOfAnAbandonedJobThatIsNotCommanded) {
  ASSERT_TRUE(hold(core_, device_));
  ASSERT_TRUE(hold(next_core_, other_device_));
  drives_->put_in_force(&next_core_, &shell_, true);
  ASSERT_TRUE(gets(device_, "stand stand "));

  drives_->repeat();

  EXPECT_TRUE(gets(device_, "stand stand stand stand "));
  drop(next_core_);
  EXPECT_EQ(other_device_.bytes(), "");
}

TEST_F(SafeOrders, AreRepeatedForAnOwnerWhoseLastCommandCameLate) {
  ASSERT_TRUE(hold(core_, device_));
  outputs_.repeat(&core_);
  drives_->stand();
  ASSERT_TRUE(gets(device_, "stand stand ")) << "no order came while a job commanded";

  outputs_.repeat(&core_);

  EXPECT_TRUE(gets(device_, "stand stand stand stand "));
}

TEST_F(SafeOrders, GoOutToADeviceThatComesBackToACoreThatWasInForce) {
  ASSERT_TRUE(hold(core_, device_));
  drop(core_);
  drives_->put_in_force(&next_core_, &shell_, true);

  ASSERT_TRUE(hold(core_, device_));
  EXPECT_TRUE(gets(device_, "stand stand "));
  drop(core_);
  outputs_.forget_holder(&core_);
  ASSERT_TRUE(hold(core_, other_device_)) << "a core that is made at the same address";
  drop(core_);

  EXPECT_EQ(other_device_.bytes(), "");
}

/// The guardian that is required is not there, so every component stands.
TEST_F(SafeOrders, GoOutToADeviceThatComesBackAlsoWhenItsOutputIsRefused) {
  outputs_.leave();
  ASSERT_TRUE(outputs_.expect(GuardianUse::require, nullptr));
  outputs_.attach(-1);
  drives_->stand();

  EXPECT_FALSE(hold(core_, device_));

  EXPECT_THAT(device_.bytes(), testing::StartsWith("stand "));
}

/// Keeps the thread that it interrupts.
std::atomic<bool> keeps_thread{false};
std::atomic<bool> has_thread{false};
void keep_thread(int /*signal*/) {
  has_thread = true;
  while (keeps_thread) usleep(1000);
}

/// Of the thread that sends the orders; 0: it is not there.
pid_t sender() {
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(thread.path() / "comm"), name);
    if (name == "mauve-safe") return std::stoi(thread.path().filename());
  }
  return 0;
}

TEST_F(SafeOrders, GoOutAlsoWhenTheThreadThatSendsThemGetsNoProcessor) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer hands signals over later, maybe under the lock";
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
  GTEST_SKIP() << "the sanitizer hands signals over later, maybe under the lock";
#endif
#endif
  ASSERT_TRUE(hold(core_, device_));
  drives_->stand();
  ASSERT_TRUE(gets(device_, "stand stand "));
  drives_->put_in_force(&core_, &shell_, true);
  static_cast<void>(outputs_.names());  // the thread has left its lock, and sleeps for long
  std::signal(SIGUSR1, keep_thread);
  keeps_thread = true;
  ASSERT_EQ(tgkill(getpid(), sender(), SIGUSR1), 0);
  ASSERT_TRUE(test::eventually([] { return has_thread.load(); }));

  drives_->stand();
  drop(core_);
  keeps_thread = false;

  EXPECT_EQ(device_.bytes(), "stand stand stand ");
  std::signal(SIGUSR1, SIG_DFL);
}

TEST_F(SafeOrders, AreRefusedForADescriptorThatWouldMakeTheThreadWait) {
  fcntl(device_.descriptor(), F_SETFL, 0);

  const Status held = hold(core_, device_);

  ASSERT_FALSE(held);
  EXPECT_THAT(held.error().message, testing::HasSubstr("O_NONBLOCK"));
  EXPECT_FALSE(drives_->holds_any());
}

}  // namespace
}  // namespace mauve::rt
