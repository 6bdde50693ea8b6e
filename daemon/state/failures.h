// SPDX-License-Identifier: LGPL-3.0-or-later
/// The last failure of each component, with the events before it: kept when the log has rolled
/// over.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "log/log.h"

namespace mauve::daemon {

/// A change that a component took part in.
struct Attempt {
  std::uint64_t generation = 0;  ///< that it made
  std::string time;              ///< UTC
  std::string method;
  std::uint32_t uid = 0;
  std::string reason;
};

/// The reaction of the system to a failure.
enum class Reaction : std::uint8_t {
  parked,
  rolled_back,
  fell_back,
  restarted,
  recovers,  ///< not ended: another core takes over by itself
};
/// "parked", "rolled_back", "fell_back", "restarted", "recovers".
[[nodiscard]] std::string_view to_string(Reaction reaction);

/// A core, and the build of its plugin.
struct CoreBuild {
  std::string core;
  std::string build_id;
};

struct Failure {
  std::string time;  ///< UTC
  std::int64_t monotonic_ns = 0;
  std::string cause;  ///< "threw", "crashed"...
  std::string text;   ///< "sensor lost"
  CoreBuild culprit;
  std::string resource;  ///< in whose call it failed, so that the core is not to blame; empty: none
  std::string fsm_state;  ///< empty: not known
  std::uint64_t job = 0;  ///< the number of the job, counted since the component began
  Reaction reaction = Reaction::parked;
  std::string core_after;        ///< that runs, or would
  std::string state_after;       ///< of the component, when the failure was noticed; empty: faulted
  std::uint64_t generation = 0;  ///< in force when it failed
  std::uint64_t generation_after = 0;
  std::optional<Attempt> change;         ///< the last one before
  std::vector<logging::Record> records;  ///< of the component, up to the failure
  std::uint64_t times = 1;               ///< failures of this component since mauved began
};

/// One record a component. [control]
class Failures {
 public:
  static constexpr std::size_t kRecords = 20;

  /// Records the core that runs in the component now; the next failure counts for it.
  void runs(const std::string& component, CoreBuild core);
  [[nodiscard]] CoreBuild running(const std::string& component) const;
  /// Records that this change is in force in all these components.
  void changed(const std::vector<std::string>& components, const Attempt& attempt);
  [[nodiscard]] const Attempt* last_change(const std::string& component) const;

  /// Takes the place of the one before. A failure of the same instant is the same one, about which
  /// the system has done something else meanwhile: it is counted once. The log is asked later:
  /// real-time threads report it a little after things happen.
  void note(const std::string& component, Failure failure);
  /// Is the failure of this instant the last one that was noted, and is nothing newer known of the
  /// reaction?
  [[nodiscard]] bool knows(const std::string& component, std::int64_t monotonic_ns,
                           Reaction reaction) const;
  /// Adds the records of the log to those failures that are old enough.
  void ask_log(const logging::History& history, std::int64_t now);
  /// The same at once; null: it never failed.
  [[nodiscard]] const Failure* find(const std::string& component, const logging::History& history);
  /// Forgets all others: they have left.
  void keep_only(const std::set<std::string>& components);

 private:
  [[nodiscard]] const Failure* at(const std::string& component, std::int64_t monotonic_ns) const;
  struct Entry {
    CoreBuild core;
    std::optional<Attempt> change;
    std::optional<Failure> failure;
    bool complete = true;  ///< the log was asked
  };
  static void complete(const std::string& component, Entry& entry, const logging::History& history);

  std::map<std::string, Entry> entries_;
};

}  // namespace mauve::daemon
