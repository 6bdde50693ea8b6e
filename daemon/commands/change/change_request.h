// SPDX-License-Identifier: LGPL-3.0-or-later
/// The steps that changes share: preparation on [factory], the checks before and after it, the
/// answer, and the release of the elements.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands/change/change.h"

#include "commands/recovery/place_probation.h"

namespace mauve::daemon {

/// Everything one change needs on its way between the threads. It is created on [control] and goes
/// away on [factory], since freeing elements runs user code.
struct ChangeRequest {
  Change change;
  std::uint64_t stops = 0;  ///< of its components, when it began
  std::optional<Result<PreparedChange>> prepared;
  Retired retired;                     ///< the replaced elements; [factory] frees them
  std::shared_ptr<ChangeHooks> hooks;  ///< may be null
  Status exchanged;                    ///< of a swap in place: whether it has exchanged the cores
  std::vector<arch::Line> lines;       ///< the differences that it makes, once it is prepared
  std::vector<arch::Line> anew;        ///< cores that it makes anew, and the states that it drops
  std::optional<Receipt> foreseen;     ///< its consequences, where `anew` was made from them
  std::vector<std::string> notes;
  CoreBefore before;  ///< of a swap in place
};
using ChangeRequestPtr = std::shared_ptr<ChangeRequest>;

/// [control] Lets [factory] free the request, then ends the ticket.
void free_in_factory(Running& running, ChangeRequestPtr request, Ticket ticket);

/// [control] Answers the call: with the receipt, or with the refusal and the state after it.
void finish(Running& running, const Call& call, const Result<Receipt>& receipt,
            const std::string& state, ChangeRequest& request);

/// [control] Adds all parts of the answer that a dry run has too.
void say_consequences(const Running& running, ChangeRequest& request, Json& result);

/// [control] Sentences on the rules and transactions that name a property or an observable which
/// the new cores do not have.
[[nodiscard]] std::vector<std::string> notes_on_lost_names(const Running& running,
                                                           PreparedChange& change);

/// How often the components of the change were stopped so far, in all.
[[nodiscard]] std::uint64_t stops_of(const std::map<std::string, std::uint64_t>& stops,
                                     const Change& change);

/// [control] Refused while a stop of one of these is under way.
[[nodiscard]] Status check_being_stopped(const Running& running,
                                         const std::vector<std::string>& starts);

/// [control] The reasons to refuse a change that need no preparation. They are asked before
/// anything is made, and again when the change is prepared.
[[nodiscard]] Status may_begin(const Running& running, const Change& change);

using ChangeStep = void (*)(Running&, const CallPtr&, ChangeRequestPtr, Ticket);

/// [control] Prepares on [factory]; goes on with `next` unless there is a reason not to.
void prepare_then(Running& running, const CallPtr& call, ChangeRequestPtr request, Ticket ticket,
                  std::function<Result<PreparedChange>()> prepare, ChangeStep next);

}  // namespace mauve::daemon
