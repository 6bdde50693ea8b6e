// SPDX-License-Identifier: LGPL-3.0-or-later
/// Requests to a serial device, on a descriptor of their own. The line is set up by who reads it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "serial_port.h"

namespace drivers {

/// Opens the device when something is to be sent, and again after it failed. What is no terminal is
/// never written to: a request would damage a recording.
class LineWriter {
 public:
  static constexpr std::size_t kLongest = 32;

  /// See line_path(). [factory]
  void choose(const std::string& device) { path_ = line_path(device); }
  void close();
  /// False: it is not there, or no terminal. Takes no memory. [rt]
  bool open();
  /// At most kLongest bytes. What finds no room goes first next time, so that the device never
  /// hears half a request; until then nothing else is sent. False: not sent. Never waits. [rt]
  bool send(std::string_view bytes);

 private:
  std::ptrdiff_t write(std::string_view bytes);
  bool send_rest();

  Descriptor device_;
  std::string path_;
  std::array<char, kLongest> rest_{};  // of what was sent in part
  std::size_t rest_size_ = 0;
};

}  // namespace drivers
