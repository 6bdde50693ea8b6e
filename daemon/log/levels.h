// SPDX-License-Identifier: LGPL-3.0-or-later
/// From which level on records are accepted: of all, or of one component; for good, or for a time.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "log/event.h"

namespace mauve::logging {

/// Those of a component are looked at where its records arrive, never on its own thread. [any]
class Levels {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit Levels(Level usual) : usual_(usual) {}

  /// Of a component, or (empty) of all that have none of their own; nothing: the usual one again.
  /// After `until` the level that was set for good before is in force again.
  void set(const std::string& component, std::optional<Level> level,
           std::optional<Time> until = {});

  [[nodiscard]] Level of(const std::string& component) const;
  /// That of mauved's command line.
  [[nodiscard]] Level usual() const { return usual_; }

  struct Setting {
    std::string component;  ///< empty: all
    Level level = Level::info;
    std::optional<Time> until;
  };
  /// The settings that differ from the usual level: first the one for all components, then by name.
  [[nodiscard]] std::vector<Setting> list() const;

  /// Ends the settings whose time is over, and returns the level in force after each of them.
  std::vector<Setting> expire(Time now);

 private:
  struct Entry {
    std::optional<Level> lasting;
    std::optional<Setting> passing;

    [[nodiscard]] std::optional<Level> level() const {
      return passing ? std::optional(passing->level) : lasting;
    }
  };
  [[nodiscard]] Level of_locked(const std::string& component) const MAUVE_REQUIRES(mutex_);

  const Level usual_;
  mutable Mutex mutex_;
  std::map<std::string, Entry> entries_ MAUVE_GUARDED_BY(mutex_);
};

}  // namespace mauve::logging
