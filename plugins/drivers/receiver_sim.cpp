// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/receiver_sim": a GNSS receiver at the far end of a serial line. It
/// writes NMEA to a pseudo-terminal, whose other end is the device named by `line`, so that the
/// real driver runs on it. List it before the driver: the device must be there when the driver
/// opens it.
#include <cstdint>
#include <string>

#include "../types/gnss.h"
#include "nmea_write.h"
#include "parts.h"
#include "serial_port.h"

namespace drivers {
namespace {

using rover::GnssFix;

struct ReceiverShell : mauve::Shell {
  mauve::ReadPort<GnssFix> antenna{*this, "antenna"};
};

class ReceiverSim final : public mauve::Core<ReceiverShell> {
 public:
  void update() {
    const GnssFix fix = shell().antenna.read();
    if (!has_value(shell().antenna.status())) return;
    if (line_.send(writer_.compose(fix, 0.0, 0.0))) {
      ++epochs;
    } else {
      ++lost;
    }
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<std::string> line{*this, "line", "pty:gnss",
                                    "serial device to make: pty:NAME, or a path of your choice"};
  mauve::Observable<std::uint64_t> epochs{*this, "epochs", 0, "sent"};
  mauve::Observable<std::uint64_t> lost{*this, "lost", 0, "not sent: nobody reads the line"};

  mauve::Status on_configure() override { return line_.open(line); }
  void on_cleanup() override { line_.close(); }

  PseudoTerminal line_;
  NmeaWriter writer_;
};

}  // namespace

void declare_receiver_sim(mauve::Plugin& plugin) {
  plugin.component<ReceiverShell, ReceiverSim, mauve::PeriodicFsm<ReceiverSim>>("receiver_sim");
}

}  // namespace drivers
