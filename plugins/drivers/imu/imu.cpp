// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "drivers/imu_xbus" of component kind "drivers/imu": Xsens MTi, configured to send MTData2
/// with rate of turn, acceleration and, if its compass is of use, Euler angles, all as
/// single-precision "ENU". One write to port `imu` for each measurement, stamped with the time of
/// the measurement if the unit sends its sample time, else with that of its arrival. Acceleration
/// is the specific force: on a slope it contains a part of gravity.
#include "../parts.h"
#include "imu_driver.h"
#include "xbus_frame.h"
#include "xbus_imu.h"

namespace drivers {

/// The state that survives a change: unused bytes, the frame begun, and the unit's clock.
struct ImuLine {
  XbusStream stream;
  ImuReader reader;
  mauve::serial::LineBytes bytes;

  /// Opaque to tools; raise the revision when anything in it changes.
  static constexpr std::string_view type_name = "imu_line/2";
  static constexpr auto fields() { return std::tuple{}; }
};

namespace {

class ImuXbus final : public FrameDriver<ImuCore, ImuLine> {
  mauve::Property<bool> compass{*this, "compass", true, "let its heading through"};
  mauve::Observable<std::uint64_t> measurements{*this, "measurements", 0, "published"};

  void use(Found) override {
    const double now = mauve::to_seconds(mauve::job_time());
    switch (state->reader.read(state->stream.frame(), now)) {
      case ImuReader::Event::imu:
        return publish(state->reader.imu());
      case ImuReader::Event::malformed:
        gave_nothing("its items are no vectors of single precision");
        return count_bad();
      case ImuReader::Event::implausible:
        gave_nothing("its values are no numbers, or beyond the range of any unit");
        return count_implausible();
      case ImuReader::Event::ignored:
        return gave_nothing("its unit sends no rate of turn (item 0x8020 of MTData2)");
    }
  }

  void publish(rover::Imu imu) {
    imu.has_heading = imu.has_heading && compass;
    if (!imu.has_heading) imu.heading = 0.0;
    shell().imu.write(imu);
    published();
    ++measurements;
  }
};

}  // namespace

void declare_imu(mauve::Plugin& plugin) {
  plugin.core<ImuXbus>("imu_xbus");
  plugin.component<ImuShell, ImuFsm>("imu", "imu_xbus");
}

}  // namespace drivers
