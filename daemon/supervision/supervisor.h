// SPDX-License-Identifier: LGPL-3.0-or-later
/// The changes that the daemon makes by itself: rules that fire, and transactions that components
/// request.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/mutex.h"
#include "commands/command.h"
#include "rules/engine.h"
#include "supervision/makers.h"

namespace mauve::daemon {

/// Looks at the rules 100 times a second on [control], while there are any. Transactions go the way
/// of every change: one at a time, so a change under way delays them. An event reports the outcome
/// of each.
class Supervisor {
 public:
  explicit Supervisor(Control& control) : control_(control) {}
  ~Supervisor() { stop(); }
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// The rules of the architecture file and the permissions of components. Rules that are the same
  /// as before go on as they are; the others begin anew, armed. `generation`: of the change that
  /// brings it. [main] before start(), then [control]
  void adopt(rules::Supervision supervision, std::uint64_t generation = 0);
  /// The changes that made these generations were rolled back: the supervision that they replaced,
  /// if any, is in force again, with its rules armed. `failed`: because a component failed; else a
  /// rule whose action was taken back fires again while its condition holds. [control]
  void roll_back(const std::vector<std::uint64_t>& generations, bool failed);
  /// A sentence on each of these generations that a rule or a component made. [control]
  [[nodiscard]] std::vector<std::string> notes_on(
      const std::vector<std::uint64_t>& generations) const;
  /// A sentence on each of these rules that would begin anew and fire soon. [control]
  [[nodiscard]] std::vector<std::string> notes_on_change(const rules::Supervision& wanted) const;
  /// Begins to look, as soon as [control] runs. [main]
  void start(Running& running);
  /// [main], before [control] ends.
  void stop();

  /// A component's real-time code asked for it. [log]
  void request(std::string component, std::string transaction);

  [[nodiscard]] const rules::Supervision& supervision() const { return supervision_; }
  /// How often adopt() replaced the rules. [control]
  [[nodiscard]] std::uint64_t adoptions() const { return adoptions_; }
  /// [control]
  [[nodiscard]] const rules::Engine& engine() const { return engine_; }
  /// The values behind the addresses of conditions now. [control]
  [[nodiscard]] rules::ReadFresh reader() const;
  /// One row a rule, of one rule only when it is named. [control]
  [[nodiscard]] Result<Json> list(const std::string& rule) const;

 private:
  /// A transaction on its way.
  struct Dispatch {
    std::string transaction;  ///< as it is called in the log
    std::string by;           ///< "by rule gnss_lost"
    std::string component;    ///< that requested it; may be empty
    rules::Steps steps;
    std::function<void(const std::string& answer, rules::Ended ended)> done;
    std::string values = {};                 ///< of the rule's condition: "second.core.input is 6"
    std::optional<rules::RuleId> rule = {};  ///< that fired
  };

  void begin_to_look();
  void run();
  void look();
  void fire(std::size_t rule);
  void report_blocked();
  void report_sight(const rules::SightChange& change);
  void serve(const std::string& component, const std::string& transaction);
  void refuse_request(const Dispatch& dispatch, const Error& error);
  void carry_out(Dispatch dispatch);
  void conclude(const Dispatch& dispatch, const server::Outcome& outcome,
                bool keeps_a_thread = false);
  [[nodiscard]] const rules::Steps& steps_of(const rules::Rule& rule) const;

  Control& control_;
  rules::Supervision supervision_;
  rules::Supervision before_;                    // replaced by the newest adoption, [control]
  std::uint64_t adopted_in_ = 0;                 // the generation of that, [control]
  rules::Engine engine_;                         // [control]
  std::uint64_t adoptions_ = 0;                  // [control]
  std::map<rules::RuleId, Instant> blocked_at_;  // reported, [control]
  std::set<std::pair<std::string, std::string>> under_way_;  // requests, [control]
  Makers makers_;                                            // [control]
  Running* running_ = nullptr;

  std::atomic<bool> look_pending_{false};
  Mutex mutex_;  // guards the members below
  ConditionVariable wake_;
  bool stopping_ MAUVE_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace mauve::daemon
