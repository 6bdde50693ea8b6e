// SPDX-License-Identifier: LGPL-3.0-or-later
/// A ramp on a simulated clock whose core is swapped on probation.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <typeinfo>
#include <vector>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve::test {

class UnderProbation : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(100ms);
  }
  template <typename T>
  Result<Receipt> swap_to(Probation probation = {}) {
    Change change{{ramp::to_core<T>(class_name(typeid(T)))}};
    change.probation = probation;
    return deployer.apply(change);
  }
  std::vector<Outcome> tend() { return test::tend(deployer); }
  /// The outcomes of the change on probation when so much time has passed.
  Outcome end_after(Duration time) {
    deployer.run_for(time);
    const std::vector<Outcome> ends = tend();
    EXPECT_EQ(ends.size(), 1u);
    return ends.size() == 1 ? ends[0] : Outcome{};
  }
  /// The same, and it rolled back to the core `before`.
  Outcome rolled_back_after(Duration time, const std::string& before, const std::string& reason) {
    Outcome end = end_after(time);
    EXPECT_EQ(end.kind, Outcome::Kind::rolled_back);
    EXPECT_EQ(end.reason, reason);
    EXPECT_EQ(core(), before);
    return end;
  }
  std::string core() { return deployer.status("control").core; }

  ramp::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

}  // namespace mauve::test
