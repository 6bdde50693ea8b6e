// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/imu_sim": an inertial unit at the far end of a serial line. It writes
/// Xbus to a pseudo-terminal, whose other end is the device named by `line`, so that the real
/// driver runs on it.
#include <cstdint>
#include <string>
#include <string_view>

#include <mauve/serial/simulated_line.h>

#include "../../types/imu.h"
#include "../parts.h"
#include "xbus_imu.h"

namespace drivers {
namespace {

struct ImuSimShell : mauve::Shell {
  mauve::ReadPort<rover::Imu> world{*this, "world", mauve::Need::required};
};

class ImuSim final : public mauve::Core<ImuSimShell> {
 public:
  void update() {
    const rover::Imu imu = shell().world.read();
    if (!has_value(shell().world.status())) return;
    const auto ticks = static_cast<std::uint32_t>(mauve::job_time() / 100'000);
    const Bytes frame = writer_.compose(imu, ticks);
    line.send({reinterpret_cast<const char*>(frame.data()), frame.size()}, sent, lost);
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::serial::SimulatedLine line{*this, "line", "pty:imu"};
  mauve::Observable<std::uint64_t> sent{*this, "sent", 0, "measurements"};
  mauve::Observable<std::uint64_t> lost{*this, "lost", 0, "not sent: nobody reads the line"};

  mauve::Status on_configure() override { return line.open(); }
  void on_cleanup() override { line.close(); }

  ImuWriter writer_;
};

}  // namespace

void declare_imu_sim(mauve::Plugin& plugin) {
  plugin.component<ImuSimShell, ImuSim, mauve::PeriodicFsm<ImuSim>>("imu_sim");
}

}  // namespace drivers
