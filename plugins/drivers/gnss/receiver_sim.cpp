// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/receiver_sim": a GNSS receiver at the far end of a serial line. It
/// writes NMEA or UBX to a pseudo-terminal, whose other end is the device named by `line`, so that
/// the real driver runs on it.
#include <cstdint>
#include <string>
#include <string_view>

#include <mauve/serial/simulated_line.h>

#include "../../types/gnss.h"
#include "../parts.h"
#include "nmea_write.h"
#include "ubx_pvt.h"

namespace drivers {
namespace {

using rover::GnssFix;

struct ReceiverShell : mauve::Shell {
  mauve::ReadPort<GnssFix> antenna{*this, "antenna", mauve::Need::required};
};

class ReceiverSim final : public mauve::Core<ReceiverShell> {
 public:
  void update() {
    const GnssFix fix = shell().antenna.read();
    if (!has_value(shell().antenna.status())) return;
    if (ubx_) {
      const auto frame = write_pvt(fix);
      line.send({reinterpret_cast<const char*>(frame.data()), frame.size()}, epochs, lost);
    } else {
      line.send(writer_.compose(fix, 0.0, 0.0), epochs, lost);
    }
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::serial::SimulatedLine line{*this, "line", "pty:gnss"};
  mauve::Property<std::string> protocol{*this, "protocol", "nmea",
                                        "nmea (GGA, GSA, RMC) or ubx (NAV-PVT)"};
  mauve::Observable<std::uint64_t> epochs{*this, "epochs", 0, "sent"};
  mauve::Observable<std::uint64_t> lost{*this, "lost", 0, "not sent: nobody reads the line"};

  mauve::Status on_configure() override {
    const std::string& named = protocol.get();
    if (named != "nmea" && named != "ubx") return mauve::invalid(protocol, "must be nmea or ubx");
    ubx_ = named == "ubx";
    return line.open();
  }
  void on_cleanup() override { line.close(); }

  bool ubx_ = false;
  NmeaWriter writer_;
};

}  // namespace

void declare_receiver_sim(mauve::Plugin& plugin) {
  plugin.component<ReceiverShell, ReceiverSim, mauve::PeriodicFsm<ReceiverSim>>("receiver_sim");
}

}  // namespace drivers
