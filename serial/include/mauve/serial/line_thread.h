// SPDX-License-Identifier: LGPL-3.0-or-later
/// The threads that read and write a serial line, so that no real-time thread has to. In the kernel
/// a read or a poll of a terminal can wait for a worker of ordinary priority. So one thread reads,
/// polls and opens, and another one writes: an order waits for no byte that comes.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string_view>
#include <utility>

#include <mauve/result.h>

#include <mauve/serial/called_thread.h>
#include <mauve/serial/line_bytes.h>
#include <mauve/serial/line_requests.h>
#include <mauve/serial/serial_port.h>

namespace mauve::serial {

/// Serves one end of a line from start() to stop(). A line reads only into bytes that it fills, and
/// only as many as find room there. Further bytes wait in the kernel, and a core that does not run
/// takes none from the one that does. Of all lines of one device only the line whose component ran
/// last reads, at its speed: a core that is gone leaves no line behind that reads for it. A line
/// that no job has used for 3 s lets go of a device for which another component waits.
class LineThread {
 public:
  /// The treatment of an end that failed: it waits for reopen(), or the thread that reads also
  /// looks for it every 250 ms. Or it is opened when something is sent; then it is never read.
  enum class Lost : std::uint8_t { waits, looked_for, opened_to_send };

  LineThread() = default;
  ~LineThread() { stop(); }
  LineThread(const LineThread&) = delete;
  LineThread& operator=(const LineThread&) = delete;

  /// `end` belongs to the threads until stop(). At most `most_waiting` bytes wait to be sent: a
  /// device that hung should not hear old bytes later. With 0 it is never written. One that is
  /// opened to send is for emergencies: its thread is a real-time one from the beginning. [factory]
  mauve::Status start(LineEnd& end, std::size_t most_waiting, Lost lost = Lost::waits);
  /// Called on one of the threads when bytes that send() took found no device. Before start().
  /// [factory]
  void when_unsent(std::function<void()> report) { report_unsent_ = std::move(report); }
  /// Called on the thread that reads with the number of bytes that came. Before start(). [factory]
  void when_received(std::function<void(std::size_t)> report) {
    report_received_ = std::move(report);
  }
  /// Sends the bytes that wait, for 200 ms at most, and joins the threads. [factory]
  void stop();
  /// Until no line fills it any more, so that it can go. After stop(). [factory]
  void empty_handed(LineBytes& bytes) const { filler_.empty_handed(bytes); }

  /// The line fills this from now on, and no other line of the device any; to be called again in
  /// each job. [rt]
  void fill(LineBytes& bytes);
  /// All of it is sent later, or nothing and false: too much waits already, or the job is abandoned
  /// (mauve/guarded.h). If a lost device heard
  /// half of it, a device that is opened to send hears all of it again. [rt]
  bool send(std::string_view bytes);
  /// An order (7 bytes at most) overrules all that any line sent to the device before it. Of that,
  /// bytes that wait are dropped, and bytes that are just going out are followed by the order. The
  /// caller sends the order as well, afterwards. Any thread may call this. [rt]
  void overrule(std::string_view order);
  /// Read it before looking for bytes: those that came before it failed are there then. [rt]
  [[nodiscard]] bool open() const { return open_.load(std::memory_order_acquire); }
  /// Why it is not open: an errno. [rt]
  [[nodiscard]] int error() const { return error_.load(std::memory_order_relaxed); }
  /// How often it was lost since start(): the thread may have opened it again meanwhile. [rt]
  [[nodiscard]] std::uint32_t losses() const { return losses_.load(std::memory_order_relaxed); }
  /// Asks for another try and returns whether an earlier one did it. [rt]
  bool reopen();

 private:
  struct Device;  // the common part of all lines of one device

  static std::shared_ptr<Device> device_of(const LineEnd& end);
  void read_until_the_end();
  void write_until_the_end();
  [[nodiscard]] bool reads() const;
  void tune();
  void follow_the_component();
  void open_again();
  void read_in();
  std::ptrdiff_t read_some(std::span<char> room);
  bool write_out();
  std::ptrdiff_t write_some(std::string_view bytes);
  void lose(int error);
  void mark_lost(int error);
  void drop_waiting();
  void wait_for_bytes();
  [[nodiscard]] std::uint64_t id() const { return reinterpret_cast<std::uintptr_t>(this); }

  LineEnd* end_ = nullptr;
  std::shared_ptr<Device> device_;
  Lost lost_ = Lost::waits;
  std::function<void()> report_unsent_;
  std::function<void(std::size_t)> report_received_;
  std::atomic<bool> stopping_{false};
  bool followed_ = false;          // the component's own
  std::atomic<unsigned> uses_{0};  // by the component
  std::atomic<bool> asked_{false};
  std::atomic<bool> open_{false};  // false under `output_`: then nothing is written any more
  std::atomic<int> failed_{0};     // an errno of a write: the thread that reads closes the end
  std::atomic<int> error_{0};
  std::atomic<std::uint32_t> losses_{0};
  LineFiller filler_;
  // No thread that holds it reads or polls, and none opens the end, unless the line is never read.
  std::mutex output_;
  LineRequests requests_;  // their side of the writer under `output_`

  // Of the thread that reads.
  unsigned seen_uses_ = 0;
  std::chrono::steady_clock::time_point used_;  // when they were others
  bool idle_ = false;  // it is always ready, and has nothing: the end of a file
  std::chrono::steady_clock::time_point looked_;  // for a lost end

  CalledThread reader_;
  CalledThread writer_;
};

}  // namespace mauve::serial
