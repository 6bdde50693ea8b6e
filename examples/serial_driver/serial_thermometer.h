// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "serial_thermometer/driver": a thermometer on a serial line, which sends a line
/// of text for each measurement, such as "21.50".
#pragma once

#include <mauve/plugin.h>

#include "line_reader.h"

namespace serial_thermometer {

struct Shell : mauve::Shell {
  mauve::WritePort<double> temperature{*this, "temperature"};  // degrees Celsius
};

class Driver final : public mauve::Core<Shell> {
 public:
  /// A request may set a device below /dev/ only; the architecture file may name any path.
  mauve::Property<std::string> device{
      *this, "device", "/dev/ttyUSB0", "serial line of the thermometer", {.within = "/dev/"}};
  mauve::Observable<int> damaged{*this, "damaged", 0, "lines that were no temperature"};
  mauve::Observable<bool> online{*this, "online", false, "the device is there"};
  mauve::Stateless stateless{*this};

  /// [rt] every period: no system call. A measurement is written once, so that its age is true.
  void update() {
    const Reading reading = reader_.latest();
    if (reading.number != written_) {
      written_ = reading.number;
      shell().temperature.write(static_cast<double>(reading.celsius));
    }
    damaged = reader_.damaged();
    online = reader_.online();
  }

 private:
  /// [factory] All that may wait or fail happens here, beside the running system.
  mauve::Status on_configure() override {
    written_ = 0;
    return reader_.start(device);
  }
  void on_cleanup() override { reader_.stop(); }

  LineReader reader_;
  std::uint32_t written_ = 0;  // number of the reading that was written last
};

}  // namespace serial_thermometer
