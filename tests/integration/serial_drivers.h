// SPDX-License-Identifier: LGPL-3.0-or-later
/// One driver of a serial device on a simulated clock.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/observable.h>
#include <mauve/serial/serial_port.h>

#include "arch/build/load.h"
#include "plugin/load/catalog.h"
#include "support/eventually.h"
#include "support/proved_deployer.h"

namespace serial {

using namespace std::chrono_literals;  // NOLINT: durations
using mauve::Value;
using mauve::serial::PseudoTerminal;

/// A driver "driver" of `kind`, whose output goes to the resource "data".
inline std::string driver(const std::string& kind, const std::string& type, const std::string& port,
                          const std::string& device, const std::string& more = {}) {
  return R"({"schema": "mauve/architecture/1", "name": "line", "plugins": ["types", "drivers"],
    "resources": {"data": {"type": "shared_data", "data": ")" +
         type + R"("}}, "components": {"driver": {"type": ")" + kind +
         R"(", "properties": {"core.device": ")" + device + "\"" + more + R"(}, "ports": {")" +
         port + R"(": "data.write"}}}})";
}

inline std::string gnss(const std::string& device, const std::string& more = {}) {
  return driver("drivers/gnss", "gnss_fix/1", "fix", device, more);
}

/// An architecture deployed without threads. One that does not load ends the test with the reason.
class Simulated {
 public:
  explicit Simulated(const std::string& text) : catalog_({MAUVE_PLUGIN_DIR}) {
    mauve::arch::Problems problems;
    architecture_ = mauve::arch::load(text, catalog_, problems);
    if (architecture_ == nullptr) {
      std::string why = "does not load: " + text;
      for (const auto& problem : problems.sorted()) why += "\n" + to_string(problem, "");
      throw std::runtime_error(why);
    }
    deployer_ = std::make_unique<mauve::test::ProvedDeployer>(
        *architecture_, mauve::DeployOptions{mauve::Realtime::off, true, mauve::Admission::warn});
    up_ = deployer_->deploy();
  }

  [[nodiscard]] const mauve::Status& up() const { return up_; }
  void run(mauve::Duration duration) { deployer_->run_for(duration); }
  [[nodiscard]] std::string state() const { return deployer_->status("driver").fsm_state; }

  [[nodiscard]] std::int64_t observe(const std::string& name,
                                     const std::string& owner = "driver") const {
    const Value value = architecture_->find_component(owner)->core().find_observable(name)->value();
    if (const auto* yes = value.get_if<bool>()) return *yes ? 1 : 0;
    return *value.get_if<std::int64_t>();
  }
  /// Of a warning of the driver that lasts, else empty.
  [[nodiscard]] std::string warning(const std::string& name) const {
    const auto& core = architecture_->find_component("driver")->core();
    const auto* warning = dynamic_cast<const mauve::Warning*>(core.find_observable(name));
    return warning != nullptr && warning->lasts() ? std::string(warning->reason()) : std::string();
  }

  /// Sends it and waits, at the same instant, until the line's thread has all of it.
  void take(const PseudoTerminal& line, std::string_view bytes) const {
    const std::int64_t all = observe("received") + static_cast<std::int64_t>(bytes.size());
    ASSERT_TRUE(line.send(bytes));
    const auto until = std::chrono::steady_clock::now() + 20s;
    while (observe("received") < all) {
      ASSERT_LT(std::chrono::steady_clock::now(), until);
      std::this_thread::yield();
    }
  }
  /// Lets time pass until it is so much.
  [[nodiscard]] bool reaches(const std::string& name, std::int64_t least,
                             const std::string& owner = "driver") {
    return mauve::test::eventually([&] {
      run(10ms);
      return observe(name, owner) >= least;
    });
  }

  /// The value of resource "data" now.
  template <typename T>
  [[nodiscard]] T data() const {
    T value;
    mauve::Cursor cursor;
    (void)architecture_->find_resource("data")->find_service("read")->read(&value, cursor);
    return value;
  }

 private:
  mauve::plugin::Catalog catalog_;
  std::unique_ptr<mauve::Architecture> architecture_;
  std::unique_ptr<mauve::test::ProvedDeployer> deployer_;
  mauve::Status up_ = mauve::ok();
};

}  // namespace serial
