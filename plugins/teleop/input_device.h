// SPDX-License-Identifier: LGPL-3.0-or-later
/// A Linux input device read without ever waiting. A FIFO or a pseudo-terminal that carries the
/// same events serves as well.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "../drivers/serial_port.h"
#include "event_reader.h"

namespace teleop {

class InputDevice {
 public:
  enum class Got : std::uint8_t {
    bytes,    ///< some
    nothing,  ///< none now
    nobody,   ///< a FIFO or file that nobody writes to now
    lost,     ///< the device failed or hung up
  };

  /// What to open from now on. [factory]
  void name(const std::string& path) { path_ = path; }
  /// Opens it, and then lets go of what was open before. Takes no memory. [rt]
  bool open();
  void close() { device_ = drivers::Descriptor(); }
  [[nodiscard]] bool is_open() const { return device_.open(); }
  /// `count` bytes that are there now. [rt]
  Got read(std::span<char> into, std::size_t& count) const;
  /// Begins `reader` anew with the ranges and the state of a real input device; false, and nothing
  /// happens: it does not answer. [rt]
  bool ask(EventReader& reader) const;
  /// Reading it again from its beginning would repeat what was.
  [[nodiscard]] bool is_file() const { return file_; }

 private:
  drivers::Descriptor device_;
  std::string path_;
  bool terminal_ = false;
  bool file_ = false;
};

}  // namespace teleop
