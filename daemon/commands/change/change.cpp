// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/change/change.h"

#include <algorithm>
#include <optional>

#include "commands/answer.h"
#include "commands/lock.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "commands/recovery/quarantine.h"
#include "commands/recovery/unproven.h"
#include "exec/system/prepared.h"
#include "judge/judgement.h"
#include "mauve/host/architecture.h"
#include "model/element/elements.h"

namespace mauve::daemon {

namespace {

/// Everything one change needs on its way between the threads. It is created on [control] and goes
/// away on [factory], since freeing elements runs user code.
struct ChangeRequest {
  Change change;
  std::uint64_t stops = 0;  ///< of its components, when it began
  std::optional<Result<PreparedChange>> prepared;
  std::optional<Retired> retired{std::in_place};
  std::shared_ptr<ChangeHooks> hooks;  ///< may be null
  Status exchanged;
  std::vector<arch::Line> lines;  ///< the differences that it makes, once it is prepared
  std::vector<std::string> notes;
  CoreBefore before;  ///< of a swap in place
};
using ChangeRequestPtr = std::shared_ptr<ChangeRequest>;

/// [factory]
Status free_all(ChangeRequest& request) {
  auto cleaned = request.retired->release();
  const std::string at = request.change.edits.empty() ? "" : request.change.edits[0].component;
  static_cast<void>(drop_elements(at, [&request] {
    request.prepared.reset();
    request.change = {};
    request.hooks.reset();
  }));
  return cleaned;
}

/// [control] Nothing of the request is touched on this thread afterwards.
void free_in_factory(Running& running, ChangeRequestPtr request, Ticket ticket) {
  running.control.in_factory(
      [&running, request = std::move(request)] {
        const auto cleaned = free_all(*request);
        if (!cleaned) {
          running.log.write(logging::Event::clean_up_failed,
                            {{"component", cleaned.error().at}, {"text", cleaned.error().message}});
        }
      },
      [ticket = std::move(ticket)] {});
}

void finish(Running& running, const Call& call, const Result<Receipt>& receipt,
            const std::string& state, ChangeRequest& request) {
  ChangeHooks* const hooks = request.hooks.get();
  const bool in_force = receipt || receipt.error().code == Errc::partly;
  if (hooks != nullptr && in_force) {
    hooks->in_force(receipt ? receipt->generation : running.generation.load());
  }
  if (!receipt) {
    return answer(running, call, receipt.error(), state);
  }
  auto result = to_json(*receipt);
  say_sync(request.prepared, result);
  say_who_stands(running, request.change, result);
  say_kept(running, request.change, result);
  if (request.change.probation) {
    result["probation"] = to_json(*request.change.probation);
  }
  if (hooks != nullptr) {
    hooks->complete(result);
  }
  say_lines(request.lines, result);
  say_notes(request.notes, result);
  answer(running, call, std::move(result));
}

/// A start or a stop brings nothing that could be tried out, and a way back from a start would only
/// stop the component again. That holds for a start with a fresh core of the same type too.
bool changes_modes_only(const Running& running, const Change& change) {
  return !change.changes_rules && change.new_components.empty() && change.new_resources.empty() &&
         change.remove.empty() &&
         std::all_of(change.edits.begin(), change.edits.end(), [&](const Edit& one) {
           const auto* component = running.architecture.find_component(one.component);
           const bool other_core =
               one.core &&
               (component == nullptr || component->bundle()->core_type.name != one.core->name);
           return one.mode != Mode::keep && !other_core;
         });
}

using Stops = std::map<std::string, std::uint64_t>;

std::uint64_t stops_of(const Stops& stops, const Change& change) {
  std::uint64_t sum = 0;
  for (const auto& edit : change.edits) {
    const auto found = stops.find(edit.component);
    sum += found == stops.end() ? 0 : found->second;
  }
  return sum;
}

bool starts_something(const Change& change) {
  return std::any_of(change.edits.begin(), change.edits.end(),
                     [](const Edit& edit) { return edit.mode == Mode::run; });
}

Error stopped_meanwhile(const ChangeRequest& request) {
  return refuse(Errc::conflict, request.change.edits[0].component,
                "was stopped by request after this change was asked for", "start it again");
}

/// [control] Asked before anything is made, and again when it is prepared.
Status may_begin(const Running& running, const Change& change) {
  auto free = may_change(running, change);
  free = free ? check_quarantine(running, change) : free;
  return free ? check_abandoned_in(running, change) : free;
}

/// [control] False when the change was dropped before anything happened.
bool may_go_on(Running& running, const Call& call, ChangeRequest& request) {
  if (!*request.prepared) {
    answer(running, call, request.prepared->error());
    return false;
  }
  auto met = check_conditions(running, call);
  met = met ? may_begin(running, request.change) : met;
  const bool stopped = overtaken_by_stop(running, call, request.change) ||
                       (starts_something(request.change) &&
                        stops_of(running.stops, request.change) != request.stops);
  if (met && stopped) {
    met = stopped_meanwhile(request);
  }
  if (met && request.hooks != nullptr) {
    met = request.hooks->ready();
  }
  if (met) {
    const auto whole = request.hooks == nullptr ? std::nullopt : request.hooks->lines();
    request.lines = whole ? *whole : lines_of(running, **request.prepared);
    met = may_change(running, call, request.lines);
    request.notes = place_notes(running, request.change);
  }
  if (!met) {
    answer(running, call, met.error());
  }
  return met.has_value();
}

/// Nothing but values, attributes of tasks and connections, each of which is in force already.
bool is_so_already(const ChangeRequest& request) {
  const auto& change = request.change;
  const bool elements = !change.new_components.empty() || !change.new_resources.empty() ||
                        !change.remove.empty() || request.hooks != nullptr;
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

/// [control] Commits, answers, and lets [factory] free what it replaced.
void put_in_force(Running& running, const CallPtr& call, ChangeRequestPtr request, Ticket ticket) {
  if (is_so_already(*request)) {
    answer_so_already(running, *call);
    return free_in_factory(running, std::move(request), std::move(ticket));
  }
  if (request->change.probation) {
    remember_lines(running, request->lines);
  }
  auto ongoing = running.deployer.begin(**request->prepared);
  when_answered(running, std::move(ongoing),
                [&running, call, request, ticket = std::move(ticket)](Ongoing& done) mutable {
                  const auto receipt = done.result();
                  request->retired = std::move(done.retired());
                  finish(running, *call, receipt, receipt ? "" : state_after(receipt.error()),
                         *request);
                  free_in_factory(running, std::move(request), std::move(ticket));
                });
}

/// [control] Ends a dry run: the answer tells the prepared change, and [factory] frees it.
void tell(Running& running, const CallPtr& call, ChangeRequestPtr request, Ticket ticket) {
  auto result = to_json(running.deployer.foresee(**request->prepared));
  result["dry_run"] = true;
  say_sync(request->prepared, result);
  say_kept(running, request->change, result);
  if (request->hooks != nullptr) {
    request->hooks->complete(result);
  }
  say_lines(request->lines, result);
  say_notes(request->notes, result);
  result.emplace("lines", Json::array());
  answer(running, *call, std::move(result));
  free_in_factory(running, std::move(request), std::move(ticket));
}

// --- in place: park, exchange on [factory], resume ----------------------------------------------

void end_in_place(Running& running, const CallPtr& call, ChangeRequestPtr request, Ticket ticket,
                  const Result<Receipt>& receipt) {
  const auto& name = request->change.edits[0].component;
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
      [&running, call, name = request->change.edits[0].component](const std::string& hook) {
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
  const auto& name = request->change.edits[0].component;
  request->before.failure = mark_failure(running, name);
  request->before.ran = (**request->prepared).content().members.front().resume;
  if (running.architecture.find_component(name)->bundle() == request->before.bundle) {
    return exchange_in_place(running, call, std::move(request), std::move(ticket));
  }
  request->exchanged =
      refuse(Errc::conflict, name, "its core failed, and another one took over meanwhile",
             "mauvectl why " + name + ", then swap again");
  resume_in_place(running, call, std::move(request), std::move(ticket));
}

void park_in_place(Running& running, const CallPtr& call, ChangeRequestPtr request, Ticket ticket) {
  request->before.bundle = (**request->prepared).content().members.front().base;
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

using ChangeStep = void (*)(Running&, const CallPtr&, ChangeRequestPtr, Ticket);

std::vector<std::string> components_of(const Change& change) {
  std::vector<std::string> names;
  for (const auto& edit : change.edits) {
    names.push_back(edit.component);
  }
  return names;
}

/// Prepares on [factory]; goes on with `next` unless there is a reason not to.
void prepare_then(Running& running, const CallPtr& call, ChangeRequestPtr request, Ticket ticket,
                  std::function<Result<PreparedChange>()> prepare, ChangeStep next) {
  running.control.in_factory(
      [request, prepare = std::move(prepare)] { request->prepared = prepare(); },
      [&running, call, request, next, ticket = std::move(ticket)]() mutable {
        if (!may_go_on(running, *call, *request)) {
          return free_in_factory(running, std::move(request), std::move(ticket));
        }
        next(running, call, std::move(request), std::move(ticket));
      },
      [&running, call, names = components_of(request->change)](const std::string& hook) {
        note_abandoned_in(running, names, hook, false);
        call->keeps_a_thread = true;
        answer(running, *call, thread_abandoned(running, hook, std::string(call->method->name)));
      });
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
  if (auto free = may_begin(running, change); !free) {
    return answer(running, *call, free.error());
  }
  auto probation = probation_of(call->params);
  if (!probation) {
    return answer(running, *call, probation.error());
  }
  if (!changes_modes_only(running, change)) {
    change.probation = *probation;
    call->mark = *probation ? Confirmation::unconfirmed : Confirmation::confirmed;
  }
  auto request = std::make_shared<ChangeRequest>();
  request->change = std::move(change);
  const bool dry_run = flag(call->params, "dry_run") || (hooks != nullptr && hooks->dry_run());
  request->hooks = std::move(hooks);
  request->stops = stops_of(call->stops ? *call->stops : running.stops, request->change);
  auto& edits = request->change;
  prepare_then(
      running, call, std::move(request), std::move(ticket),
      [&running, &edits] { return running.deployer.prepare(edits); },
      dry_run ? tell : put_in_force);
}

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
  if (auto free = may_begin(running, request->change); !free) {
    return answer(running, *call, free.error());
  }
  request->stops = stops_of(call->stops ? *call->stops : running.stops, request->change);
  auto& only = request->change.edits[0];
  prepare_then(
      running, call, std::move(request), std::move(ticket),
      [&running, &only] { return running.deployer.prepare_in_place(only); }, park_in_place);
}

Edit edit_of(std::string_view component) {
  Edit edit;
  edit.component = component;
  return edit;
}

}  // namespace mauve::daemon
