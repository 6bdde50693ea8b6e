// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource kind "drivers/create_brake": orders a Create 2 to stand at each write of any value, on
/// a descriptor of its own. Connect port `brake` of "drivers/create" to `write`: nothing is written
/// while the driver works. When the driver is stopped or faulted, and when the process ends, the
/// runtime writes the safe value. So the base stops, which else would drive on.
///
/// A component that runs a job leaves the line to a thread of the brake's own. Any other thread
/// writes because the component ends or hangs, or the process dies. It writes to the device itself,
/// since no other thread may be alive afterwards. The line of the driver may live on: its unwritten
/// bytes are never written.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <thread>

#include <mauve/job.h>
#include <mauve/serial/line_thread.h>
#include <mauve/serial/serial_port.h>

#include "../../types/velocity.h"
#include "../parts.h"
#include "create_oi.h"

namespace drivers {
namespace {

constexpr std::size_t kMostBrakeOrders = 96;  // a dozen orders to stand
constexpr int kMostTries = 5;                 // of one order, 1 ms apart

class CreateBrake final : public mauve::Core<mauve::EmptyShell> {
 public:
  /// [rt], [control]
  void stop(const rover::Velocity&) {
    const auto text = create::drive_text(0, 0);
    const std::string_view bytes(text.data(), text.size());
    const bool component = mauve::in_job();
    ++stops;
    thread_.overrule(bytes);  // the last command of the driver may be under way
    if (!(component ? thread_.send(bytes) : write_now(bytes))) count_failed();
  }

 private:
  mauve::Stateless stateless{*this};
  mauve::Property<std::string> device{
      *this, "device", "/dev/ttyUSB0", "the same as the driver's", {.within = "/dev/ pty:"}};
  mauve::Observable<std::uint64_t> stops{*this, "stops", 0, "orders to stand"};
  mauve::Observable<std::uint64_t> failed{*this, "failed", 0, "of these, found no device"};

  /// Opened when it is needed: resources are configured before the components that make "pty:NAME".
  mauve::Status on_configure() override {
    port_.choose(device, 0, mauve::serial::SerialPort::Use::both);
    own_.choose(device, 0, mauve::serial::SerialPort::Use::both);
    thread_.when_unsent([this] { count_failed(); });
    return thread_.start(port_, kMostBrakeOrders, mauve::serial::LineThread::Lost::opened_to_send);
  }
  void on_cleanup() override {
    thread_.stop();
    port_.close();
    own_.close();
  }

  /// Any thread may.
  void count_failed() { failed = failures_.fetch_add(1) + 1; }

  /// It may have gone and come back since. While another thread writes to it, it takes nothing.
  bool write_now(std::string_view bytes) {
    std::string_view rest = bytes;
    for (int tries = 0; tries < kMostTries && !rest.empty(); ++tries) {
      if (!own_.is_open() && !own_.reopen()) return false;
      const auto count = own_.write(rest);
      if (count < 0) {
        own_.close();
        rest = bytes;
      } else {
        rest.remove_prefix(static_cast<std::size_t>(count));
        if (!rest.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
    return rest.empty();
  }

  std::atomic<std::uint64_t> failures_{0};
  mauve::serial::SerialPort port_;    // the thread's
  mauve::serial::SerialPort own_;     // for threads that write themselves
  mauve::serial::LineThread thread_;  // ends before the port does
};

struct BrakeInterface : mauve::Interface<CreateBrake> {
  mauve::WriteService<rover::Velocity> write{*this, "write", &CreateBrake::stop,
                                             mauve::Writers::one};
};

}  // namespace

void declare_create_brake(mauve::Plugin& plugin) {
  plugin.resource<mauve::EmptyShell, CreateBrake, BrakeInterface>("create_brake");
}

}  // namespace drivers
