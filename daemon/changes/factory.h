// SPDX-License-Identifier: LGPL-3.0-or-later
/// [factory]: the thread that runs user code, and another one when that does not return.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "changes/fair_queue.h"
#include "rt/thread/thread.h"

namespace mauve::daemon {

/// A thread of [factory] whose work did not return.
struct AbandonedThread {
  std::string hook;  ///< "first.core on_configure"; empty: not known
  std::chrono::system_clock::time_point since;
  std::optional<uid_t> user = {};  ///< whose change it belongs to; none: of the system itself
};

/// Runs work one after another, that of changes first. When work does not return, its thread is
/// abandoned with all that it may still touch, and a fresh thread goes on. Should the work return
/// after all, the abandoned thread frees its objects and ends.
class Factory {
 public:
  using Job = std::function<void()>;
  /// Called in place of the job that follows the work; its argument is the hook.
  using OnAbandoned = std::function<void(const std::string& hook)>;

  /// `on_control` takes the job that follows a piece of work to [control].
  explicit Factory(std::function<void(Job)> on_control);
  ~Factory();
  Factory(const Factory&) = delete;
  Factory& operator=(const Factory&) = delete;

  void start();
  /// Runs the queued work, then ends, and drops later work. It waits for no abandoned thread.
  void stop();
  /// [any] Runs `work` when it is the turn of the user that asks, then `then` on [control].
  void post(Job work, Job then, OnAbandoned on_abandoned, const Asker& asker = {});

  /// [control] A thread that is abandoned from now on worked for a change of this user.
  void works_for(std::optional<uid_t> user) { user_ = user; }
  /// [control] Abandons the thread when its work has been under way for `bound`, unless the thread
  /// uses the model just now: then call it again. The threads that this call abandoned.
  std::vector<AbandonedThread> look(std::chrono::nanoseconds bound);
  /// [any] Those that have not returned.
  [[nodiscard]] std::vector<AbandonedThread> abandoned_threads() const;

 private:
  struct Thread;
  struct Shared;

  static void run(const std::shared_ptr<Shared>& shared, const std::shared_ptr<Thread>& self);
  void begin();

  const std::shared_ptr<Shared> shared_;
  std::shared_ptr<rt::Thread> thread_;
  std::optional<uid_t> user_;
  std::vector<std::pair<AbandonedThread, std::shared_ptr<const Thread>>> left_;
};

}  // namespace mauve::daemon
