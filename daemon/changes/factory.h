// SPDX-License-Identifier: LGPL-3.0-or-later
/// [factory]: the thread that runs user code, and another one when that does not return.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "changes/fair_queue.h"

namespace mauve::daemon {

/// What [factory] was left behind in.
struct LeftBehind {
  std::string hook;  ///< "first.core on_configure"; empty: not known
  std::chrono::system_clock::time_point since;
  std::optional<uid_t> user = {};  ///< whose change it belongs to; none: of the system itself
};

/// Runs work one after another, that of changes first. Work that does not return is given up: its
/// thread is left behind with all that it may still touch, and a fresh one goes on. Should the work
/// return after all, the old thread frees what it holds, and ends.
class Factory {
 public:
  using Job = std::function<void()>;
  /// Instead of what follows the work; it is told the hook.
  using GivenUp = std::function<void(const std::string& hook)>;

  /// `go_on` takes what follows a piece of work to [control].
  explicit Factory(std::function<void(Job)> go_on);
  ~Factory();
  Factory(const Factory&) = delete;
  Factory& operator=(const Factory&) = delete;

  void start();
  /// Runs what is queued, then ends. Later work is dropped. Does not wait for who is left behind.
  void stop();
  /// [any] Runs `work` when it is the turn of the user that asks, then `then` on [control].
  void post(Job work, Job then, GivenUp given_up, const Asker& asker = {});

  /// [control] Work that is given up from now on belongs to a change of this user.
  void works_for(std::optional<uid_t> user) { user_ = user; }
  /// [control] Gives work up that has been under way for `bound`, unless its thread uses the model
  /// just now: so look again. What was given up now; nothing: empty.
  std::vector<LeftBehind> look(std::chrono::nanoseconds bound);
  /// [any] Who has not returned.
  [[nodiscard]] std::vector<LeftBehind> left_behind() const;

 private:
  struct Thread;
  struct Shared;

  static void run(const std::shared_ptr<Shared>& shared, const std::shared_ptr<Thread>& self);
  void begin();

  const std::shared_ptr<Shared> shared_;
  std::thread thread_;
  std::optional<uid_t> user_;
  std::vector<std::pair<LeftBehind, std::shared_ptr<const Thread>>> left_;
};

}  // namespace mauve::daemon
