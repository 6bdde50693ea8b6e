// SPDX-License-Identifier: LGPL-3.0-or-later
#include "device_line.h"

namespace drivers {

mauve::Status DeviceLine::open(const std::string& device, int baud) {
  if (mauve::Status opened = reader_.open(device, baud); !opened) return opened;
  writer_.choose(device);
  if (lost()) {
    ++errors_;
  } else if (!writer_.open()) {
    close();
    return mauve::refuse(mauve::Errc::invalid_value, {}, "'" + device + "' is no serial device",
                         "requests would be written into it; name one such as /dev/ttyACM0");
  }
  return mauve::ok();
}

void DeviceLine::close() {
  reader_.close();
  writer_.close();
}

bool DeviceLine::reopen() {
  writer_.close();
  if (!reader_.reopen()) return false;
  ++reopened_;
  return true;
}

bool DeviceLine::take(LineBytes& line, char& byte) {
  const bool there = !lost();
  const bool took = reader_.take(line, byte);
  if (there && lost()) ++errors_;
  return took;
}

}  // namespace drivers
