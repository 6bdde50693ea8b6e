// SPDX-License-Identifier: LGPL-3.0-or-later
/// The log: takes events from every thread and brings them to the sinks on a thread of its own.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "log/event.h"
#include "log/history.h"
#include "log/levels.h"
#include "log/sink.h"

namespace mauve::logging {

/// Never waits for a sink: a thread that reports too much loses events, and the loss is reported.
///
/// Real-time threads do not call it. They write into rings of their own; a Source empties those
/// rings on the [log] thread, 50 times a second.
///
/// The sinks get the records in the order of their times. An exception is the message of a core: it
/// has the time at which its job started, and may come after younger records while the job lasts.
class Log {
 public:
  /// Empties the rings: calls `take` once for each event found. [log]
  using Source = std::function<void(const std::function<void(Record)>& take)>;

  explicit Log(Level level, std::size_t history = kHistory);
  /// Writes the records that are left, then ends the thread.
  ~Log();
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  /// Before start().
  void add_sink(std::unique_ptr<Sink> sink);
  void start();
  /// Writes everything reported so far and ends the [log] thread; nothing is written afterwards.
  void stop();

  /// Sets or (empty) removes the source. After the return the old one is not called any more. [any]
  void set_source(Source source);

  /// Reports an event, which gets the time of this call. Allocates, takes an ordinary mutex: not
  /// for real-time threads. [any]
  void write(Event event, Fields fields = {});
  void write(Record record);

  /// Waits until everything reported so far is in the history and in the sinks. [any but log]
  void flush();

  /// The levels that decide which records are accepted. The log reports the end of a level that was
  /// set for a time. [any]
  [[nodiscard]] Levels& levels() { return levels_; }
  [[nodiscard]] History& history() { return history_; }  ///< the newest records
  /// How many records a sink did not take, since the begin. [any]
  [[nodiscard]] std::uint64_t unwritten() const { return unwritten_.load(); }

  static constexpr std::size_t kHistory = 4096;  ///< records
  static constexpr std::size_t kQueue = 8192;    ///< records that wait for a round of [log]
  static constexpr std::chrono::milliseconds kPeriod{20};

 private:
  struct Destination {
    std::unique_ptr<Sink> sink;
    std::uint64_t missing = 0;  ///< records in a row that it did not take
    std::string target;
  };

  void run();
  /// Adds the events of the source. Delivers the records up to `cut`, in ns on the monotonic clock;
  /// the later ones stay in the batch.
  void collect(std::vector<Record>& batch);
  void write_up_to(std::vector<Record>& batch, std::int64_t cut);
  void deliver(Record record);
  void look_at_levels(std::vector<Record>& batch);
  [[nodiscard]] bool passes(const Record& record) const;
  void write_to_sinks(const Record& record);
  Status write_to(Destination& sink, const Record& record);

  Levels levels_;
  History history_;
  std::vector<Destination> sinks_;
  std::atomic<std::uint64_t> unwritten_{0};
  std::uint64_t seq_ = 0;  ///< [log]

  Mutex source_mutex_;
  Source source_ MAUVE_GUARDED_BY(source_mutex_);

  Mutex mutex_;
  ConditionVariable wake_;
  ConditionVariable done_;
  std::vector<Record> queue_ MAUVE_GUARDED_BY(mutex_);
  std::uint64_t lost_ MAUVE_GUARDED_BY(mutex_) = 0;
  std::uint64_t rounds_ MAUVE_GUARDED_BY(mutex_) = 0;  ///< complete rounds of the [log] thread
  bool hurry_ MAUVE_GUARDED_BY(mutex_) = false;  ///< flush() waits: the next round begins at once
  bool started_ MAUVE_GUARDED_BY(mutex_) = false;
  bool stopping_ MAUVE_GUARDED_BY(mutex_) = false;
  std::thread thread_;  ///< [log]; start() and stop() are called by one thread
};

}  // namespace mauve::logging
