// SPDX-License-Identifier: LGPL-3.0-or-later
/// Looks after the actions of the running system by itself: ends of probations, rollbacks, cores
/// that took over from failing ones. Keeps such cores in readiness.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <string>
#include <thread>

#include "base/mutex.h"
#include "commands/command.h"
#include "monitor/repeated_reports.h"

namespace mauve::daemon {

class HealthMonitor {
 public:
  HealthMonitor() = default;
  ~HealthMonitor() { stop(); }
  HealthMonitor(const HealthMonitor&) = delete;
  HealthMonitor& operator=(const HealthMonitor&) = delete;

  /// [main] From now on, 50 times a second.
  void start(Running& running);
  void stop();

 private:
  void run();
  void look();
  void report_outcomes();
  void settle(const Outcome& outcome);
  void report(const Outcome& outcome);
  void save(const Outcome& outcome, const std::string& changes);
  std::string remember_rollback(const Outcome& outcome);
  [[nodiscard]] Generation generation_of(const Outcome& outcome, const std::string& changes) const;
  void name_user(Generation& about, std::uint64_t undone) const;
  void report_factory();
  void make_standby_cores();
  [[nodiscard]] bool refused_before(const Change& standby);
  void refuse_standby(const Change& standby, const Error& error, bool for_ever);

  Running* running_ = nullptr;
  Mutex mutex_;
  ConditionVariable wake_;
  bool stopping_ MAUVE_GUARDED_BY(mutex_) = false;
  std::atomic<bool> looking_{false};  ///< a look is queued or under way
  bool making_ = false;               ///< [control] standby_cores are being made
  /// The standby core of a component was refused in this generation: it is made again in the next
  /// one, but a standby core whose hook hung is never made again.
  struct RefusedStandby {
    std::uint64_t generation = 0;
    std::string why;
  };
  std::map<std::string, RefusedStandby> refused_;  ///< [control] by component
  RepeatedReports repeated_;                       ///< [control]
  unsigned looks_ = 0;                             ///< [control]
  std::thread thread_;
};

}  // namespace mauve::daemon
