// SPDX-License-Identifier: LGPL-3.0-or-later
#include "line_reader.h"

namespace drivers {

mauve::Status LineReader::open(const std::string& device, int baud) {
  heard_ = mauve::job_time();
  return port_.open(device, baud, SerialPort::Missing::accepted);
}

bool LineReader::reopen() {
  heard_ = mauve::job_time();
  return port_.reopen();
}

bool LineReader::take(LineBytes& line, char& byte) {
  if (line.next == line.end) {
    begin_job();
    if (lost() || blocks_left_ == 0) return false;
    --blocks_left_;
    const std::ptrdiff_t count = port_.read(line.bytes);
    if (count < 0) port_.close();
    line.next = 0;
    line.end = count > 0 ? static_cast<std::size_t>(count) : 0;
    if (line.end == 0) return false;
    heard_ = job_;
  }
  byte = line.bytes[line.next++];
  return true;
}

mauve::Duration LineReader::silence() const { return mauve::Duration{mauve::job_time() - heard_}; }

/// A device that never runs dry must not hold up the job: so many blocks, then the rest waits.
void LineReader::begin_job() {
  if (const mauve::Instant now = mauve::job_time(); now != job_) {
    job_ = now;
    blocks_left_ = kBlocksPerJob;
  }
}

}  // namespace drivers
