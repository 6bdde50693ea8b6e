// SPDX-License-Identifier: LGPL-3.0-or-later
/// Bytes of a serial device one by one, a bounded number each job.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include <mauve/job.h>

#include "serial_port.h"

namespace drivers {

/// Read from the device and not used yet: survives a change of the core.
struct LineBytes {
  std::array<char, 1024> bytes{};
  std::size_t next = 0;
  std::size_t end = 0;
};

/// The device of one core.
class LineReader {
 public:
  static constexpr int kBlocksPerJob = 16;

  /// Opens the device. One that is not there is waited for: then lost() is true. [factory]
  mauve::Status open(const std::string& device, int baud);
  void close() { port_.close(); }
  [[nodiscard]] bool lost() const { return !port_.is_open(); }
  bool reopen();  ///< [rt]

  /// The next byte; false when there is none yet, the device is lost, or this job had its share.
  /// [rt]
  bool take(LineBytes& line, char& byte);
  /// This job had its share; more may be there.
  [[nodiscard]] bool spent() const { return blocks_left_ == 0; }
  /// How long nothing came.
  [[nodiscard]] mauve::Duration silence() const;

 private:
  void begin_job();

  SerialPort port_;
  mauve::Instant job_ = 0;    // begin of the job that blocks_left_ belongs to
  mauve::Instant heard_ = 0;  // when the last bytes came
  int blocks_left_ = 0;
};

}  // namespace drivers
