// SPDX-License-Identifier: LGPL-3.0-or-later
/// Task: a component at run time. It knows when the next job is due, runs it, and takes changes at
/// its boundaries; who calls it (a thread, a simulation) is not its business.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exec/task/counters.h"
#include "exec/task/evidence.h"
#include "exec/task/failed_core.h"
#include "exec/task/published.h"
#include "rt/event_ring.h"
#include "rt/measured.h"
#include "rt/noise.h"
#include "rt/request_ring.h"
#include "rt/rescue.h"
#include "rt/trace_ring.h"

#include <mauve/clock.h>
#include <mauve/happening.h>
#include <mauve/job.h>
#include <mauve/trace.h>

namespace mauve {

class CoreBase;
class FsmState;
struct TaskAttributes;

namespace exec {

class Task {
 public:
  /// `noise`: the noise of the machine; null: it is not known.
  Task(std::string name, const Clock& clock, std::shared_ptr<const rt::Noise> noise = nullptr);
  ~Task();
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] rt::EventRing& events() { return events_; }
  [[nodiscard]] rt::RequestRing& requests() { return requests_; }
  /// The ring of its thread, then those of threads that it lost, by `older`. [any]
  struct Trace {
    rt::TraceRing ring;
    const std::unique_ptr<Trace> older;
  };
  [[nodiscard]] Trace& trace() { return *trace_.load(std::memory_order_acquire); }
  [[nodiscard]] std::uint32_t trace_name() const { return trace_name_; }
  [[nodiscard]] const FaultRecord& fault() const { return fault_; }  ///< valid while faulted

  /// Before the first release: what to run, and the common T0. [control]
  void begin(std::unique_ptr<Published> first, Instant t0);

  /// Mailbox. [control]
  void publish(Published& next) { pending_.store(&next, std::memory_order_release); }
  /// Takes the bundle back that the task has not seen yet; false when it did.
  bool revoke(Published& next) { return empty(pending_, next); }
  /// What the task does not use any more, the newest first.
  [[nodiscard]] std::vector<std::unique_ptr<Published>> reclaim();
  /// What takes over by itself when the core fails; the task owns it. False: it has one. [control]
  bool stand_by(Published& relief);
  /// Takes the way back, or the relief, out again; false when the task has taken it.
  bool withdraw_back(Published& back) { return empty(back_, back); }
  void put_back(Published& back) { back_.store(&back, std::memory_order_release); }
  bool withdraw_relief(Published& relief) { return empty(relief_, relief); }
  /// Waits for its way back or its relief. A hopeless one parks as faulted.
  [[nodiscard]] FailedCore& failed_core() { return failed_; }
  /// How often the task looked for changes: what was taken out before the last look is not looked
  /// at any more.
  [[nodiscard]] std::uint64_t looks() const { return looks_.load(std::memory_order_acquire); }
  /// Tells the thread to look at its mailbox.
  [[nodiscard]] std::atomic<std::uint32_t>& command() { return command_; }
  /// It runs a core whose last jobs exceeded their budget, without a verdict yet. [any]
  [[nodiscard]] bool suspected() const {
    return suspected_.load(std::memory_order_relaxed) &&
           counters_.state.load(std::memory_order_relaxed) == ComponentState::running;
  }
  /// All that the thread still tries to write or read is dropped from now on. [any]
  void fence();

  /// A stop that does without [control] (exec/direct_stop.h): the task parks at its next boundary
  /// with its safe values written, and stays parked whatever change it takes. The job under way may
  /// take kHaltedJob. Its thread has to be woken, the guard to look again. [any]
  void halt() { halted_.store(true, std::memory_order_release); }
  /// An ordinary stop has taken over. [control]
  void end_halt() { halted_.store(false, std::memory_order_release); }
  [[nodiscard]] bool halted() const { return halted_.load(std::memory_order_acquire); }
  /// What it runs writes safe values when it parks. [any]
  [[nodiscard]] bool has_safe_values() const { return has_safe_values_.load(); }
  static constexpr Duration kHaltedJob = 2s;

  /// How long its job may run, on a thread of which kind; and since when it does. 0: none. [guard]
  [[nodiscard]] Duration bound(bool realtime) const;
  [[nodiscard]] Instant busy_since() const { return watched_.busy_since.load(); }
  /// When its next job is due (monotonic); far away: it does not run. [guard]
  [[nodiscard]] Instant told_release() const;
  /// The job that began then shall end where it is, when its thread is told to look.
  void interrupt(Instant since) { watched_.interrupt.store(since); }
  /// The job that began then never returns: its thread has no part in the component any more, what
  /// it holds is poisoned, and the task is the caller's until another thread goes on with it.
  /// False: the job has ended. The thread must not end meanwhile.
  bool lose_thread(Instant since);
  /// What the lost thread still uses.
  [[nodiscard]] std::vector<std::shared_ptr<const Bundle>> bundles() const;
  /// Its thread had another priority or other CPUs than its component asked for. [guard]
  void count_restored() { add<std::uint64_t>(counters_.restored, 1); }
  void park_for_good(const char* why);  ///< there is no other thread

  // --- [rt] -------------------------------------------------------------------------------------
  /// First and last thing on its thread: its job, or null.
  void runs_on(Job* job);
  /// Takes a change that need not wait for a boundary: an aborted one is given back; a decided one
  /// is taken now when no job lies between its instant and the armed release (realtime 8.4.9).
  /// False: as of release().
  bool serve();
  [[nodiscard]] bool running() const { return running_; }
  /// When the next job is due (monotonic); only while running.
  [[nodiscard]] Instant next_release() const { return release_; }
  /// Has the time of the next job come?
  [[nodiscard]] bool due() const { return running_ && clock_.now() >= release_; }
  /// The boundary and the job of the armed release. False: this thread was given up meanwhile, and
  /// has no part in the task any more.
  bool release();
  void go_on();  ///< first on the thread that goes on for a lost one: the fault of that one

 private:
  /// [control], which sees the new number, frees what was read before it.
  void looked() { looks_.store(looks_ + 1, std::memory_order_release); }
  static bool empty(std::atomic<Published*>& slot, Published& content);
  void drop_missed(Instant now);
  [[nodiscard]] bool meet_boundary(Instant now);
  [[nodiscard]] bool early(const Published& next) const;
  [[nodiscard]] bool claim(Published& next) { return empty(pending_, next); }
  [[nodiscard]] Published* take_over();
  void fetch(const Published& next);
  void put_in_place(Published& next);
  void keep_bundle(Published& next) const;
  void pile_up(Published& unused);
  /// `begin`: when the job that the change delays would have begun. False: as of release().
  [[nodiscard]] bool take(Published& next, Instant begin);
  [[nodiscard]] bool take_state(Published& next);
  void take_rest(Published& next);
  void fail_in_hand_over(const rt::Fault& fault);
  void wait_or_go_on(Published& step);
  Duration skip_gap(Instant until);
  void give_back(Published& next);
  void answer_between_jobs();
  void stand_still();
  void acknowledge();
  void map_state(const Published& next);
  void rearm(const Published& next, bool was_running);
  void keep_phase(const Published& next);
  struct JobEnd;
  [[nodiscard]] bool run_job(Instant now);
  void begin_job(Instant now);
  void conclude(Instant start, const JobEnd& end, const rt::Fault& fault);
  void hung();
  [[nodiscard]] bool may_recover() const;
  void skip_job();
  [[nodiscard]] FsmState* run_states(JobEnd& job);
  /// When a state ends, read once for each of them.
  [[nodiscard]] Instant state_time() const {
    return simulated_ == nullptr ? rt::fast_now() : simulated_->now();
  }
  void account(Instant start, const JobEnd& job);
  [[nodiscard]] std::optional<Duration> measure(Instant start, const JobEnd& job);
  [[nodiscard]] Duration held_up_since(Instant instant) const {
    return noise_ == nullptr ? Duration{0} : noise_->held_up_since(instant);
  }
  [[nodiscard]] Duration excuse(Instant released, Instant end);
  void park(ComponentState state);
  void count_overrun(Instant by);
  void overran_too_often(const TaskAttributes& task);
  /// The end of a job on probation.
  void watch_over(const JobUse& job);
  [[nodiscard]] JobTiming timing_of(const JobUse& job);
  void record_fault(Cause cause);
  void give_up_core();
  void on_fault(Cause cause);
  [[nodiscard]] bool leads_back() const;
  [[nodiscard]] bool gets_way_back() const;
  void write_safe_values();
  void note(rt::EventKind kind, LogLevel level, std::int64_t a = 0, std::int64_t b = 0);
  void tell(TraceKind kind, Instant time, std::int64_t value, std::uint64_t small = 0,
            std::uint32_t name = 0);
  void tell_taken(const Published& next, Instant time);
  void miss(std::uint64_t releases, Instant time, bool planned = false);

  static constexpr std::int64_t kUnknown = -1;
  std::string name_;
  const std::uint32_t trace_name_;
  const Clock& clock_;
  const Clock* const simulated_;  // null: the time is that of the machine
  const std::shared_ptr<const rt::Noise> noise_;
  rt::EventRing events_;
  rt::RequestRing requests_;
  Counters counters_;
  FaultRecord fault_;
  std::atomic<Trace*> trace_;
  rt::Watched watched_;
  std::atomic<Job*> job_{nullptr};  // of its thread
  std::atomic<bool> fenced_{false};
  std::atomic<bool> suspected_{false};
  std::atomic<std::int64_t> bound_{0};
  std::atomic<bool> has_safe_values_{false};

  alignas(64) std::atomic<Published*> pending_{nullptr};
  std::atomic<bool> halted_{false};  // beside what the thread looks at anyway
  alignas(64) std::atomic<Published*> unused_{nullptr};
  alignas(64) std::atomic<std::uint32_t> command_{0};
  alignas(64) std::atomic<Published*> back_{nullptr};  // the way back, while on probation
  std::atomic<Published*> relief_{nullptr};            // the fallback core, or a fresh one
  std::atomic<std::uint64_t> looks_{0};

  // Owned by the task's thread.
  Published* current_ = nullptr;
  rt::JobTimes* times_ = nullptr;        // where this job counts
  Published* unacknowledged_ = nullptr;  // taken, its first job not yet done
  Published* taking_ = nullptr;          // its converter runs
  const CoreBase* lost_ = nullptr;       // a thread that was given up may still be inside
  const Gate* thrown_out_of_ = nullptr;  // in whose service its last job failed
  FsmState* state_ = nullptr;            // the wait the task is in; null: before the initial state
  Instant t0_ = 0;
  Instant release_ = 0;  // logical: t0 + offset + clock of the component
  Duration wait_{0};     // that ended, or ends, at release_
  Instant parked_at_ = 0;
  std::uint64_t number_ = 0;   // of the last change it took
  rt::Fault hand_over_fault_;  // of the last converter
  Evidence evidence_;          // against the core, on probation
  Duration excused_{0};        // for so long the machine was held up during the job before
  Instant excused_until_ = 0;  // jobs released before this instant wait behind that one
  std::int64_t waits_before_ = kUnknown;  // of the thread, before the job, on probation
  Duration cpu_before_{0};  // of this thread, when the job began; zero: was not asked for
  bool preempted_ = false;  // the last job was
  bool running_ = false;
  bool waiting_ = false;  // at a barrier; it runs again after it
  FailedCore failed_;
};

}  // namespace exec
}  // namespace mauve
