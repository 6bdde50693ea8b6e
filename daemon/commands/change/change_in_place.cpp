// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/change/change_in_place.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "commands/answer.h"
#include "commands/change/change_request.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "commands/recovery/unproven.h"
#include "exec/system/books.h"
#include "exec/system/prepared.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

namespace {

void end_in_place(Running& running, const CallPtr& call, ChangeRequestPtr request, Ticket ticket,
                  const Result<Receipt>& receipt) {
  const auto& name = request->change.edits[0].member;
  const auto& probation = request->change.probation;
  const bool in_force = receipt || receipt.error().code == Errc::partly;
  if (in_force && probation) {
    const auto made = receipt ? receipt->generation : call->made;
    begin_place_probation(running, *call, made, name, request->before, *probation);
  } else if (in_force) {
    begin_unproven(running, *call, {request->before.failure});
  }
  const bool back = !receipt && running.deployer.status(name).state == ComponentState::running;
  finish(running, *call, receipt, back ? "rolled_back" : "safe", *request);
  free_in_factory(running, std::move(request), std::move(ticket));
}

void resume_in_place(Running& running, const CallPtr& call, ChangeRequestPtr request,
                     Ticket ticket) {
  const FromLookToAct still(running);
  auto& change = **request->prepared;
  if (stops_of(running.stops, request->change) != request->stops) {
    change.content().members.front().resume = false;  // the component stays stopped
  }
  auto resumed = running.deployer.begin_in_place_resume(change, request->exchanged);
  if (!resumed) {
    return end_in_place(running, call, request, std::move(ticket), resumed.error());
  }
  when_answered(running, call, *std::move(resumed),
                [&running, call, request, ticket = std::move(ticket)](Ongoing& done) mutable {
                  auto receipt = done.result();
                  request->retired = std::move(done.retired());
                  if (!request->exchanged) {
                    receipt = request->exchanged.error();
                  }
                  end_in_place(running, call, request, std::move(ticket), receipt);
                });
}

void exchange_in_place(Running& running, const CallPtr& call, ChangeRequestPtr request,
                       Ticket ticket) {
  running.control.in_factory(
      [&running, request] {
        request->exchanged = running.deployer.in_place_exchange(**request->prepared);
      },
      [&running, call, request, ticket = std::move(ticket)]() mutable {
        resume_in_place(running, call, std::move(request), std::move(ticket));
      },
      [&running, call, name = request->change.edits[0].member](const std::string& hook) {
        note_abandoned_in(running, {name}, hook, true);
        answer(running, *call,
               thread_abandoned(running, hook, name,
                                name + " is stopped with its safe values written"),
               "safe");
      });
}

/// The policy of the component may have given it another core before it was parked.
void exchange_when_parked(Running& running, const CallPtr& call, ChangeRequestPtr request,
                          Ticket ticket) {
  const auto& name = request->change.edits[0].member;
  request->before.failure = mark_failure(running, name);
  request->before.ran = (**request->prepared).content().members.front().resume;
  if (running.architecture.find_component(name)->bundle() == request->before.bundle) {
    return exchange_in_place(running, call, std::move(request), std::move(ticket));
  }
  request->exchanged = refuse({Errc::conflict, "failed_meanwhile"}, name,
                              "its core failed, and another one took over meanwhile",
                              "mauvectl why " + name + ", then swap again");
  resume_in_place(running, call, std::move(request), std::move(ticket));
}

void park_in_place(Running& running, const CallPtr& call, ChangeRequestPtr request, Ticket ticket) {
  const auto& member = (**request->prepared).content().members.front();
  request->before.bundle = member.base;
  if (member.type) {
    request->before.type = member.component->type();
  }
  if (request->change.probation) {
    exec::note_one_way(member.component->name(), *member.next->core, *member.base->core,
                       member.state, request->notes);
  }
  auto parking = running.deployer.begin_in_place_park(**request->prepared);
  when_answered(running, call, std::move(parking),
                [&running, call, request, ticket = std::move(ticket)](Ongoing& done) mutable {
                  if (const auto parked = done.result(); !parked) {
                    answer(running, *call, parked.error(), state_after(parked.error()));
                    return free_in_factory(running, std::move(request), std::move(ticket));
                  }
                  exchange_when_parked(running, call, std::move(request), std::move(ticket));
                });
}

/// The core of exactly one component is made anew. A core that stays would be cleaned up in use.
bool makes_one_core_anew(const Running& running, const Change& change) {
  if (change.edits.size() != 1 || !change.fallbacks.empty()) {
    return false;
  }
  const auto& edit = change.edits.front();
  const auto sets = [&edit](std::string_view part) {
    return std::ranges::any_of(edit.properties,
                               [&](const auto& one) { return one.first.starts_with(part); });
  };
  return running.architecture.find_component(edit.member) != nullptr &&
         (edit.core || edit.type || sets("core.") || sets("shell."));
}

/// The old core releases its devices before the new one begins, so a dry run has nothing to prepare
/// and drop. The rollback takes as long as the change, so a late job does not trigger it.
Status may_be_in_place(const Running& running, const Json& params, const Change& change) {
  if (flag(params, "dry_run")) {
    return refuse(
        {Errc::unsupported, "in_place_not_foreseen"}, "dry_run",
        "a change in place prepares the new core only when the old one has let go, so there "
        "is nothing to foresee",
        "leave out --in-place to see what a change beside the old core would do");
  }
  if (params.contains("misses")) {
    return refuse({Errc::invalid_value, "in_place_without_misses"}, "misses",
                  "the rollback from a change in place stops the component as long as the change "
                  "did, so only a failure rolls back, not late jobs",
                  "leave out --misses, or --in-place");
  }
  if (!makes_one_core_anew(running, change)) {
    return refuse({Errc::unsupported, "in_place_of_one_core"}, "in_place",
                  "a change in place makes the core of one component anew, and this change is of "
                  "more, or of something else",
                  "leave out --in-place, or change one core with each command");
  }
  return ok();
}

}  // namespace

void apply_in_place(Running& running, const CallPtr& call, Ticket ticket, Change change,
                    std::shared_ptr<ChangeHooks> hooks, PrepareInPlace prepare) {
  const auto probation = probation_of(call->params);
  if (!probation) {
    return answer(running, *call, probation.error());
  }
  if (const auto sound = may_be_in_place(running, call->params, change); !sound) {
    return answer(running, *call, sound.error());
  }
  auto request = std::make_shared<ChangeRequest>();
  request->hooks = std::move(hooks);
  request->change = std::move(change);
  request->change.probation = *probation;
  if (auto allowed = may_begin(running, request->change); !allowed) {
    return answer(running, *call, allowed.error());
  }
  request->stops = stops_of(call->stops ? *call->stops : running.stops, request->change);
  auto& wanted = request->change;
  prepare_then(
      running, call, std::move(request), std::move(ticket),
      [&running, &wanted, prepare = std::move(prepare)] {
        return prepare ? prepare(wanted)
                       : running.deployer.prepare_in_place(wanted.edits.front(), wanted.made_from);
      },
      park_in_place);
}

void apply_as_asked(Running& running, const CallPtr& call, Ticket ticket, Change change,
                    std::shared_ptr<ChangeHooks> hooks) {
  if (flag(call->params, "in_place")) {
    return apply_in_place(running, call, std::move(ticket), std::move(change), std::move(hooks));
  }
  apply(running, call, std::move(ticket), std::move(change), std::move(hooks));
}

}  // namespace mauve::daemon
