// SPDX-License-Identifier: LGPL-3.0-or-later
/// What every driver of a serial device does: reads it byte by byte within the bounds of one job,
/// counts when it goes away, and opens it again as soon as it is back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <mauve/observable.h>
#include <mauve/time.h>

#include "serial_port.h"

namespace drivers {

/// Bytes read and not used yet: part of what survives a change.
struct LineBytes {
  std::array<char, 1024> bytes{};
  std::size_t next = 0;
  std::size_t end = 0;
};

/// The device, and its two counters in the core that owns it.
class DeviceLine {
 public:
  using Counter = mauve::Observable<std::uint64_t>;

  /// `errors`: times it went away; `reopened`: times it came back.
  DeviceLine(Counter& errors, Counter& reopened) : errors_(errors), reopened_(reopened) {}

  /// For reading and writing. [factory]
  mauve::Status open(const std::string& device, int baud) {
    return port_.open(device, baud, SerialPort::Use::read_write);
  }
  void close();
  [[nodiscard]] bool is_open() const { return port_.is_open(); }
  /// False: it is still away. [rt]
  bool reopen();
  /// The next byte; false when there is none yet, this job has read enough, or the device is gone.
  /// [rt]
  bool take(LineBytes& line, char& byte);
  /// This job has read as much as one may: the rest waits for the next. [rt]
  [[nodiscard]] bool enough() const { return blocks_left_ == 0; }
  /// At most kLongest bytes. What finds no room goes first next time, so that the device never
  /// hears half a request; until then nothing else is sent. False: not sent. [rt]
  bool send(std::string_view bytes);

  static constexpr std::size_t kLongest = 32;

 private:
  bool may_read();
  bool send_rest();
  void lose();

  static constexpr int kBlocksPerJob = 16;

  SerialPort port_;
  Counter& errors_;
  Counter& reopened_;
  mauve::Instant job_ = 0;  // begin of the job that blocks_left_ belongs to
  int blocks_left_ = kBlocksPerJob;
  std::array<char, kLongest> rest_{};  // of what was sent in part
  std::size_t rest_size_ = 0;
};

}  // namespace drivers
