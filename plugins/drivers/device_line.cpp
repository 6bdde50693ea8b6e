// SPDX-License-Identifier: LGPL-3.0-or-later
#include "device_line.h"

#include <algorithm>

#include <mauve/job.h>

namespace drivers {

void DeviceLine::close() {
  port_.close();
  rest_size_ = 0;
}

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
  if (!is_open() || !send_rest() || bytes.size() > kLongest) return false;
  const std::ptrdiff_t count = port_.write(bytes);
  if (count < 0) lose();
  if (count <= 0) return false;
  const std::string_view rest = bytes.substr(static_cast<std::size_t>(count));
  std::copy(rest.begin(), rest.end(), rest_.begin());
  rest_size_ = rest.size();
  return true;
}

bool DeviceLine::send_rest() {
  if (rest_size_ == 0) return true;
  const std::ptrdiff_t count = port_.write({rest_.data(), rest_size_});
  if (count < 0) lose();
  if (count <= 0) return false;
  const auto sent = static_cast<std::size_t>(count);
  std::copy(rest_.begin() + count, rest_.begin() + static_cast<std::ptrdiff_t>(rest_size_),
            rest_.begin());
  rest_size_ -= sent;
  return rest_size_ == 0;
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
  close();
}

}  // namespace drivers
