// SPDX-License-Identifier: LGPL-3.0-or-later
/// A core that declares that it has no state, in answers and dry runs.
#include <gtest/gtest.h>

#include "support/positions.h"

namespace mauve {
namespace {

class BeginsAnew : public testing::Test {
 protected:
  void SetUp() override {
    ramp::written().clear();
    ASSERT_TRUE(deployer.deploy());
  }
  template <typename T>
  Result<Receipt> swap(StatePolicy policy = StatePolicy::keep) {
    return deployer.swap_core("control", CoreType::of<T>("test/next"), policy);
  }

  ramp::One<ramp::First> architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(BeginsAnew, SaysInAnswerAndDryRunThatAStatelessCoreBeginsAnew) {
  struct Plain : ramp::RampCore {
    Stateless stateless{*this};
    void update() override { shell().out.write(5.0); }
  };
  EXPECT_FALSE(swap<ramp::First>()->components[0].begins_anew) << "its state is kept";
  const Result<Receipt> dropped = swap<Plain>(StatePolicy::drop);
  EXPECT_FALSE(dropped->components[0].begins_anew) << "the answer names the state instead";

  Change change;
  change.edits.emplace_back();
  change.edits[0].member = "control";
  change.edits[0].core = CoreType::of<Plain>("test/next");
  Result<PreparedChange> prepared = deployer.prepare(change);
  ASSERT_TRUE(prepared) << to_string(prepared.error());
  EXPECT_TRUE(deployer.foresee(*prepared).components[0].begins_anew);
  Retired retired;
  EXPECT_TRUE(deployer.commit(*prepared, retired)->components[0].begins_anew);

  Change priority;
  priority.edits.emplace_back();
  priority.edits[0].member = "control";
  priority.edits[0].task = architecture.control.task();
  const Result<Receipt> done = deployer.apply(priority);
  ASSERT_TRUE(done) << to_string(done.error());
  ASSERT_FALSE(done->components.empty());
  EXPECT_FALSE(done->components[0].begins_anew) << "its core stays";
}

}  // namespace
}  // namespace mauve
