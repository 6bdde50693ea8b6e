// SPDX-License-Identifier: LGPL-3.0-or-later
/// The way of a change: it is prepared on [factory] and committed on [control]; [factory] frees the
/// replaced elements. The answer goes out when the change is in force and, where generations are
/// kept, saved. Reloads, stops and rollbacks have ways of their own.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arch/compare/change_lines.h"
#include "commands/command.h"

namespace mauve::daemon {

/// The part of a change that its command adds, for example new rules. Destroyed on [factory], after
/// the elements of the change.
class ChangeHooks {
 public:
  ChangeHooks() = default;
  ChangeHooks(const ChangeHooks&) = delete;
  ChangeHooks& operator=(const ChangeHooks&) = delete;
  virtual ~ChangeHooks() = default;

  /// [control] Called when all is prepared; an error refuses the change.
  virtual Status check_prepared(PreparedChange& change) = 0;
  /// [control] The change is in force, or partly, and made this generation. A rollback of it comes
  /// later.
  virtual void in_force(std::uint64_t generation) = 0;
  /// [control] Adds to the answer.
  virtual void complete(Json& result) = 0;
  /// [control] All differences that the change makes; none: arch::lines_of() finds them in it.
  [[nodiscard]] virtual std::optional<std::vector<arch::Line>> lines() const { return {}; }
  /// The change is prepared, shown and dropped.
  [[nodiscard]] virtual bool dry_run() const { return false; }
};

/// [control] Takes over the call and the ticket: answers with the receipt or the refusal.
void apply(Running& running, const CallPtr& call, Ticket ticket, Change change,
           std::shared_ptr<ChangeHooks> hooks = nullptr);

/// [control] Runs `then` on [control] when there is an answer; others are served meanwhile.
void when_answered(Running& running, std::shared_ptr<Ongoing> ongoing,
                   std::function<void(Ongoing&)> then);
/// [control] The call has asked for it: see Call::made.
void when_answered(Running& running, const CallPtr& call, std::shared_ptr<Ongoing> ongoing,
                   std::function<void(Ongoing&)> then);

/// The state of the running system after a change that ended with this error: "partly" or
/// "unchanged".
[[nodiscard]] std::string state_after(const Error& error);

/// [control] The differences that a prepared change makes.
[[nodiscard]] std::vector<arch::Line> lines_of(const Running& running, PreparedChange& change);

/// [control] A structure may be given partly: which of its fields kept their values, as `kept`.
void say_kept(const Running& running, const Change& change, Json& result);

/// An edit that names this component or resource, and changes nothing yet.
[[nodiscard]] Edit edit_of(std::string_view member);

/// The reason of a requested rollback begins with this.
inline constexpr std::string_view kUndone = "undone";

/// [any] `probation` (a number of jobs, or "off"), `misses` and `confirm_within`; the default where
/// one is not given.
[[nodiscard]] Result<std::optional<Probation>> probation_of(const Json& params);
[[nodiscard]] Json to_json(const Probation& probation);

/// [any] Refuses these options in a change that cannot be on probation: what a user asks to confirm
/// is never taken as confirmed. `why`, `step`: for the refusal.
[[nodiscard]] Status ask_for_no_probation(const Json& params, const std::string& why,
                                          const std::string& step);

}  // namespace mauve::daemon
