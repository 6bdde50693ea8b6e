// SPDX-License-Identifier: LGPL-3.0-or-later
/// Task: a component at run time. It knows when the next job is due, runs it, and takes changes at
/// its boundaries; who calls it (a thread, a simulation) is not its business.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rt/event_ring.h"
#include "rt/request_ring.h"

#include <mauve/change.h>
#include <mauve/clock.h>
#include <mauve/component.h>
#include <mauve/deployer.h>

namespace mauve::exec {

class Transaction;

/// What a change hands to one task: the new bundle, and everything worked out beforehand so that
/// taking it is a few pointer stores. Immutable after publication but for the answer.
struct Published {
  std::shared_ptr<const Bundle> bundle;
  Transaction* transaction = nullptr;
  Mode mode = Mode::keep;
  bool restart = false;    ///< begin at the initial state, on the next instant of the grid
  bool count_gap = false;  ///< releases that passed while parked count as missed (in place)
  Duration grid{0};
  Duration shortest_wait{0};
  /// By index of the state of the old machine: the state of the new one; null: begin anew.
  std::vector<FsmState*> state_map;
  StateBase* from = nullptr;  ///< hand-over, or null
  StateBase* into = nullptr;
  std::vector<std::pair<ObservableBase*, const ObservableBase*>> observables;
  /// Ports that lose their service: their safe values are written first.
  std::vector<std::pair<const PortBase*, ServiceBase*>> safe_writes;

  // The answer, valid when `progress` is done.
  Duration pause{0};
  std::size_t bytes = 0;
  enum class Progress : std::uint8_t {
    published,
    done,        ///< in force, and the first job with it has ended
    given_back,  ///< the instant was missed: the task never used it
  };
  /// The last word the task writes: it touches neither this nor the transaction afterwards, but for
  /// what it runs with.
  std::atomic<Progress> progress{Progress::published};
};

/// Counters, written by the task's thread, read by anyone.
struct Counters {
  std::atomic<std::uint64_t> releases{0};
  std::atomic<std::uint64_t> missed{0};
  std::atomic<std::uint64_t> overruns{0};
  std::atomic<std::uint64_t> over_budget{0};
  std::atomic<std::int64_t> lateness_last{0};
  std::atomic<std::int64_t> lateness_max{0};
  std::atomic<std::int64_t> execution_last{0};
  std::atomic<std::int64_t> execution_max{0};
  std::atomic<std::int64_t> next_release{0};
  std::atomic<std::uint32_t> fsm_state{0};
  std::atomic<ComponentState> state{ComponentState::stopped};
};

class Task {
 public:
  Task(std::string name, const Clock& clock);
  ~Task();
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] rt::EventRing& events() { return events_; }
  [[nodiscard]] rt::RequestRing& requests() { return requests_; }
  /// What was thrown; valid while the state is faulted.
  [[nodiscard]] const char* fault() const { return fault_.data(); }

  /// Before the first release: what to run, and the common T0. [control]
  void begin(std::unique_ptr<Published> first, Instant t0);

  /// Mailbox. [control]
  void publish(Published& next) { pending_.store(&next, std::memory_order_release); }
  /// Takes the bundle back that the task has not seen yet; false when it did.
  bool revoke(Published& next);
  /// What the last change replaced (or gave back), once; null when nothing.
  [[nodiscard]] std::unique_ptr<Published> reclaim();
  /// Tells the thread to look at its mailbox.
  [[nodiscard]] std::atomic<std::uint32_t>& command() { return command_; }

  // --- [rt] -------------------------------------------------------------------------------------
  /// Takes a change that need not wait for a boundary: an aborted one is given back; a decided one
  /// is taken now when no job lies between its instant and the armed release (realtime 8.4.9).
  void serve();
  [[nodiscard]] bool running() const { return running_; }
  /// When the next job is due (monotonic); only while running.
  [[nodiscard]] Instant next_release() const { return release_; }
  /// Has the time of the next job come?
  [[nodiscard]] bool due() const { return running_ && clock_.now() >= release_; }
  /// The boundary and the job of the armed release.
  void release();

 private:
  void drop_missed(Instant now);
  void meet_boundary(Instant now);
  [[nodiscard]] bool claim(Published& next);
  /// `begin`: when the job that the change delays would have begun.
  void take(Published& next, Instant begin);
  void give_back(Published& next);
  void acknowledge();
  void map_state(const Published& next);
  void rearm(const Published& next, bool was_running);
  void run_job(Instant now);
  void run_states();
  void account(Instant start, Instant end);
  void park(ComponentState state);
  void on_fault(const char* what);
  void write_safe_values();
  void note(rt::EventKind kind, LogLevel level, std::int64_t a = 0, std::int64_t b = 0);

  std::string name_;
  const Clock& clock_;
  rt::EventRing events_;
  rt::RequestRing requests_;
  Counters counters_;
  std::array<char, 128> fault_{};

  alignas(64) std::atomic<Published*> pending_{nullptr};
  alignas(64) std::atomic<Published*> retired_{nullptr};
  alignas(64) std::atomic<std::uint32_t> command_{0};

  // Owned by the task's thread.
  Published* current_ = nullptr;
  Published* unacknowledged_ = nullptr;  // taken, its first job not yet done
  FsmState* state_ = nullptr;            // the wait the task is in; null: before the initial state
  Instant t0_ = 0;
  Instant release_ = 0;  // logical: t0 + offset + clock of the component
  Duration wait_{0};     // that ended, or ends, at release_
  Instant parked_at_ = 0;
  bool running_ = false;
};

}  // namespace mauve::exec
