// SPDX-License-Identifier: LGPL-3.0-or-later
/// Two writers of one output, and outputs without a connection.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arch/build/check_rules.h"
#include "model/component/wiring.h"
#include "plugin/load/catalog.h"
#include "support/outcomes.h"

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/plugin.h>

namespace mauve {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

struct PilotShell : Shell {
  WritePort<double> speed{*this, "speed", Safe{0.0}};
  WritePort<double> horn{*this, "horn", Safe{0.0}, Need::optional};
  ReadPort<double> map{*this, "map", Need::required};
  WritePort<double> log{*this, "log"};
};
struct Pilot : Core<PilotShell> {
  void update() {}
};
struct MotorShell : Shell {
  ReadPort<double> command{*this, "command", Need::usual, Writers::one};
  ReadPort<double> trim{*this, "trim", Need::optional};
};
struct Motor : Core<MotorShell> {
  void update() {}
};
struct Valve : Core<EmptyShell> {
  void open(const double& /*how*/) {}
};
struct ValveInterface : Interface<Valve> {
  WriteService<double> open{*this, "open", &Valve::open, Writers::one};
};

struct Robot : Architecture {
  SharedData<double> command{*this, "command"};
  SharedData<double> shared{*this, "shared"};
  RingBuffer<double> queue{*this, "queue"};
  Resource<EmptyShell, Valve, ValveInterface> valve{*this, "valve"};
  Component<PilotShell, Pilot, PeriodicFsm<Pilot>> human{*this, "human"};
  Component<PilotShell, Pilot, PeriodicFsm<Pilot>> machine{*this, "machine"};
  Component<MotorShell, Motor, PeriodicFsm<Motor>> motor{*this, "motor"};

  Robot() {
    motor.shell().command.connect(command.read_service());
    human.shell().speed.connect(command.write_service());
  }
};

Edit connect(const char* component, const char* port, const char* service) {
  Edit edit;
  edit.member = component;
  edit.connect.push_back({port, service, {}});
  return edit;
}

Edit disconnect(const char* component, const char* port) {
  Edit edit;
  edit.member = component;
  edit.disconnect.emplace_back(port);
  return edit;
}

/// The port `speed`.
bool is_connected(const ComponentBase& component) {
  return component.bundle()->bindings->front() != nullptr;
}

std::vector<std::string> notes_of(const Architecture& architecture) {
  std::vector<std::string> texts;
  for (const auto& note : Wiring(architecture).notes()) texts.push_back(to_string(note));
  return texts;
}

TEST(ExclusiveOutput, RefusesASecondWriterBeforeTheStart) {
  Robot robot;
  robot.machine.shell().speed.connect(robot.command.write_service());

  const Status done = robot.configure();

  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::conflict);
  EXPECT_EQ(done.error().at, "machine.ports.speed");
  EXPECT_THAT(done.error().message, HasSubstr("second writer of command.write"));
  EXPECT_THAT(done.error().message, HasSubstr("motor.ports.command obeys its values"));
  EXPECT_THAT(done.error().message, HasSubstr("human.ports.speed writes into it"));
}

TEST(ExclusiveOutput, OfAServiceRefusesASecondWriter) {
  Robot robot;
  robot.human.shell().horn.connect(robot.valve.interface().open);
  robot.machine.shell().horn.connect(robot.valve.interface().open);

  const Status done = robot.configure();

  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("second writer of valve.open: human.ports.horn"));
}

class ExclusiveOutputAtRunTime : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(deployer.deploy()); }

  Robot robot;
  Deployer deployer{robot, {.simulated = true}};
};

TEST_F(ExclusiveOutputAtRunTime, RefusesASecondWriterAndNamesTheNewOne) {
  // By name the new writer comes before the other one.
  ASSERT_TRUE(deployer.apply({{disconnect("human", "speed")}}));
  ASSERT_TRUE(deployer.apply({{connect("machine", "speed", "command.write")}}));

  const auto done = deployer.apply({{connect("human", "speed", "command.write")}});

  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().at, "human.ports.speed");
  EXPECT_THAT(done.error().message, HasSubstr("machine.ports.speed writes into it"));
  EXPECT_EQ(deployer.generation(), 3u);
}

TEST_F(ExclusiveOutputAtRunTime, ChangesHandsInOneChange) {
  EXPECT_TRUE(deployer.apply(
      {{connect("machine", "speed", "command.write"), disconnect("human", "speed")}}));
}

TEST_F(ExclusiveOutputAtRunTime, HasOneWriterAfterARollbackToo) {
  Change leave{{disconnect("human", "speed")}};
  leave.probation = Probation{};
  ASSERT_TRUE(deployer.apply(leave));

  const auto take = deployer.apply({{connect("machine", "speed", "command.write")}});
  ASSERT_TRUE(take) << to_string(take.error());
  EXPECT_THAT(take->notes, ElementsAre(HasSubstr("back to before generation 2")))
      << "both have one rollback: to the one writer before";
  ASSERT_TRUE(deployer.undo());
  deployer.run_for(50ms);
  EXPECT_THAT(test::tend(deployer), SizeIs(1));

  EXPECT_TRUE(is_connected(robot.human));
  EXPECT_FALSE(is_connected(robot.machine));
}

TEST_F(ExclusiveOutputAtRunTime, ThatJoinsIsRefusedWhereTwoWriteAlready) {
  ASSERT_TRUE(deployer.apply({{disconnect("motor", "command")}}));
  const auto second = deployer.apply({{connect("machine", "speed", "command.write")}});
  ASSERT_TRUE(second) << "nothing obeys these values now";
  EXPECT_THAT(second->warnings, Contains(HasSubstr("command.write has 2 writers")));

  EXPECT_FALSE(deployer.apply({{connect("motor", "command", "command.read")}}));
}

TEST(ExclusiveOutput, KnowsItsOnlyWriter) {
  Robot robot;
  robot.human.shell().log.connect(robot.shared.write_service());
  robot.human.shell().horn.connect(robot.valve.interface().open);
  ASSERT_TRUE(robot.configure());
  const Wiring wiring(robot);

  EXPECT_EQ(wiring.only_writer(robot.command.write_service()), "human.ports.speed");
  EXPECT_EQ(wiring.only_writer(robot.valve.interface().open), "human.ports.horn");
  EXPECT_EQ(wiring.only_writer(robot.shared.write_service()), "") << "others may write too";
}

TEST(Notes, NameOutputsAndRequiredPortsWithoutConnectionAndNoOptionalOnes) {
  Robot robot;
  ASSERT_TRUE(robot.configure());

  EXPECT_THAT(
      notes_of(robot),
      ElementsAre("human.ports.map is not connected, but its component expects a connection",
                  "machine.ports.speed is not connected: its values, and its safe value, reach "
                  "nothing",
                  "machine.ports.map is not connected, but its component expects a connection"));
}

TEST_F(ExclusiveOutputAtRunTime, WithoutAnyWriterIsNotedUnlessItIsOptional) {
  const auto done = deployer.apply({{disconnect("motor", "command")}});

  ASSERT_TRUE(done);
  const auto note =
      "motor.ports.command is not connected: each read returns the default of the port, and never "
      "data";
  EXPECT_THAT(done->warnings, Contains(note));
  EXPECT_THAT(notes_of(robot), Contains(note));
  EXPECT_THAT(notes_of(robot), Not(Contains(HasSubstr("motor.ports.trim"))));
}

TEST(Notes, NameTheWritersOfOneValueAndNotThoseOfAQueue) {
  Robot robot;
  robot.human.shell().map.connect(robot.shared.read_service());
  robot.machine.shell().map.connect(robot.shared.read_service());
  robot.machine.shell().speed.connect(robot.queue.write_service());
  robot.human.shell().log.connect(robot.shared.write_service());
  robot.machine.shell().log.connect(robot.shared.write_service());
  robot.human.shell().horn.connect(robot.queue.write_service());
  ASSERT_TRUE(robot.configure());

  EXPECT_THAT(notes_of(robot), ElementsAre("shared.write has 2 writers, and the last value counts: "
                                           "human.ports.log, machine.ports.log"));
}

TEST_F(ExclusiveOutputAtRunTime, MayHaveAWatchdogBelowItsBudgetWhichIsNoted) {
  Edit edit;
  edit.member = "motor";
  edit.task = robot.motor.task();
  edit.task->budget = 3ms;
  edit.task->watchdog = 1ms;

  const auto done = deployer.apply({{edit}});

  ASSERT_TRUE(done) << to_string(done.error());
  const auto note =
      "motor.task.watchdog is 1ms, below the budget of 3ms: it ends jobs within the budget, and "
      "takes them for hung";
  EXPECT_THAT(done->warnings, Contains(note));
  EXPECT_THAT(notes_of(robot), Contains(note));
}

struct DriverOfADevice : Core<EmptyShell> {
  Stateless stateless{*this};
  Property<std::string> device{*this, "device", "pty:one", "", {.within = "/dev/ pty:"}};
  Property<double> gain{*this, "gain", 1.0};
  void update() {}
};
struct TwoDrivers : Architecture {
  Component<EmptyShell, DriverOfADevice, PeriodicFsm<DriverOfADevice>> base{*this, "base"};
  Component<EmptyShell, DriverOfADevice, PeriodicFsm<DriverOfADevice>> second{*this, "second"};
};

/// Two paths may come to mean one device, when it is plugged in again.
TEST(Devices, ThatHaveBecomeOneBlameNoChangeOfAnotherValue) {
  TwoDrivers robot;
  Deployer deployer(robot, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  EXPECT_TRUE(deployer.set("base.core.gain", 2.0));
  ASSERT_TRUE(deployer.set("base.core.device", std::string("pty:two")));
  const auto refused = deployer.set("base.core.device", std::string("pty:one"));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().id, "device_has_driver");
  EXPECT_EQ(refused.error().at, "base.core.device");
}

struct DriverOfTwoDevices : DriverOfADevice {
  Property<std::string> spare{*this, "spare", "pty:two", "", {.within = "/dev/ pty:"}};
};
struct ThreeDevices : Architecture {
  Component<EmptyShell, DriverOfADevice, PeriodicFsm<DriverOfADevice>> base{*this, "base"};
  Component<EmptyShell, DriverOfTwoDevices, PeriodicFsm<DriverOfTwoDevices>> second{*this,
                                                                                    "second"};
  Status on_configure() override {
    second.core().device = "pty:three";
    return ok();
  }
};

TEST(Devices, OfOneCoreAreAllCompared) {
  ThreeDevices robot;
  Deployer deployer(robot, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  const auto refused = deployer.set("second.core.spare", std::string("pty:one"));
  const auto other = deployer.set("base.core.device", std::string("pty:two"));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().id, "device_has_driver");
  EXPECT_EQ(refused.error().at, "second.core.spare");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().at, "base.core.device");
}

struct ShellWithADevice : Shell {
  Property<std::string> device{*this, "device", "pty:one", "", {.within = "/dev/ pty:"}};
};
struct CoreOfThatShell : Core<ShellWithADevice> {
  Stateless stateless{*this};
  void update() {}
};
struct DeviceOfAShell : Architecture {
  Component<ShellWithADevice, CoreOfThatShell, PeriodicFsm<CoreOfThatShell>> base{*this, "base"};
  Component<EmptyShell, DriverOfADevice, PeriodicFsm<DriverOfADevice>> second{*this, "second"};
  Status on_configure() override {
    second.core().device = "pty:two";
    return ok();
  }
};

TEST(Devices, ThatDriversShareMayBeThatOfSeveral) {
  TwoDrivers robot;
  robot.second.core().device = "pty:two";
  Deployer deployer(robot, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  for (const std::string shared :
       {"/dev/i2c-1", "/dev/gpiochip0", "/dev/input/event3", "/dev/null"}) {
    EXPECT_TRUE(deployer.set("base.core.device", shared));
    EXPECT_TRUE(deployer.set("second.core.device", shared)) << shared;
  }
  ASSERT_TRUE(deployer.set("base.core.device", std::string("/dev/ttyUSB7")));
  EXPECT_FALSE(deployer.set("second.core.device", std::string("/dev/ttyUSB7")));
}

TEST(Devices, OfAShellAreComparedToo) {
  DeviceOfAShell robot;
  Deployer deployer(robot, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  const auto of_core = deployer.set("second.core.device", std::string("pty:one"));
  const auto of_shell = deployer.set("base.shell.device", std::string("pty:two"));

  ASSERT_FALSE(of_core);
  EXPECT_EQ(of_core.error().id, "device_has_driver");
  ASSERT_FALSE(of_shell);
  EXPECT_EQ(of_shell.error().at, "base.shell.device");
}

TEST(Notes, NameTransactionsThatWouldAddASecondWriter) {
  using rules::Action;
  Robot robot;
  const rules::Step take{Action::connect, "machine.ports.speed", "command.write", {}};
  const rules::Step give{Action::disconnect, "human.ports.speed", "", {}};
  rules::Supervision supervision;
  supervision.transactions = {{"take", {take}}, {"change_hands", {give, take}}};
  ASSERT_TRUE(robot.configure());
  const auto when = rules::Condition::parse("motor.missed > 3");
  ASSERT_TRUE(when);
  supervision.rules.push_back({"alone", *when, {}, {}, "", {take}});
  supervision.rules.push_back({"leave", *when, {}, {}, "", {give}});

  const plugin::Catalog catalog;
  const auto notes = arch::notes_on(supervision, robot, catalog);

  ASSERT_THAT(notes, SizeIs(2));
  EXPECT_EQ(notes[0].address, "transactions.take");
  EXPECT_THAT(notes[0].text, HasSubstr("is refused when it fires"));
  EXPECT_THAT(notes[0].text, HasSubstr("machine.ports.speed would be the second writer of "
                                       "command.write"));
  EXPECT_EQ(notes[1].address, "rules.alone.do");
}

TEST_F(ExclusiveOutputAtRunTime, IsWarnedOfOnlyByTheChangeThatLeavesItAlone) {
  const auto other = deployer.apply({{connect("human", "log", "shared.write")}});
  ASSERT_TRUE(other);
  EXPECT_THAT(other->warnings, Not(Contains(HasSubstr("is not connected"))));

  const auto alone = deployer.apply({{disconnect("human", "speed")}});
  ASSERT_TRUE(alone);
  EXPECT_THAT(alone->warnings,
              Contains("human.ports.speed loses its connection: the change writes its safe value "
                       "into command.write, and its later values reach nothing"));
  EXPECT_THAT(notes_of(robot), Contains(HasSubstr("human.ports.speed is not connected")));
}

}  // namespace
}  // namespace mauve
