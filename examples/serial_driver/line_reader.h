// SPDX-License-Identifier: LGPL-3.0-or-later
/// LineReader: a thread of its own reads the serial line. A real-time thread must not do that: even
/// a read that does not block may wait in the terminal layer of the kernel.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

#include <mauve/result.h>

/// The newest value of the device. Both fields together are one atomic word, so that a job never
/// reads the value of one line with the number of another one.
struct Reading {
  float celsius = 0.0F;
  std::uint32_t number = 0;  ///< of the line, counted from 1; 0: none yet
};

class LineReader {
 public:
  LineReader() = default;
  ~LineReader() { stop(); }
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// Opens the device for this reader alone, and begins to read. [factory]
  mauve::Status start(const std::string& device);
  /// Ends the thread and closes the device. [factory]
  void stop();

  /// [rt] Wait-free.
  [[nodiscard]] Reading latest() const { return latest_.load(std::memory_order_acquire); }
  /// [rt] Lines that were no temperature.
  [[nodiscard]] int damaged() const { return damaged_.load(std::memory_order_relaxed); }
  /// [rt] False after the device has gone.
  [[nodiscard]] bool online() const { return online_.load(std::memory_order_relaxed); }

 private:
  mauve::Status open(const std::string& device);
  void run();
  void take(const std::string& line);

  int device_ = -1;
  int wake_ = -1;  // an eventfd that stop() writes to
  std::thread thread_;
  std::atomic<Reading> latest_{};
  std::atomic<int> damaged_{0};
  std::atomic<bool> online_{false};

  static_assert(std::atomic<Reading>::is_always_lock_free);
};
