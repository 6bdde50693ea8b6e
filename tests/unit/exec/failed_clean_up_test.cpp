// SPDX-License-Identifier: LGPL-3.0-or-later
/// A core whose on_cleanup() does not end stays in memory: its destructor would end the process.
#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

#include "support/ramp.h"

namespace mauve {
namespace {

/// Its thread is joined after what may fail.
struct Unjoined : ramp::RampCore {
  State<ramp::Position> state{*this};

  void update() override {}
  Status on_configure() override {
    helper_ = std::thread([] {});
    return ok();
  }
  void on_cleanup() override {
    throw std::runtime_error("the device does not answer");
    helper_.join();
  }

 private:
  std::thread helper_;
};

struct Joined : ramp::RampCore {
  State<ramp::Position> state{*this};
  void update() override {}
};

TEST(FailedCleanUp, LeavesTheCoreInMemoryAndIsReturned) {
  ramp::One<Unjoined> architecture;
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
