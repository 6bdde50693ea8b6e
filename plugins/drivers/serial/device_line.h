// SPDX-License-Identifier: LGPL-3.0-or-later
/// A serial device as a core uses it: byte by byte, a bounded number each job, with the counters
/// that every such driver has. A thread of its own (LineThread) does the reading and writing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <mauve/job.h>
#include <mauve/observable.h>

#include "../../types/reporting.h"
#include "line_thread.h"
#include "serial_port.h"

namespace drivers {

/// The device of one core.
class DeviceLine {
 public:
  using Counter = mauve::Observable<std::uint64_t>;
  static constexpr std::size_t kBytesPerJob = 16'384;

  /// `errors`: times it was not there or went away; `reopened`: times it came, or came back;
  /// `received`: bytes, counted as they come.
  DeviceLine(Counter& errors, Counter& reopened, Counter& received)
      : errors_(errors), reopened_(reopened), received_(received) {}

  /// The guardian of the process sends this to the device when the process cannot. Before open();
  /// `guarded` outlives the line. [factory]
  void guard(mauve::Guarded& guarded, const mauve::SafeOrder& order) {
    port_.guard(guarded, order);
  }
  /// One that is not there is waited for: then lost() is true. [factory]
  mauve::Status open(const std::string& device, int baud, SerialPort::Use use);
  /// Bytes that were sent before are written first. Then no thread writes into `line` any more.
  /// [factory]
  void close(LineBytes& line);
  [[nodiscard]] bool lost() const { return lost_; }
  /// Asks for it. False: it is still away, as far as the last call made it known. [rt]
  bool reopen();

  /// The next byte; false when there is none yet, the device is lost, or this job had its share.
  /// [rt]
  bool take(LineBytes& line, char& byte);
  /// This job had its share; more may be there.
  [[nodiscard]] bool spent() const { return bytes_left_ == 0; }
  /// How long nothing came.
  [[nodiscard]] mauve::Duration silence() const;
  /// Counts a damaged frame, and reports it. [rt]
  static void count_damaged(Counter& bad_frames);

  /// All of it goes out, or nothing: the device never hears half a request. False: it is lost, or
  /// does not take the bytes that were sent before. [rt]
  bool send(std::string_view bytes) { return !lost_ && thread_.send(bytes); }

 private:
  void begin_job(LineBytes& line);
  void report();

  SerialPort port_;
  LineThread thread_;  // ends before the port does
  Counter& errors_;
  Counter& reopened_;
  Counter& received_;
  mauve::Instant job_ = 0;    // begin of the job that bytes_left_ belongs to
  mauve::Instant heard_ = 0;  // when the last bytes came
  std::size_t bytes_left_ = 0;
  bool lost_ = true;
  rover::Condition there_{true};
};

}  // namespace drivers
