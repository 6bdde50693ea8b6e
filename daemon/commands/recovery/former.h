// SPDX-License-Identifier: LGPL-3.0-or-later
/// The code that a reload replaced. It stays in memory as long as the reload is on probation, since
/// the rollback leads to it, and gets its names back when the reload is rolled back.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "log/event.h"
#include "mauve/result.h"
#include "plugin/load/catalog.h"
#include "state/builds.h"

namespace mauve {
class Retired;
struct Outcome;
}  // namespace mauve

namespace mauve::daemon {

struct Running;

/// [control]
struct Former {
  struct Kept {
    std::uint64_t generation = 0;  ///< that the reload made
    plugin::LoadedPlugin plugin;
  };
  /// Code without names, which some thread may still look at.
  struct Leaving {
    std::shared_ptr<plugin::Library> library;
    std::chrono::steady_clock::time_point since;
    std::string text;  ///< for the log, when it has left the memory
  };
  std::map<std::string, Kept, std::less<>> kept;  ///< by plugin
  std::vector<Leaving> leaving;
};

/// Whether replaced or unloaded code has left the memory, in the words of the log.
[[nodiscard]] logging::Event event_of(const plugin::Unmapped& code);

/// [factory] Releases the elements, and logs the first hook of them that failed.
void clean_up(Running& running, Retired& retired);

/// [control] Refused while a reload of this plugin is on probation: only one former build is kept.
[[nodiscard]] Status check_former(const Running& running, const std::string& plugin);

/// [control] The reload that made this generation is on probation.
void keep_former(Running& running, std::uint64_t generation, plugin::LoadedPlugin former);

/// [control] The code of this library has no names any more. Its memory is freed when no thread
/// looks at it; the log then says `text`.
void let_go(Running& running, std::shared_ptr<plugin::Library> library, std::string text);

/// [control] A note on each plugin whose reload is one of these changes: undone, it leaves its file
/// as it is.
[[nodiscard]] std::vector<std::string> notes_on_files(const Running& running,
                                                      const std::vector<std::uint64_t>& changes);

/// [control] The builds that run after this outcome: a rollback gives the names of a reloaded
/// plugin back to its former build.
[[nodiscard]] Builds builds_after(const Running& running, const Outcome& outcome);

/// [control] A probation has ended: the code that is not needed any more leaves, and after a
/// rollback the former one has its names again.
void let_former_go(Running& running, const Outcome& outcome);

/// [control] Frees on [factory] the code that no thread looks at any more.
void free_former(Running& running);

}  // namespace mauve::daemon
