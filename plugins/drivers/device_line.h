// SPDX-License-Identifier: LGPL-3.0-or-later
/// A serial device that is read and written, with the counters that every such driver has.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <mauve/observable.h>

#include "line_reader.h"
#include "line_writer.h"

namespace drivers {

/// The device of one core.
class DeviceLine {
 public:
  using Counter = mauve::Observable<std::uint64_t>;

  /// `errors`: times it was not there or went away; `reopened`: times it came, or came back.
  DeviceLine(Counter& errors, Counter& reopened) : errors_(errors), reopened_(reopened) {}

  /// One that is not there is waited for. [factory]
  mauve::Status open(const std::string& device, int baud);
  void close();
  [[nodiscard]] bool lost() const { return reader_.lost(); }
  /// False: it is still away. [rt]
  bool reopen();
  /// See LineReader. [rt]
  bool take(LineBytes& line, char& byte);
  [[nodiscard]] bool spent() const { return reader_.spent(); }
  /// See LineWriter. [rt]
  bool send(std::string_view bytes) { return !lost() && writer_.send(bytes); }

 private:
  LineReader reader_;
  LineWriter writer_;
  Counter& errors_;
  Counter& reopened_;
};

}  // namespace drivers
