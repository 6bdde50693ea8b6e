// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/build/unguarded_devices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include <mauve/guarded.h>
#include <mauve/host/architecture.h>
#include <mauve/plugin.h>

namespace mauve::arch {
namespace {

struct CommandedShell : Shell {
  ReadPort<double> command{*this, "command", 0.0, Need::optional};
};

struct WheelCore : Core<CommandedShell> {
  using Contract = WheelCore;
  static constexpr const char* contract = "wheel/core/1";
  Property<std::string> device{*this, "device", "/dev/ttyUSB0", "its line", {.within = "/dev/"}};
  Stateless stateless{*this};
  void update() {}
};
struct GuardedWheelCore : WheelCore {
  Guarded stand{*this, "stand"};
};
using WheelFsm = PeriodicFsm<WheelCore>;

template <typename Wheel>
struct OneWheel : Architecture {
  SharedData<double> speed{*this, "speed"};
  Component<CommandedShell, Wheel, WheelFsm> wheel{*this, "wheel"};
};

TEST(UnguardedDevices, AreNotedOnceTheyAreCommanded) {
  OneWheel<WheelCore> machine;
  EXPECT_TRUE(unguarded_devices(machine).empty()) << "it only reads its device, as far as one sees";
  ASSERT_TRUE(machine.wheel.shell().command.connect(machine.speed.read_service()));

  const auto notes = unguarded_devices(machine);

  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].address, "wheel.core.device");
  EXPECT_THAT(notes[0].text, testing::HasSubstr("obeys the values of port command"));
}

TEST(UnguardedDevices, AreNoneWithAnOrder) {
  OneWheel<GuardedWheelCore> machine;
  ASSERT_TRUE(machine.wheel.shell().command.connect(machine.speed.read_service()));

  EXPECT_TRUE(unguarded_devices(machine).empty());
}

}  // namespace
}  // namespace mauve::arch
