// SPDX-License-Identifier: LGPL-3.0-or-later
/// The recorder collects the records of all threads and keeps the last seconds. It writes a flight
/// recording by itself when a release was missed, a core failed, or a change was rolled back.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/mutex.h"
#include "commands/command.h"
#include "trace/allowance.h"
#include "trace/flights.h"
#include "trace/memory.h"
#include "trace/probe.h"

namespace mauve::daemon {

class Recorder {
 public:
  static constexpr std::chrono::seconds kKept{10};
  static constexpr std::chrono::seconds kMostKept{600};

  /// `flights`: it records always, so that there is something to write.
  explicit Recorder(bool flights) : flights_wanted_(flights) {}
  ~Recorder() { stop(); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// [main] Before the first client.
  void start(Running& running);
  /// [main] Writes the recordings that are due.
  void stop();

  /// Begins a trace; one that is under way begins anew. [control]
  Status begin(bool detail, std::chrono::seconds kept);
  /// Ends it; it can be read until the next one begins. [control]
  Status end();
  [[nodiscard]] Json status() const;  // [control]
  /// The trace that is on, else the one that ended, else the flight recorder; and its name for
  /// further pages. With `now` the trace that ended is passed over. [control]
  Result<std::pair<std::string, RecordingPtr>> snapshot(bool now);
  /// One of the newest snapshots, or null. [control]
  [[nodiscard]] RecordingPtr find_snapshot(const std::string& name) const;
  /// Null: nothing is kept. [any]
  [[nodiscard]] Flights* flights() const { return flights_.get(); }

 private:
  /// A flight recording that is about to be written.
  struct Pending {
    std::string word;  ///< "missed"
    std::string component;
    std::chrono::steady_clock::time_point due;
    std::shared_ptr<std::optional<TracedSystem>> about;  // under mutex_
  };
  /// Missed releases have an allowance of their own, so that on a late machine they do not keep a
  /// failure from being recorded.
  struct Reason {
    FlightAllowance allowance;
    std::optional<Pending> pending = std::nullopt;
  };

  void run();
  void collect();
  void look(const TraceRecord& record) MAUVE_REQUIRES(mutex_);
  void ask_what_it_is_about(const Pending& pending);
  void wait_for_rest(Reason& reason, const TraceRecord& record);
  void report_skipped(const FlightAllowance& allowance, const Pending& flight);
  void write_when_due(bool now);
  void write_when_due(Reason& reason, bool now) MAUVE_REQUIRES(mutex_);
  void start_probes() MAUVE_REQUIRES(mutex_);
  [[nodiscard]] Recording cut(Instant from) const MAUVE_REQUIRES(mutex_);
  [[nodiscard]] TraceMode mode() const MAUVE_REQUIRES(mutex_);

  const bool flights_wanted_;
  Running* running_ = nullptr;
  std::unique_ptr<Flights> flights_;

  mutable Mutex mutex_;  ///< guards the members below
  ConditionVariable wake_;
  bool stopping_ MAUVE_GUARDED_BY(mutex_) = false;
  TraceMemory memory_ MAUVE_GUARDED_BY(mutex_);
  TracedSystem about_ MAUVE_GUARDED_BY(mutex_);  ///< as it was when it was looked at last
  bool on_ MAUVE_GUARDED_BY(mutex_) = false;
  bool detail_ MAUVE_GUARDED_BY(mutex_) = false;
  Instant since_ MAUVE_GUARDED_BY(mutex_) = 0;  ///< of the trace, or of the last one
  std::chrono::seconds kept_ MAUVE_GUARDED_BY(mutex_) = kKept;
  std::int64_t lost_ MAUVE_GUARDED_BY(mutex_) = 0;
  RecordingPtr last_ MAUVE_GUARDED_BY(mutex_);  ///< the trace that ended
  std::deque<std::pair<std::string, RecordingPtr>> snapshots_ MAUVE_GUARDED_BY(mutex_);
  std::uint64_t snapshots_made_ MAUVE_GUARDED_BY(mutex_) = 0;
  std::vector<std::unique_ptr<Probe>> probes_
      MAUVE_GUARDED_BY(mutex_);                   ///< while it is on, where there is real time
  bool probed_ MAUVE_GUARDED_BY(mutex_) = false;  ///< there is one on each of these CPUs
  Reason misses_ MAUVE_GUARDED_BY(mutex_){{1, std::chrono::seconds(10)}};
  Reason failures_ MAUVE_GUARDED_BY(mutex_){
      {3, std::chrono::seconds(30)}};  ///< faults and rollbacks
  std::thread thread_;
};

}  // namespace mauve::daemon
