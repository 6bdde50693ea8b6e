// SPDX-License-Identifier: LGPL-3.0-or-later
/// Answers requests in time whose deadline (`deadline_ms`) passes.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/mutex.h"

namespace mauve::daemon {

struct Call;
struct Running;

/// How far a change is. Only this word decides whether a deadline still keeps a change from taking
/// effect.
enum class Stage : std::uint8_t {
  waiting,    ///< it has not begun
  preparing,  ///< beside the running system: it can be dropped
  under_way,  ///< it may take effect at any time
  expired,    ///< its deadline passed before
};

class Deadlines {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// [io] Before the request is on its way: from now on it has one answer, whichever is first.
  void watch(const std::shared_ptr<Call>& call);
  /// [health] Answers requests whose deadline has passed.
  void look(const Running& running, Time now);

 private:
  struct Watched {
    Time at;
    std::weak_ptr<Call> call;
  };

  Mutex mutex_;
  std::vector<Watched> watched_ MAUVE_GUARDED_BY(mutex_);
};

/// [control] The change goes on to this stage; false: it was dropped.
[[nodiscard]] bool advance_to(Stage next, std::atomic<Stage>& stage);

}  // namespace mauve::daemon
