// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource kind "teleop/priority": hands on the velocity of the most urgent source that still
/// speaks: `teleop`, else `command`. One that wrote nothing for its time-out is silent. When all
/// are, service `read` answers no_data, and a reading port gets its default: stand still.
/// Example: mauvectl get priority.core.selected
#include <cstdint>
#include <optional>

#include <mauve/job.h>

#include "parts.h"
#include "selection.h"

/// The state that survives a change: the last command of each source, and its time. Opaque to
/// tools; raise the revision when anything in it changes.
template <>
struct mauve::Described<teleop::Sources> {
  static constexpr std::string_view name = "teleop_sources/1";
  static constexpr auto fields() { return std::tuple{}; }
};

namespace teleop {
namespace {

using rover::Velocity;

struct PriorityShell : mauve::Shell {};

class Priority final : public mauve::Core<PriorityShell> {
 public:
  void teleop(const Velocity& velocity) { take(state->teleop, velocity); }
  void command(const Velocity& velocity) { take(state->command, velocity); }
  std::optional<Velocity> read() { return said_by(look(), *state); }

 private:
  mauve::State<Sources> state{*this};
  mauve::Parameters<Timeouts> timeouts{*this};
  mauve::Observable<int> selected{*this, "selected", 0, "0 none, 1 command, 2 teleop"};
  mauve::Observable<std::uint64_t> take_overs{*this, "take_overs", 0, "times `teleop` took over"};
  mauve::Observable<std::uint64_t> refused{*this, "refused", 0, "velocities that were no numbers"};

  void take(Said& source, const Velocity& velocity) {
    if (!hear(source, velocity, mauve::job_time())) ++refused;
    look();
  }

  Source look() {
    const Source now = choose(*state, timeouts, mauve::job_time());
    if (now == Source::teleop && selected != static_cast<int>(now)) ++take_overs;
    selected = static_cast<int>(now);
    return now;
  }
};

struct PriorityInterface : mauve::Interface<Priority> {
  mauve::WriteService<Velocity> teleop{*this, "teleop", &Priority::teleop};
  mauve::WriteService<Velocity> command{*this, "command", &Priority::command};
  mauve::ReadService<Velocity> read{*this, "read", &Priority::read};
};

}  // namespace

void declare_priority(mauve::Plugin& plugin) {
  plugin.resource<PriorityShell, Priority, PriorityInterface>("priority");
}

}  // namespace teleop
