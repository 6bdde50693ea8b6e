// SPDX-License-Identifier: LGPL-3.0-or-later
#include "device_line.h"

#include <mauve/job.h>

namespace drivers {

bool DeviceLine::reopen() {
  if (!port_.reopen()) return false;
  ++reopened_;
  return true;
}

bool DeviceLine::take(LineBytes& line, char& byte) {
  if (line.next == line.end) {
    if (!is_open() || !may_read()) return false;
    const std::ptrdiff_t count = port_.read(line.bytes);
    if (count < 0) lose();
    line.next = 0;
    line.end = count > 0 ? static_cast<std::size_t>(count) : 0;
    if (line.end == 0) return false;
  }
  byte = line.bytes[line.next++];
  return true;
}

bool DeviceLine::send(std::string_view bytes) {
  if (!is_open()) return false;
  const std::ptrdiff_t count = port_.write(bytes);
  if (count < 0) lose();
  return count == static_cast<std::ptrdiff_t>(bytes.size());
}

bool DeviceLine::may_read() {
  if (const mauve::Instant now = mauve::job_time(); now != job_) {
    job_ = now;
    blocks_left_ = kBlocksPerJob;
  }
  return blocks_left_ > 0 && blocks_left_-- > 0;
}

void DeviceLine::lose() {
  ++errors_;
  port_.close();
}

}  // namespace drivers
