// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "drivers/gnss_serial" of component kind "drivers/gnss": NMEA 0183 and u-blox' UBX, also
/// mixed, from a serial device. One write to port `fix` for each epoch: GGA, or NAV-PVT where the
/// receiver sends it. Damaged frames are counted and skipped, and so are epochs that cannot be: a
/// jump that would need more than `speed_limit`, or a time out of step. Example: mauvectl watch
/// fix.read gnss.core.bad_frames gnss.core.implausible
///
/// One job reads every complete frame that is there, up to `frames_per_job` and 16 KiB. A device
/// that is not there, or goes away, is opened as soon as it is (back) there (observables
/// device_errors, reopened; state wait_device meanwhile).
#include "../parts.h"
#include "gnss_driver.h"
#include "gnss_reader.h"

namespace drivers {

/// The state that survives a change: unused bytes, the frame begun, and the memory of the gate.
struct GnssLine {
  GnssStream stream;
  GnssReader reader;
  mauve::serial::LineBytes bytes;

  /// Opaque to tools; raise the revision when anything in it changes.
  static constexpr std::string_view type_name = "gnss_line/6";
  static constexpr auto fields() { return std::tuple{}; }
};

namespace {

class GnssSerial final : public FrameDriver<GnssCore, GnssLine> {
  mauve::Property<double> speed_limit{
      *this, "speed_limit", 100.0, "of a jump; 0: any", {.unit = "m/s", .min = 0, .max = 1e4}};
  mauve::Observable<std::uint64_t> fixes{*this, "fixes", 0, "epochs published"};
  mauve::Observable<int> satellites{*this, "satellites", 0, "used in the last epoch"};
  mauve::Observable<double> hdop{*this, "hdop", 0.0, "dilution of precision, of the last epoch"};
  mauve::Observable<int> mode{*this, "mode", 1, "1 none, 2 two dimensions, 3 three"};

  rover::Condition fixed_{false};

  void use(Found found) override {
    do {
      answer(state->reader.read(found, state->stream, now(), speed_limit));
    } while (state->reader.unread());
  }

  void look_at_held() override {
    const GnssReader::Event event = state->reader.overdue(now(), speed_limit);
    if (event != GnssReader::Event::ignored) answer(event);
  }

  [[nodiscard]] static double now() { return mauve::to_seconds(mauve::job_time()); }

  void answer(GnssReader::Event event) {
    switch (event) {
      case GnssReader::Event::fix:
        return publish(state->reader.fix());
      case GnssReader::Event::malformed:
        gave_nothing("its frames are malformed");
        return count_bad();
      case GnssReader::Event::implausible:
        gave_nothing("its epochs cannot be: a jump, or a time out of step");
        return count_implausible();
      case GnssReader::Event::ignored:
        return gave_nothing("its receiver sends neither GGA nor NAV-PVT");
    }
  }

  void publish(const rover::GnssFix& fix) {
    shell().fix.write(fix);
    published();
    ++fixes;
    satellites = fix.satellites;
    hdop = fix.hdop;
    mode = fix.mode;
    fixed_.report(fix.mode > 1, "a fix from {} satellites", "no fix, {} satellites",
                  fix.satellites);
  }
};

}  // namespace

void declare_gnss(mauve::Plugin& plugin) {
  plugin.core<GnssSerial>("gnss_serial");
  plugin.component<GnssShell, GnssFsm>("gnss", "gnss_serial");
}

}  // namespace drivers
