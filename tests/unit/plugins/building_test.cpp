// SPDX-License-Identifier: LGPL-3.0-or-later
/// From room to room through the building of etc/maps: way points of navigation/navigation, a law
/// of guidance, the pilot. 20 errands are driven by `scripts/bench robot`.
#include "support/building.h"

#include <gtest/gtest.h>

#include <vector>

#include "../../../plugins/world/random.h"
#include "support/drive.h"

namespace {

namespace drive = support::drive;
using support::building::Building;
using support::building::Errand;

class Errands : public testing::Test {
 protected:
  static constexpr double kNearest = 0.35;  // m, half of it the robot

  void SetUp() override {
    ASSERT_TRUE(building_.load(MAUVE_SOURCE_DIR));
    world::Random random(11);
    for (int i = 0; i < 2; ++i) errands_.push_back(building_.errand(random));
  }
  /// Seconds for all of them.
  double run(const drive::Law& law) {
    double seconds = 0.0;
    for (const Errand& errand : errands_) {
      const drive::Outcome done =
          building_.drive(drive::driven_by(law), errand, 1, support::building::conditions());
      EXPECT_TRUE(done.reached) << errand.to.x << ", " << errand.to.y;
      EXPECT_GT(done.clearance, kNearest);
      seconds += done.seconds;
    }
    return seconds;
  }

  Building building_;
  std::vector<Errand> errands_;
};

TEST_F(Errands, TakeFiniteTimeNotMuchLongerThanTheField) {
  const double field = run(support::building::field());
  const double finite_time = run(support::building::finite_time());

  EXPECT_LT(finite_time, 1.5 * field);
}

TEST_F(Errands, AreDoneByFiniteTimeWithItsOwnDistancesToo) {
  static_cast<void>(run(drive::finite_time()));
}

}  // namespace
