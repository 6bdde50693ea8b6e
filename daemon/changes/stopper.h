// SPDX-License-Identifier: LGPL-3.0-or-later
/// [stop]: a stop does not depend on [control]. Each stop request goes to [control] like any other
/// request, and [stop] watches it. If [control] is held up (by code of a plugin, a lock, a bug),
/// [stop] stops the components itself; [control] updates its records when it goes on.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/mutex.h"
#include "log/log.h"
#include "mauve/host/ongoing.h"

namespace mauve {
class Deployer;
}  // namespace mauve

namespace mauve::daemon {

/// A stop that [control] was asked for.
class StopOrder {
 public:
  /// `components`: none: all. `applies` is asked right before it is carried out directly: false:
  /// [control] is going to refuse it. `report` gets the end of that, also that some run still, with
  /// the names of all that ran; it is called again as long as it returns false. Both may be empty,
  /// and are called on [stop].
  StopOrder(std::vector<std::string> components, std::function<bool()> applies,
            std::function<bool(const DirectStop&, const std::vector<std::string>& ran)> report)
      : components_(std::move(components)),
        applies_(std::move(applies)),
        report_(std::move(report)) {}

  /// [control] serves it from now on. True: it was carried out directly.
  bool begin();
  /// [control] found these running when it began to stop them.
  void found(std::vector<std::string> running);
  /// [control] has served it, or refused it: it is not carried out directly any more.
  void end(Deployer& deployer);
  /// Components that ran when it was carried out directly; none: it was not. [any]
  [[nodiscard]] std::vector<std::string> stopped_directly() const;

 private:
  friend class Stopper;

  [[nodiscard]] std::vector<std::string> ran() const MAUVE_REQUIRES(mutex_);

  const std::vector<std::string> components_;
  const std::function<bool()> applies_;
  const std::function<bool(const DirectStop&, const std::vector<std::string>& ran)> report_;

  mutable Mutex mutex_;  ///< guards the members below
  bool begun_ MAUVE_GUARDED_BY(mutex_) = false;
  bool over_ MAUVE_GUARDED_BY(mutex_) = false;
  std::vector<std::string> found_ MAUVE_GUARDED_BY(mutex_);
  std::unique_ptr<DirectStop> direct_ MAUVE_GUARDED_BY(mutex_);
  unsigned waited_ MAUVE_GUARDED_BY(mutex_) =
      0;  ///< looks of [stop] since it came, or since [control] did something
  std::uint64_t looks_ MAUVE_GUARDED_BY(mutex_) = 0;  ///< of [control] then
};

class Stopper {
 public:
  explicit Stopper(logging::Log& log) : log_(log) {}
  ~Stopper() { stop(); }
  Stopper(const Stopper&) = delete;
  Stopper& operator=(const Stopper&) = delete;

  /// [main] The deployer outlives stop(). `priority`: SCHED_FIFO of [stop], where it is permitted;
  /// 0: ordinary. `hasten` is called on [stop]: true while a stop is watched, false when none is.
  void start(Deployer& deployer, int priority, std::function<void(bool)> hasten);
  void stop();
  /// [any] Never waits. From now on until its end.
  void watch(std::shared_ptr<StopOrder> order);

  /// [control] may leave a stop alone for so long; after so many looks of [stop] at such a distance
  /// it counts as held up. Looks are counted, since a machine that stands still holds up both.
  static constexpr unsigned kPatience = 5;
  static constexpr std::chrono::milliseconds kEvery{5};

 private:
  void run();
  void hasten_control();
  [[nodiscard]] bool look(StopOrder& order);
  [[nodiscard]] bool is_held_up(StopOrder& order) const MAUVE_REQUIRES(order.mutex_);
  [[nodiscard]] bool begin_directly(StopOrder& order) MAUVE_REQUIRES(order.mutex_);

  logging::Log& log_;
  Deployer* deployer_ = nullptr;
  std::function<void(bool)> hasten_;
  bool hastened_ = false;  ///< [stop]
  Mutex mutex_;            ///< guards the next two; no thread holds it long
  std::vector<std::shared_ptr<StopOrder>> new_ones_ MAUVE_GUARDED_BY(mutex_);
  bool stopping_ MAUVE_GUARDED_BY(mutex_) = false;
  ConditionVariable wake_;
  std::vector<std::shared_ptr<StopOrder>> orders_;  ///< [stop]
  std::thread thread_;
};

}  // namespace mauve::daemon
