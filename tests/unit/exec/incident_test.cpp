// SPDX-License-Identifier: LGPL-3.0-or-later
/// The record of a failure that a task makes. The records of two failures of one component are not
/// mixed.
#include <gtest/gtest.h>

#include "support/outcomes.h"
#include "support/ramp.h"

namespace mauve {
namespace {

/// Throws in its fifth job.
struct ThrowsLater : ramp::Down {
  void update() override {
    if (++jobs_ == 5) throw std::runtime_error("sensor lost");
    ramp::Down::update();
  }

 private:
  int jobs_ = 0;
};

/// Takes longer than the period in every second job.
struct EndsLate : ramp::Down {
  void update() override {
    ramp::Down::update();
    if (++jobs_ % 2 == 0) clock()->advance(12ms);
  }
  static ManualClock*& clock() {
    static ManualClock* clock = nullptr;
    return clock;
  }

 private:
  int jobs_ = 0;
};

class IncidentTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(deployer.deploy());
    deployer.run_for(100ms);
    EndsLate::clock() =
        const_cast<ManualClock*>(dynamic_cast<const ManualClock*>(&deployer.clock()));
  }
  /// Of the end of a change to this core, which comes within 200 ms.
  template <typename T>
  std::optional<Incident> after_swap_to(bool undo = false) {
    Change change{{ramp::to_core<T>(class_name(typeid(T)))}};
    change.probation = Probation{.misses = 2, .window = 10};
    EXPECT_TRUE(deployer.apply(change));
    if (undo) {
      EXPECT_TRUE(deployer.undo("not wanted"));
    }
    deployer.run_for(200ms);
    const std::vector<Outcome> ends = test::tend(deployer);
    EXPECT_EQ(ends.size(), 1u);
    return ends.size() == 1 ? ends[0].incident : std::nullopt;
  }

  ramp::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(IncidentTest, EachRollbackHasARecordOfItsOwn) {
  const auto first = after_swap_to<ThrowsLater>();
  const auto second = after_swap_to<EndsLate>();

  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->cause, "threw");
  EXPECT_EQ(first->text, "sensor lost");
  EXPECT_EQ(first->core, class_name(typeid(ThrowsLater)));
  EXPECT_EQ(first->state, "update");
  EXPECT_EQ(second->cause, "overran too often");
  EXPECT_EQ(second->text, "");
  EXPECT_EQ(second->core, class_name(typeid(EndsLate)));
  EXPECT_GT(Duration{second->time - first->time}, 100ms) << "each when it failed";
  EXPECT_GT(second->job, first->job);
}

TEST_F(IncidentTest, AnUndoIsNone) { EXPECT_FALSE(after_swap_to<ramp::Down>(true)); }

}  // namespace
}  // namespace mauve
