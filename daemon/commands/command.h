// SPDX-License-Identifier: LGPL-3.0-or-later
/// The description of a command, and the state that commands work on.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "changes/control.h"
#include "changes/stopper.h"
#include "commands/deadlines.h"
#include "commands/recovery/former.h"
#include "commands/recovery/place_probation.h"
#include "commands/recovery/rollback_lines.h"
#include "judge/judgement.h"
#include "log/log.h"
#include "mauve/host/deploy_options.h"
#include "mauve/host/deployer.h"
#include "mauve/host/user_stops.h"
#include "monitor/counts.h"
#include "monitor/disk_watch.h"
#include "plugin/load/catalog.h"
#include "server/dispatcher.h"
#include "server/server.h"
#include "state/deciding_paths.h"
#include "state/failures.h"
#include "state/generations.h"
#include "state/proofs.h"
#include "state/rollbacks.h"

namespace mauve {
class Architecture;
}  // namespace mauve

namespace mauve::daemon {

class Guardian;
class SavedStop;
class StateStore;
class Recorder;
class Supervisor;
class Watches;

using protocol::Fault;
using protocol::Json;

/// The lock that an administrator has set. `params` refuses changes of properties, `topology` all
/// others except starts and stops, `all` everything except stops and confirmations. No lock refuses
/// a rollback, or a standby core that takes over, after a failure.
enum class Lock : std::uint8_t { none, params, topology, all };

/// The user who set the lock.
struct LockRequest {
  uid_t uid = 0;
  std::string time;    ///< UTC
  std::string reason;  ///< as given, may be empty
};

/// The author of the generation in force, where that is known.
struct Author {
  std::uint64_t generation = 0;
  uid_t uid = 0;
  std::string command;
  std::string changes;      ///< in the lines of `plan`, bounded; may be empty
  std::string reason = {};  ///< as given; of a change that mauved made by itself its cause
};

/// A generation in force that has no rollback: after a start, or a reload with probation off.
struct Unproven {
  std::uint64_t generation = 0;
  std::chrono::steady_clock::time_point since = {};
  std::vector<FailureMark> changed = {};  ///< the components with new cores
  std::uint64_t replaces = 0;  ///< a saved one that goes when this one is confirmed; 0: none
};

/// The start of this run of mauved, and whether its architecture has proved itself: see
/// recovery/unproven.h.
struct Started {
  std::uint64_t generation = 0;  ///< that the run began with; 0: not begun, or nothing is kept
  std::chrono::steady_clock::time_point since = {};  ///< when its components had started
  unsigned crashes = 0;   ///< runs in a row before this one that crashed with this architecture
  bool long_ago = false;  ///< the run has lasted ten minutes; `running` on the disk says so
  bool proves = true;     ///< none of its components has failed yet, and its time is not over
};

/// The running system as commands see it; the Daemon that owns it outlives every command. The model
/// (architecture, deployer, catalog) is used on [control] only, save where a comment names
/// [factory].
struct Running {
  Architecture& architecture;
  Deployer& deployer;
  plugin::Catalog& catalog;
  Control& control;
  logging::Log& log;
  Watches& watches;
  Supervisor& supervisor;
  std::function<std::vector<server::ClientInfo>()> clients;  ///< [any]
  std::string boot;                                          ///< a random id of this run
  std::chrono::steady_clock::time_point since;               ///< when mauved began; see uptime_s
  std::atomic<std::uint64_t> generation{0};                  ///< a copy for other threads
  /// [control] How often each component was stopped by request. A change that was asked for before
  /// such a stop does not start the component again.
  std::map<std::string, std::uint64_t> stops = {};
  /// [control] When the last such stop of each component was received. A change that was received
  /// earlier, but is served after the stop, is refused if it starts the component.
  std::map<std::string, std::chrono::steady_clock::time_point> stops_came = {};
  /// [control] Components that [stop] stopped for the end of mauved.
  std::set<std::string, std::less<>> stopped_by_end = {};
  UserStops* user_stops = nullptr;  ///< [control] what users have stopped; null: no list
  /// [control] Cores that were rolled back, by version, and why: see recovery/quarantine.h.
  std::map<std::string, std::string> quarantined = {};
  /// [control] Components that an abandoned thread may still be in, and its hook.
  std::map<std::string, std::string> abandoned_in = {};
  Unproven unproven = {};                   ///< [control] see recovery/unproven.h
  Proofs proofs = {};                       ///< [control] of this run
  Former former = {};                       ///< [control] code that reloads have replaced
  std::vector<PlaceProbation> places = {};  ///< [control] swaps in place on probation
  RollbackLines rollback_lines = {};        ///< [control] of the changes on probation
  Rollbacks rollbacks = {};                 ///< [control] of this run
  Started started = {};                     ///< [control]
  std::uint64_t recovered = 0;  ///< the saved generation that this run began with; 0: the file
  /// [control] Plugins of which the recovered generation ran another build than the start loaded.
  OtherBuilds other_builds = {};
  StateStore* store = nullptr;   ///< null: nothing is kept
  Guardian* guardian = nullptr;  ///< [any] for `status`; null: it shows none
  Recorder* recorder = nullptr;  ///< of traces; its functions name their threads
  Lock lock = Lock::none;        ///< [control], see lock.h
  LockRequest locked = {};       ///< [control] of the lock in force
  Author author = {};            ///< [control] of the newest generation by request
  std::uint64_t rollback = 0;    ///< [control] the generation of the newest rollback; 0: none
  Realtime realtime = Realtime::prefer;     ///< as mauved was started
  std::vector<std::string> path_dirs = {};  ///< further directories that path_rule() allows
  std::vector<DecidingPath> deciding = {};  ///< see deciding_paths.h
  DiskWatch disk_watch = {};                ///< [control]
  Failures failures = {};                   ///< [control] see commands/look/notice.h
  server::Refusals refusals = {};           ///< [any]
  Counts counts = {};                       ///< [any]
  Deadlines deadlines = {};                 ///< [any]
  /// [any] Judges a file of this user beside the running system, then calls the function on
  /// [control]: see Judge::ask().
  std::function<void(const Asker&, const Question&, std::function<void(Result<Json>)>)> judge = {};
  /// [any] The same for the change under way, for try_out(): see commands/change/trial.h.
  std::function<void(const Question&, std::function<void(Result<Json>)>)> judge_change = {};
  Stopper* stopper = nullptr;  ///< [any]; null: stops are served by [control] only
  /// [control] Reports and saves the outcomes that the system reached by itself since the last
  /// call, such as rollbacks, before a later change is saved.
  std::function<void()> report_outcomes = [] {};
  /// [control] Reports and saves one more outcome, which the deployer does not know of.
  std::function<void(const Outcome&)> settle = [](const Outcome&) {};
};

/// One request under way. Dropped unanswered only when the daemon ends.
struct Call {
  server::Caller caller;
  const protocol::Method* method = nullptr;
  Json params;
  server::Reply reply;
  std::chrono::steady_clock::time_point received;
  std::uint64_t before = 0;  ///< the generation that the request met
  std::uint64_t made = 0;    ///< the generation that its change has made; 0: none yet
  /// [control] Its change has made this one. The answer comes later, when that is saved.
  std::function<void(std::uint64_t made)> on_made = {};
  /// How often each component was stopped by request when this one began: see Running::stops.
  std::optional<std::map<std::string, std::uint64_t>> stops = std::nullopt;
  /// The mark of the generation that the call makes. Nothing: it has the mark of the generation
  /// before, since a change that only stops or starts components proves nothing about them.
  std::optional<Confirmation> mark = std::nullopt;
  /// See check_conditions(). Copies share it.
  std::shared_ptr<std::atomic<Stage>> stage = std::make_shared<std::atomic<Stage>>(Stage::waiting);
  bool confirms = false;  ///< the generation that runs is confirmed before the answer
  std::shared_ptr<StopOrder> order = nullptr;       ///< of a stop, where it is watched
  std::shared_ptr<void> watched = nullptr;          ///< ends that order; of a stop by mauved itself
  std::shared_ptr<SavedStop> saved_stop = nullptr;  ///< of component.stop, where stops are saved
  bool keeps_a_thread = false;                      ///< a hook did not return, and keeps a thread
};
using CallPtr = std::shared_ptr<Call>;

[[nodiscard]] inline Asker asker_of(const Call& call) {
  return {call.caller.role, call.caller.peer.uid};
}

/// A change holds its ticket until it is over; the next one begins then.
using Ticket = Control::Ticket;

using protocol::Lane;

/// The result is the answer.
using AnswersAtOnce = Result<Json>(Running&, const Call&);
/// The function answers by itself when it is done.
using AnswersLater = void(Running&, const CallPtr&, Ticket);

constexpr bool answers_later(Lane lane) {
  return lane == Lane::later || lane == Lane::urgent || lane == Lane::change;
}
template <Lane lane>
using Handler = std::conditional_t<answers_later(lane), AnswersLater, AnswersAtOnce>;

/// The function that serves a method: one of the two, by the lane of the method.
struct Command {
  constexpr explicit Command(AnswersAtOnce* handler) : at_once(handler) {}
  constexpr explicit Command(AnswersLater* handler) : later(handler) {}

  AnswersAtOnce* at_once = nullptr;
  AnswersLater* later = nullptr;
};

/// [any] The command of a row of protocol::methods().
[[nodiscard]] const Command& command_of(const protocol::Method& method);

// Declares the handler that each row of methods.def names. Its definition is in a source of
// commands/.
#define MAUVE_RECORD(...)
#define MAUVE_METHOD(name, handler, role, lane, ...) Handler<Lane::lane> handler;
#include "protocol/methods.def"

/// [io] Before stop() is on its way to [control]: see Stopper.
void watch_over_stop(Running&, const CallPtr&);

}  // namespace mauve::daemon
