// SPDX-License-Identifier: LGPL-3.0-or-later
/// The far end of a line as a simulated device uses it: a pseudo-terminal, read and written by
/// threads of its own. It is a member of the core of the device, and a property names it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <mauve/observable.h>
#include <mauve/property.h>

#include <mauve/serial/line_thread.h>
#include <mauve/serial/serial_port.h>

namespace mauve::serial {

class SimulatedLine {
 public:
  using Counter = mauve::Observable<std::uint64_t>;

  SimulatedLine(mauve::Configurable& device, std::string_view name, std::string line)
      : line_(device, name, std::move(line),
              "serial device to make: pty:NAME, or a path of your choice", {.within = "pty:"}) {}

  /// See PseudoTerminal. [factory]
  mauve::Status open() {
    if (mauve::Status opened = terminal_.open(line_); !opened) return opened;
    return thread_.start(terminal_, decltype(bytes_.ring)::kCapacity);
  }
  void close() {
    thread_.stop();
    terminal_.close();
  }

  /// All of it, or nothing and false: no program reads the line, and much waits already. [rt]
  bool send(std::string_view bytes) { return thread_.send(bytes); }
  /// The same, and counts the text in one of the two. [rt]
  void send(std::string_view bytes, Counter& sent, Counter& lost) { ++(send(bytes) ? sent : lost); }
  /// The bytes that the other end wrote, as far as they fit. [rt]
  [[nodiscard]] std::size_t receive(std::span<char> into) {
    thread_.fill(bytes_);
    const std::span<const char> there = bytes_.ring.there();
    const std::size_t count = std::min(there.size(), into.size());
    std::copy_n(there.begin(), count, into.begin());
    bytes_.ring.drop(count);
    return count;
  }

 private:
  mauve::Property<std::string> line_;
  PseudoTerminal terminal_;
  LineBytes bytes_;
  LineThread thread_;  // ends before both
};

}  // namespace mauve::serial
