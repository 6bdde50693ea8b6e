// SPDX-License-Identifier: LGPL-3.0-or-later
/// DeviceLine: the serial device of a driver, read byte by byte and written without waiting.
/// Threads of its own do all input and output, so that no job waits for the kernel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <mauve/job.h>
#include <mauve/observable.h>
#include <mauve/property.h>
#include <mauve/serial/line_thread.h>
#include <mauve/serial/serial_port.h>

namespace mauve::serial {

/// The defaults of the properties of a line, and its use.
struct LineSettings {
  std::string device = "/dev/ttyUSB0";          ///< the path, or "pty:NAME" of a simulated one
  int baud = 0;                                 ///< the speed; 0 leaves it alone, as for USB
  SerialPort::Use use = SerialPort::Use::both;  ///< reading alone, or writing too
};

/// The device of one core, declared as a member after the State. The State of the core contains
/// the LineBytes, so that no byte is lost or read twice in a change. The core calls open() in
/// on_configure() and close() in on_cleanup(). Each job takes the bytes that came, and calls
/// reopen() while lost(). The device belongs to this process alone, and there to one component
/// (device_lock.h). Several of its cores may open it at once, as a change needs it: only the one
/// that ran last reads. A core has one DeviceLine, which declares the properties `device` and
/// `baud` and the counters below.
class DeviceLine {
 public:
  /// A number of events that people see.
  using Counter = mauve::Observable<std::uint64_t>;
  /// A device that never runs dry does not hold up a job: further bytes wait for the next one.
  static constexpr std::size_t kBytesPerJob = 16'384;

  /// Registers properties and counters with the core.
  DeviceLine(mauve::Configurable& core, LineSettings settings);

  /// mauved sends the order when the component is stopped, fails or is removed; the guardian sends
  /// it when mauved cannot. Choose `times` 2 or more: a command that the core sent just before may
  /// go out after the first order. The line then looks for a lost device itself, every 250 ms:
  /// the order must reach it also while no job runs. Before open(); `guarded` outlives the line.
  /// [factory]
  void guard(mauve::Guarded& guarded, const mauve::SafeOrder& order) {
    port_.guard(guarded, order);
  }
  /// Opens the device and starts the threads. A device that is not there is waited for: then lost()
  /// is true. Refused when another process has it, when it is no terminal but is to be written, and
  /// when there is no such speed. [factory]
  mauve::Status open();
  /// Writes the bytes that were sent before, for 200 ms at most, unless an order overruled them,
  /// and ends the threads. Afterwards no thread touches `line`. [factory]
  void close(LineBytes& line);
  /// The device is not there, or went away. [rt]
  [[nodiscard]] bool lost() const { return lost_; }
  /// Asks the thread that reads to open it. False: it is still away, as far as the last call made
  /// it known. [rt]
  bool reopen();

  /// The next byte; false when there is none yet, the device is lost, or this job had its share.
  /// [rt]
  bool take(LineBytes& line, char& byte);
  /// This job had its share; more may be there. [rt]
  [[nodiscard]] bool spent() const { return bytes_left_ == 0; }
  /// The time without a byte. [rt]
  [[nodiscard]] mauve::Duration silence() const;
  /// All of it goes out, or nothing: the device never hears half a request. False: it is lost, or
  /// more than 256 bytes would wait, because the device does not take those sent before. The
  /// latter is counted (`unsent`), and the warning `takes_no_bytes` lasts until the next one that
  /// finds room. [rt]
  bool send(std::string_view bytes);
  /// Drops all bytes that came so far. [rt]
  void forget(LineBytes& line);

  mauve::Property<std::string> device;  ///< to be opened
  mauve::Property<int> baud;            ///< the speed
  Counter device_errors;                ///< times it was not there or went away
  Counter reopened;                     ///< times it came, or came back
  Counter received;                     ///< bytes, counted as they come
  Counter unsent;                       ///< commands that found no room
  mauve::Warning unplugged;             ///< lasts while the device is not there
  mauve::Warning takes_no_bytes;        ///< lasts from such a command to the next one with room

 private:
  void begin_job(LineBytes& line);
  void report();

  const mauve::Configurable& core_;
  SerialPort::Use use_;
  SerialPort port_;
  LineThread thread_;         // ends before the port does
  mauve::Instant job_ = 0;    // begin of the job that bytes_left_ belongs to
  mauve::Instant heard_ = 0;  // when the last bytes came
  std::size_t bytes_left_ = 0;
  std::uint32_t losses_ = 0;  // known to the core
  bool lost_ = true;
};

}  // namespace mauve::serial
