// SPDX-License-Identifier: LGPL-3.0-or-later
/// The threads behind the socket: [control] owns the model, [factory] does the work that takes
/// long.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "base/mutex.h"
#include "base/thread_role.h"
#include "changes/factory.h"
#include "changes/fair_queue.h"
#include "changes/viewer_share.h"

namespace mauve::daemon {

/// A thread that runs closures one after another.
class WorkerThread {
 public:
  using Job = std::function<void()>;

  explicit WorkerThread(ThreadRole role) : role_(role) {}
  ~WorkerThread();
  WorkerThread(const WorkerThread&) = delete;
  WorkerThread& operator=(const WorkerThread&) = delete;

  void start();
  /// Runs the queued jobs, then ends. Later jobs are dropped.
  void stop();
  /// [any] Drops all queued jobs: the job under way is the last one.
  void halt();
  /// [any] When it is the turn of its user, or in front of everything queued before. Dropped
  /// (false) after stop(). On [control] a viewer has a share (viewer_share.h).
  bool post(Job job, const Asker& asker = {});
  bool post_urgent(Job job);
  /// The same, also in front of the urgent ones.
  bool post_first(Job job);
  [[nodiscard]] bool is_this_thread() const;
  /// [any, between start() and stop()] SCHED_FIFO where it is permitted; 0: ordinary.
  void set_priority(int priority);
  /// [any] When the job under way began; nothing: no job is under way.
  [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> busy_since();
  /// [this thread] Runs `then` once `over` returns true. It is called between other jobs, soon at
  /// first, at least each millisecond later. Dropped when the thread ends.
  void await(std::function<bool()> over, Job then);

 private:
  struct Awaited {
    std::function<bool()> over;
    Job then;
  };

  struct Queued {
    Job job;
    Asker asker;
  };

  void run();
  bool take(Queued& next);
  void run_job(const Queued& queued);
  /// Whether a viewer may be served now, as a FairQueue asks.
  [[nodiscard]] auto may_now() const MAUVE_REQUIRES(mutex_) {
    return [share = &share_, all = stopping_, now = ViewerShare::Clock::now()](uid_t viewer) {
      return all || share->may(viewer, now);
    };
  }
  void look_at_awaited();

  const ThreadRole role_;
  Mutex mutex_;
  ConditionVariable wake_;
  std::deque<Job> urgent_ MAUVE_GUARDED_BY(mutex_);
  FairQueue<Queued> jobs_ MAUVE_GUARDED_BY(mutex_);
  ViewerShare share_ MAUVE_GUARDED_BY(mutex_);  // of [control]
  bool stopping_ MAUVE_GUARDED_BY(mutex_) = false;
  std::optional<std::chrono::steady_clock::time_point> busy_since_ MAUVE_GUARDED_BY(mutex_);
  std::vector<Awaited> awaited_;  // this thread's own
  std::chrono::microseconds pause_{0};
  std::thread thread_;
};

/// Orders requests: reads run at once, changes one at a time, urgent things before all others;
/// where several wait, a FairQueue chooses the next one.
///
/// A change may take long: it sends its slow part to [factory] and gives [control] back meanwhile,
/// so that reads and `component.stop` are served. The next change begins when it is done.
class Control {
 public:
  using Job = std::function<void()>;

  /// Held by a change for as long as it lasts; the next one begins when the last copy is gone, on
  /// whichever path that happens.
  using Ticket = std::shared_ptr<void>;
  using Change = std::function<void(Ticket)>;

  /// How long [factory] may take for one piece of work, until its thread is abandoned.
  explicit Control(std::chrono::nanoseconds prepare_within = std::chrono::seconds(10));
  ~Control();

  void start();
  /// Lets the work under way end and drops the changes that wait; objects that they hold (a Reply)
  /// are destroyed. [main]
  void stop();

  /// [control] The job that calls this is the last one on [control]: no change can follow.
  void halt() { control_.halt(); }

  /// [any] Runs on [control] as soon as that is free; a change under way does not hold it up.
  void read(Job job, const Asker& asker = {});
  /// [any] The same, before everything that waits.
  void urgent(Job job);
  /// [any, between start() and stop()] SCHED_FIFO of [control], where it is permitted; 0: ordinary.
  void set_priority(int priority) { control_.set_priority(priority); }
  /// [any] Runs on [control] when no other change is under way. False: too many wait already.
  [[nodiscard]] bool change(Change change, const Asker& asker = {});

  /// [any] Runs `work` on [factory], then `then` on [control]; when its thread is abandoned, only
  /// `on_abandoned`, also on [control]. That must not share anything with the work.
  void in_factory(Job work, Job then, Factory::OnAbandoned on_abandoned = {},
                  const Asker& asker = {});
  /// [any] Runs on [answer], when it is the turn of its user: a long answer is written out, for
  /// which nothing of the model is needed.
  void write_out(Job job, const Asker& asker);
  /// [any] How many of this user are not written out yet. Callers allow kLongAnswers.
  [[nodiscard]] std::size_t long_answers(uid_t uid) const;
  /// [control] The change that begins now is of this user; none: of the system itself.
  void works_for(std::optional<uid_t> user) { factory_.works_for(user); }
  /// [control] Call it some times a second. The threads that it abandoned now.
  std::vector<AbandonedThread> look_after_factory();
  /// [any] Abandoned threads that have not returned.
  [[nodiscard]] std::vector<AbandonedThread> abandoned_threads() const {
    return factory_.abandoned_threads();
  }
  [[nodiscard]] std::chrono::nanoseconds prepare_within() const { return prepare_within_; }
  /// [control] Runs `then` when `over` returns true; meanwhile [control] serves others.
  void await(std::function<bool()> over, Job then) {
    control_.await(std::move(over), std::move(then));
  }

  /// [any] Whether a change is under way.
  [[nodiscard]] bool busy() const;
  [[nodiscard]] bool on_control_thread() const { return control_.is_this_thread(); }

  static constexpr std::size_t kWaiting = 256;    ///< changes: 32 clients with 8 requests each
  static constexpr std::size_t kLongAnswers = 8;  ///< of one user: each may take some megabytes

 private:
  void begin_next();
  void ended();

  mutable Mutex mutex_;
  FairQueue<Change> waiting_ MAUVE_GUARDED_BY(mutex_);
  bool busy_ MAUVE_GUARDED_BY(mutex_) = false;
  bool stopping_ MAUVE_GUARDED_BY(mutex_) = false;
  std::map<uid_t, std::size_t> long_answers_
      MAUVE_GUARDED_BY(mutex_);  ///< that are not written out yet
  WorkerThread control_{ThreadRole::control};
  WorkerThread answer_{ThreadRole::answer};
  Factory factory_{[this](Job then) { control_.post(std::move(then)); }};
  const std::chrono::nanoseconds prepare_within_;
};

}  // namespace mauve::daemon
