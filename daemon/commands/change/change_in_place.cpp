// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/change/change_in_place.h"

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
    begin_place_probation(running, *call, name, request->before, *probation);
  } else if (in_force) {
    begin_unproven(running, *call, {request->before.failure});
  }
  const bool back = !receipt && running.deployer.status(name).state == ComponentState::running;
  finish(running, *call, receipt, back ? "rolled_back" : "safe", *request);
  free_in_factory(running, std::move(request), std::move(ticket));
}

void resume_in_place(Running& running, const CallPtr& call, ChangeRequestPtr request,
                     Ticket ticket) {
  auto& change = **request->prepared;
  if (stops_of(running.stops, request->change) != request->stops) {
    change.content().members.front().resume = false;  // the component stays stopped
  }
  auto resumed = running.deployer.begin_in_place_resume(change, request->exchanged);
  if (!resumed) {
    return end_in_place(running, call, request, std::move(ticket), resumed.error());
  }
  when_answered(running, *std::move(resumed),
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
  if (request->change.probation) {
    exec::note_one_way(member.component->name(), *member.next->core, *member.base->core,
                       member.state, request->notes);
  }
  auto parking = running.deployer.begin_in_place_park(**request->prepared);
  when_answered(running, std::move(parking),
                [&running, call, request, ticket = std::move(ticket)](Ongoing& done) mutable {
                  if (const auto parked = done.result(); !parked) {
                    answer(running, *call, parked.error(), state_after(parked.error()));
                    return free_in_factory(running, std::move(request), std::move(ticket));
                  }
                  exchange_when_parked(running, call, std::move(request), std::move(ticket));
                });
}

}  // namespace

void apply_in_place(Running& running, const CallPtr& call, Ticket ticket, Edit edit,
                    std::shared_ptr<ChangeHooks> hooks) {
  const auto probation = probation_of(call->params);
  if (!probation) {
    return answer(running, *call, probation.error());
  }
  auto request = std::make_shared<ChangeRequest>();
  request->hooks = std::move(hooks);
  request->change.edits.push_back(std::move(edit));
  request->change.probation = *probation;
  if (auto allowed = may_begin(running, request->change); !allowed) {
    return answer(running, *call, allowed.error());
  }
  request->stops = stops_of(call->stops ? *call->stops : running.stops, request->change);
  auto& only = request->change.edits[0];
  prepare_then(
      running, call, std::move(request), std::move(ticket),
      [&running, &only] { return running.deployer.prepare_in_place(only); }, park_in_place);
}

}  // namespace mauve::daemon
