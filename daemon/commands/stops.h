// SPDX-License-Identifier: LGPL-3.0-or-later
/// The stops of users (mauve/host/user_stops.h) in commands: they are saved before they are
/// answered, and a change that would start what a user stopped leaves it stopped and says so.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "commands/command.h"
#include "mauve/host/user_stops.h"

namespace mauve::daemon {

/// Whether the disk took a stop. A disk that does not answer delays the answer for 2 s at most.
class SavedStop {
 public:
  /// [disk]
  void done(bool saved) { state_ = saved ? State::saved : State::not_saved; }
  /// [any] It is known, or the disk took too long.
  [[nodiscard]] bool over() const;
  /// [any] Adds `saved` to an answer, and a note if the disk did not take the stop.
  void say(server::Outcome& outcome) const;

 private:
  enum class State : std::uint8_t { waits, saved, not_saved };

  std::atomic<State> state_{State::waits};
  const std::chrono::steady_clock::time_point until_ =
      std::chrono::steady_clock::now() + std::chrono::seconds(2);
};

/// [any] The user of this call stops something now.
[[nodiscard]] UserStop stop_by(const Call& call);

/// [any but rt] Writes the list of stops before all that waits for the disk.
void write_first(StateStore& store);

/// [control] Saves the stops before all that waits for the disk. Null: nothing is kept.
std::shared_ptr<SavedStop> save_stops(const Running& running);

/// [any] The same for a stop that [control] has not come to yet.
std::shared_ptr<SavedStop> save_stop_directly(const Running& running, const Call& call,
                                              const std::vector<std::string>& components);

/// [control] Answers a stop when it is saved.
void reply_when_saved(Running& running, const Call& call, server::Outcome outcome);

/// "uid 1000 stopped it at 2026-01-01T10:00:00Z"; of a stop that no user asked for: "mauved stopped
/// it at 2026-01-01T10:00:00Z: the required guardian was lost".
[[nodiscard]] std::string in_words(const UserStop& stop);

/// [control] The stop that keeps this component from running; null: none does.
[[nodiscard]] const UserStop* stop_of(const Running& running, const std::string& component);

/// A component that a user stopped would have been started, and stays stopped.
[[nodiscard]] std::string note_on(const std::string& component, const UserStop& stop);

/// [control] Takes those starts out of a change that no user names; edits that do nothing any more
/// go. Returns the notes.
[[nodiscard]] std::vector<std::string> leave_stopped(const Running& running, Change& change);

/// Components of this architecture that a user stopped do not start with it. Returns their names.
std::vector<std::string> leave_stopped(const UserStops& stops, Architecture& architecture);

/// [control] `lines` of a plan, judged in another process: those that would start what a user
/// stopped become notes.
void leave_stopped(const Running& running, Json& plan);

}  // namespace mauve::daemon
