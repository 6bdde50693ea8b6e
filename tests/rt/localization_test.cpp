// SPDX-License-Identifier: LGPL-3.0-or-later
/// No heap call in the services of the localization, whatever they are given.
#include <gtest/gtest.h>

#include <limits>

#include "../../plugins/localization/ekf_resource.h"
#include "../../plugins/localization/gnss_to_utm.h"
#include "rt/heap_probe.h"

#include <mauve/host/architecture.h>

namespace localization {
namespace {

struct Localized : mauve::Architecture {
  mauve::Resource<GnssToUtmShell, GnssToUtmCore, GnssToUtmInterface> gnss{*this, "gnss"};
  mauve::Resource<mauve::EmptyShell, EkfCore, EkfInterface> ekf{*this, "ekf"};
  mauve::Status on_configure() override {
    return gnss.shell().pose.connect(ekf.interface().update_pose);
  }
};

/// One of each measurement at that time, then all questions; false: no place is known.
bool use(Localized& localized, double time, double latitude) {
  const rover::Twist twist{time, 1.0, 0.1};
  const rover::Imu imu{time - 0.01, 0.1, 0.0, 0.0, 0.1, true};
  const rover::GnssFix fix{time, latitude, 1.4744, 150.0, 0.9, 3, 9};
  const rover::Pose far{time - 0.02, 1e6, 1e6, 0.1};
  localized.ekf.interface().update_twist.write(&twist);
  localized.ekf.interface().update_imu.write(&imu);
  localized.gnss.interface().fix.write(&fix);
  localized.ekf.interface().update_pose.write(&far);
  rover::MotionState state;
  rover::Pose2D pose;
  mauve::Cursor cursor;
  const mauve::DataStatus status = localized.ekf.interface().predict.read(&state, cursor);
  localized.ekf.interface().pose.read(&pose, cursor);
  double at = time + 0.5;
  void* const arguments[] = {&at};
  localized.ekf.interface().predict_at.invoke(&state, arguments);
  return mauve::has_value(status);
}

TEST(RealTimePath, CallsNoHeapInTheLocalization) {
  Localized localized;
  ASSERT_TRUE(localized.configure());
  mauve::this_job().start = 1'000'000'000;
  use(localized, 1.0, 43.5661);
  const std::size_t before = heap::calls();
  heap::watch_this_thread(true);
  int placed = 0;

  for (int i = 1; i <= 1000; ++i) {
    mauve::this_job().start += 20'000'000;
    placed += use(localized, 1.0 + i * 0.02, 43.5661 + i * 1e-7) ? 1 : 0;
  }
  use(localized, std::numeric_limits<double>::quiet_NaN(), 200.0);
  mauve::this_job().start += 1'000'000'000'000;
  use(localized, 1.0 + 1000 * 0.02 + 1000.0, 43.5661);

  heap::watch_this_thread(false);
  mauve::this_job().start = 0;
  EXPECT_EQ(heap::calls() - before, 0u);
  EXPECT_GT(placed, 0) << "the filter knew where it was";
  EXPECT_TRUE(localized.cleanup());
}

}  // namespace
}  // namespace localization
