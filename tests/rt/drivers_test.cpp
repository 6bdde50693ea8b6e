// SPDX-License-Identifier: LGPL-3.0-or-later
/// Jobs of drivers and simulated devices touch no terminal and no heap, whatever becomes of the
/// line. The jobs run in the thread of the test, on a simulated clock.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <thread>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/serial/serial_port.h>

#include "arch/build/load.h"
#include "plugin/load/catalog.h"
#include "rt/heap_probe.h"
#include "rt/tty_probe.h"
#include "support/eventually.h"
#include "support/temp_dir.h"

namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using mauve::serial::PseudoTerminal;
using mauve::test::eventually;

class Driven {
 public:
  explicit Driven(const std::string& rest) : catalog_({MAUVE_PLUGIN_DIR}) {
    mauve::arch::Problems problems;
    architecture_ = mauve::arch::load(
        R"({"schema": "mauve/architecture/1", "name": "line", "plugins": ["types", "drivers"],)" +
            rest + "}",
        catalog_, problems);
    if (architecture_ == nullptr) {
      ADD_FAILURE() << "does not load: " << rest;
      return;
    }
    deployer_ = std::make_unique<mauve::Deployer>(
        *architecture_, mauve::DeployOptions{mauve::Realtime::off, true, mauve::Admission::warn});
    EXPECT_TRUE(deployer_->deploy());
  }

  /// Lets time pass, watched, until it is so much; nothing that is forbidden happens.
  [[nodiscard]] bool reaches(const std::string& owner, const std::string& name, double least) {
    return eventually([&] {
      run(10ms);
      return observe(owner, name) >= least;
    });
  }
  void run(mauve::Duration duration) {
    const std::size_t ttys = tty::calls();
    const std::size_t heaps = heap::calls();
    tty::watch_this_thread(true);
    heap::watch_this_thread(true);
    deployer_->run_for(duration);
    heap::watch_this_thread(false);
    tty::watch_this_thread(false);
    EXPECT_EQ(tty::calls() - ttys, 0U);
    EXPECT_EQ(heap::calls() - heaps, 0U);
  }
  [[nodiscard]] double observe(const std::string& owner, const std::string& name) const {
    const mauve::Value value =
        architecture_->find_component(owner)->core().find_observable(name)->value();
    return static_cast<double>(*value.get_if<std::int64_t>());
  }
  [[nodiscard]] std::uint64_t releases(const std::string& owner) const {
    return deployer_->status(owner).releases;
  }

 private:
  mauve::plugin::Catalog catalog_;
  std::unique_ptr<mauve::Architecture> architecture_;
  std::unique_ptr<mauve::Deployer> deployer_;
};

TEST(RealTimePath, OfDriversAndSimulatedDevicesTouchesNoTerminal) {
  Driven all(R"(
    "resources": {"world": {"type": "drivers/world"}},
    "components": {
      "scanner": {"type": "drivers/hokuyo_sim", "ports": {"world": "world.scan"}},
      "wheels": {"type": "drivers/create_sim", "ports": {"drive": "world.drive"}},
      "receiver": {"type": "drivers/receiver_sim", "ports": {"antenna": "world.antenna"}},
      "unit": {"type": "drivers/imu_sim", "ports": {"world": "world.imu"}},
      "laser": {"type": "drivers/hokuyo", "properties": {"core.device": "pty:laser"}},
      "base": {"type": "drivers/create", "properties": {"core.device": "pty:base"}},
      "gnss": {"type": "drivers/gnss", "properties": {"core.device": "pty:gnss"}},
      "imu": {"type": "drivers/imu", "properties": {"core.device": "pty:imu"}}})");

  EXPECT_TRUE(all.reaches("laser", "scans", 5));
  EXPECT_TRUE(all.reaches("base", "frames", 20));
  EXPECT_TRUE(all.reaches("gnss", "fixes", 5));
  EXPECT_TRUE(all.reaches("imu", "measurements", 20));
}

TEST(RealTimePath, OfADriverTouchesNoTerminalWhileItsDeviceGoesAndComes) {
  const mauve::test::TempDir place;
  const std::string path = (place / "base").string();
  Driven all(R"("components": {"base": {"type": "drivers/create",
    "properties": {"core.device": ")" +
             path + R"("}}})");
  PseudoTerminal line;
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(line.open(path));
    EXPECT_TRUE(all.reaches("base", "reopened", i));
    line.close();
    EXPECT_TRUE(all.reaches("base", "device_errors", i + 1));
  }
}

TEST(RealTimePath, OfADriverGoesOnWhenTheFarEndReadsNothing) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  Driven all(R"("components": {"base": {"type": "drivers/create",
    "properties": {"core.device": ")" +
             line.device() + R"("}}})");

  // Until the terminal is full, and then what may wait for it: each job is there all the same.
  EXPECT_TRUE(all.reaches("base", "unsent", 100));
  const std::uint64_t before = all.releases("base");
  all.run(15s);
  EXPECT_GE(all.releases("base") - before, 900U);
}

TEST(TtyProbe, SeesAReadAndAWriteOfATerminal) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  std::array<char, 4> bytes{};
  const std::size_t before = tty::calls();
  tty::watch_this_thread(true);
  static_cast<void>(line.receive(bytes));
  static_cast<void>(line.send("x"));
  tty::watch_this_thread(false);

  EXPECT_EQ(tty::calls() - before, 2U) << "a detector that sees nothing proves nothing";
}

TEST(TtyProbe, SeesThemInPlugins) {
  // The brake is asked by a thread that is no component's: it writes by itself.
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  mauve::plugin::Catalog catalog({MAUVE_PLUGIN_DIR});
  mauve::arch::Problems problems;
  const auto architecture = mauve::arch::load(
      R"({"schema": "mauve/architecture/1", "name": "line", "plugins": ["types", "drivers"],
         "resources": {"brake": {"type": "drivers/create_brake",
                                 "properties": {"core.device": ")" +
          line.device() + R"("}}}})",
      catalog, problems);
  ASSERT_NE(architecture, nullptr);
  ASSERT_TRUE(architecture->configure());
  const std::size_t before = tty::calls();
  const std::array<double, 2> velocity{};
  std::thread([&] {
    tty::watch_this_thread(true);
    architecture->find_resource("brake")->find_service("write")->write(velocity.data());
  }).join();

  EXPECT_GE(tty::calls() - before, 1U);
  std::array<char, 16> bytes{};
  EXPECT_EQ(line.receive(bytes), 5U) << "and it is there when the call returns";
  EXPECT_TRUE(architecture->cleanup());
}

}  // namespace
