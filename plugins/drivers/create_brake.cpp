// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource kind "drivers/create_brake": tells a Create 2 to stand, whatever is written to it, on a
/// descriptor of its own. Connect port `brake` of "drivers/create" to `write`: nothing is written
/// while the driver works; when it is stopped or faulted, and when the process ends, the runtime
/// writes the safe value, and the base, which would drive on, stops.
#include <cstdint>
#include <string>

#include "../types/velocity.h"
#include "create_oi.h"
#include "line_writer.h"
#include "parts.h"

namespace drivers {
namespace {

class CreateBrake final : public mauve::Core<mauve::EmptyShell> {
 public:
  /// [rt], [control]
  void stop(const rover::Velocity&) {
    const auto text = create::drive_text(0, 0);
    if (line_.send({text.data(), text.size()})) {
      ++stops;
    } else {
      ++failed;
    }
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<std::string> device{*this, "device", "/dev/ttyUSB0", "the same as the driver's"};
  mauve::Observable<std::uint64_t> stops{*this, "stops", 0, "sent"};
  mauve::Observable<std::uint64_t> failed{*this, "failed", 0, "not sent: the device is gone"};

  /// Opened when it is needed: resources are configured before the components that make "pty:NAME".
  mauve::Status on_configure() override {
    line_.choose(device);
    return mauve::ok();
  }
  void on_cleanup() override { line_.close(); }

  LineWriter line_;
};

struct BrakeInterface : mauve::Interface<CreateBrake> {
  mauve::WriteService<rover::Velocity> write{*this, "write", &CreateBrake::stop};
};

}  // namespace

void declare_create_brake(mauve::Plugin& plugin) {
  plugin.resource<mauve::EmptyShell, CreateBrake, BrakeInterface>("create_brake");
}

}  // namespace drivers
