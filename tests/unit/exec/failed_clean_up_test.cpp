// SPDX-License-Identifier: LGPL-3.0-or-later
/// A core whose on_cleanup() does not end stays in memory: its destructor would end the process.
#include <gtest/gtest.h>

#include <exception>
#include <stdexcept>

#include "support/ramp.h"

namespace mauve {
namespace {

/// It closes its device after what may fail, and its destructor, like that of a thread that nobody
/// joined, ends the process.
struct Unclosed : ramp::RampCore {
  State<ramp::Position> state{*this};

  ~Unclosed() override {
    if (!closed_) std::terminate();
  }
  void update() override {}
  Status on_configure() override {
    closed_ = false;
    return ok();
  }
  void on_cleanup() override {
    throw std::runtime_error("the device does not answer");
    closed_ = true;
  }

 private:
  bool closed_ = true;
};

struct Joined : ramp::RampCore {
  State<ramp::Position> state{*this};
  void update() override {}
};

TEST(FailedCleanUp, LeavesTheCoreInMemoryAndIsReturned) {
  ramp::One<Unclosed> architecture;
  Deployer deployer{architecture, {.simulated = true}};
  ASSERT_TRUE(deployer.deploy());
  deployer.run_for(50ms);
  auto prepared = deployer.prepare(Change{{ramp::to_core<Joined>("joined")}});
  ASSERT_TRUE(prepared);
  Retired retired;
  ASSERT_TRUE(deployer.commit(*prepared, retired));
  deployer.run_for(50ms);
  retired.merge(deployer.collect());

  const Status cleaned = retired.release();

  ASSERT_FALSE(cleaned);
  EXPECT_NE(cleaned.error().message.find("does not answer"), std::string::npos)
      << to_string(cleaned.error());
}

}  // namespace
}  // namespace mauve
