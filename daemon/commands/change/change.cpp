// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/change/change.h"
#include "commands/change/stop.h"
#include "commands/say.h"

#include <algorithm>
#include <optional>

#include "commands/answer.h"
#include "commands/audit.h"
#include "commands/change/change_request.h"
#include "commands/lock.h"
#include "commands/model.h"
#include "exec/system/prepared.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

namespace {

/// Nothing but values, attributes of tasks and connections, each of which is in force already.
bool is_so_already(const ChangeRequest& request) {
  const auto& change = request.change;
  const bool elements = !change.new_components.empty() || !change.new_resources.empty() ||
                        !change.remove.empty() || !change.stops.empty() || request.hooks != nullptr;
  return !elements && request.lines.empty() &&
         std::ranges::all_of(change.edits, [](const Edit& edit) {
           return edit.state != StatePolicy::drop && !edit.core && !edit.fsm && !edit.type &&
                  !edit.resource && edit.mode == Mode::keep;
         });
}

void answer_so_already(Running& running, const Call& call) {
  Receipt nothing;
  nothing.generation = running.generation;
  answer(running, call, to_json(nothing));
}

/// [control] Commits, answers, and lets [factory] free the replaced elements.
void put_in_force(Running& running, const CallPtr& call, ChangeRequestPtr request, Ticket ticket) {
  if (is_so_already(*request)) {
    answer_so_already(running, *call);
    return free_in_factory(running, std::move(request), std::move(ticket));
  }
  auto ongoing = running.deployer.begin(**request->prepared);
  if (request->change.probation) {
    expect_lines(running, ongoing, request->lines);
  }
  when_answered(running, call, std::move(ongoing),
                [&running, call, request, ticket = std::move(ticket)](Ongoing& done) mutable {
                  const auto receipt = done.result();
                  request->retired = std::move(done.retired());
                  if (request->change.probation) {
                    remember_lines(running, call->made, request->lines);
                  }
                  finish(running, *call, receipt, receipt ? "" : state_after(receipt.error()),
                         *request);
                  free_in_factory(running, std::move(request), std::move(ticket));
                });
}

/// [control] Ends a dry run: the answer shows the prepared change, and [factory] frees it.
void answer_dry_run(Running& running, const CallPtr& call, ChangeRequestPtr request,
                    Ticket ticket) {
  const bool so_already = is_so_already(*request);
  Receipt nothing;
  nothing.generation = running.generation;
  if (!request->foreseen) {
    request->foreseen = running.deployer.foresee(**request->prepared);
  }
  auto result = to_json(so_already ? nothing : *request->foreseen);
  result["dry_run"] = true;
  if (!so_already) {
    say_who_stands(running, request->change, Asked::dry_run, result);
    say_consequences(running, *request, result);
  }
  result.emplace("lines", Json::array());
  answer(running, *call, std::move(result));
  free_in_factory(running, std::move(request), std::move(ticket));
}

}  // namespace

void when_answered(Running& running, std::shared_ptr<Ongoing> ongoing,
                   std::function<void(Ongoing&)> then) {
  running.control.await([ongoing] { return ongoing->advance(); },
                        [&running, ongoing, then = std::move(then)] {
                          running.report_outcomes();
                          const StandStill still(running);
                          running.generation = running.deployer.generation();
                          then(*ongoing);
                        });
}

void when_answered(Running& running, const CallPtr& call, std::shared_ptr<Ongoing> ongoing,
                   std::function<void(Ongoing&)> then) {
  when_answered(running, std::move(ongoing), [call, then = std::move(then)](Ongoing& done) {
    call->made = done.made();
    if (call->made != 0 && call->on_made) {
      call->on_made(call->made);
    }
    then(done);
  });
}

std::vector<arch::Line> lines_of(const Running& running, PreparedChange& change) {
  const StandStill still(running);
  return arch::lines_of(change.content(), [&running](const ComponentBase& component) {
    return running.deployer.status(component.name()).state == ComponentState::running;
  });
}

std::string state_after(const Error& error) {
  return error.code == Errc::partly ? "partly" : "unchanged";
}

void apply(Running& running, const CallPtr& call, Ticket ticket, Change change,
           std::shared_ptr<ChangeHooks> hooks) {
  if (auto allowed = may_begin(running, change); !allowed) {
    return answer(running, *call, allowed.error());
  }
  auto probation = probation_of(call->params);
  if (!probation) {
    return answer(running, *call, probation.error());
  }
  if (*probation && by_itself(*call)) (*probation)->only_undo = true;
  if (!only_starts_and_stops(running, change)) {
    change.probation = *probation;
    call->mark = *probation ? Confirmation::unconfirmed : Confirmation::confirmed;
  } else if (auto unasked = ask_for_no_probation(
                 only_stops(change) ? Json::object() : call->params,
                 "the change only starts components, and no probation takes a start back, so there "
                 "is nothing to try out or to confirm",
                 "mauvectl stop ends what a start began");
             !unasked) {
    return answer(running, *call, unasked.error());
  }
  const bool dry_run = flag(call->params, "dry_run") || (hooks != nullptr && hooks->dry_run());
  if (only_stops(change) && !dry_run && (hooks == nullptr || by_itself(*call))) {
    return stop_only(running, call, std::move(ticket), change, std::move(hooks));
  }
  auto request = std::make_shared<ChangeRequest>();
  request->change = std::move(change);
  request->hooks = std::move(hooks);
  request->stops = stops_of(call->stops ? *call->stops : running.stops, request->change);
  auto& wanted = request->change;
  prepare_then(
      running, call, std::move(request), std::move(ticket),
      [&running, &wanted] { return running.deployer.prepare(wanted); },
      dry_run ? answer_dry_run : put_in_force);
}

Status ask_for_no_probation(const Json& params, const std::string& why, const std::string& step) {
  for (const char* option : {"probation", "misses", "confirm_within"}) {
    if (params.contains(option) && text_or(params, option) != "off") {
      return refuse({Errc::invalid_value, "nothing_to_try"}, option, why,
                    "leave out " + std::string(option) + "; " + step);
    }
  }
  return ok();
}

Edit edit_of(std::string_view member) {
  Edit edit;
  edit.member = member;
  return edit;
}

}  // namespace mauve::daemon
