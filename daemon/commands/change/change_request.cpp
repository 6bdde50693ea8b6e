// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/change/change_request.h"
#include "commands/change/stop.h"
#include "commands/recovery/former.h"
#include "commands/say.h"

#include <algorithm>
#include <iterator>

#include "arch/build/lost_names.h"
#include "commands/answer.h"
#include "commands/lock.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "commands/recovery/quarantine.h"
#include "exec/system/prepared.h"
#include "judge/judgement.h"
#include "mauve/host/architecture.h"
#include "model/element/elements.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

namespace {

/// [factory]
void free_all(Running& running, ChangeRequest& request) {
  clean_up(running, request.retired);
  const std::string at = request.change.edits.empty() ? "" : request.change.edits[0].member;
  static_cast<void>(drop_elements(at, [&request] {
    request.prepared.reset();
    request.change = {};
    request.hooks.reset();
  }));
}

bool starts_something(const Change& change) {
  return std::any_of(change.edits.begin(), change.edits.end(),
                     [](const Edit& edit) { return edit.mode == Mode::run; });
}

Error stopped_meanwhile(const ChangeRequest& request) {
  return refuse({Errc::conflict, "stopped_meanwhile"}, request.change.edits[0].member,
                "was stopped by request after this change was asked for", "start it again");
}

/// Also of a change in place, which parks its component before it is committed.
Status check_made_from(const Running& running, const Change& change) {
  if (!change.made_from || *change.made_from == running.deployer.generation(true)) {
    return ok();
  }
  return refuse({Errc::conflict, "changed_meanwhile"}, running.architecture.name(),
                "changed, for example by a rollback, while this change was prepared",
                "try again; mauvectl history shows what came between");
}

/// "reach/1 (16 bytes)"
std::string state_of(const MemberReceipt& row) {
  return row.dropped + " (" + std::to_string(row.dropped_bytes) +
         (row.dropped_bytes == 1 ? " byte)" : " bytes)");
}

/// [control] A core that is replaced by another object of the same core, and the state that this
/// drops, differ in no line of the architecture. A lock and a role do not judge them.
std::vector<arch::Line> lines_anew(const Running& running, ChangeRequest& request) {
  std::vector<arch::Line> lines;
  const auto& foreseen = request.foreseen.emplace(running.deployer.foresee(**request.prepared));
  for (const auto& edit : request.change.edits) {
    const auto* component = running.architecture.find_component(edit.member);
    if (component == nullptr) {
      continue;
    }
    const std::string core = component->bundle()->core_type.name;
    if (edit.core && edit.core->name != core) {
      continue;
    }
    if (edit.core) {
      lines.push_back(arch::make_line("core", edit.member + ".core", core, core));
    }
    const auto row = std::ranges::find(foreseen.components, edit.member, &MemberReceipt::name);
    if (row != foreseen.components.end() && !row->dropped.empty()) {
      lines.push_back(arch::make_line("state", edit.member + ".core.state", state_of(*row), {}));
    }
  }
  return lines;
}

/// [control] False when the change was dropped before anything happened.
bool may_go_on(Running& running, const Call& call, ChangeRequest& request) {
  if (!*request.prepared) {
    answer(running, call, request.prepared->error());
    return false;
  }
  auto met = check_conditions(running, call);
  met = met ? may_begin(running, request.change) : met;
  met = met ? check_made_from(running, request.change) : met;
  const bool stopped = overtaken_by_stop(running, call, request.change) ||
                       (starts_something(request.change) &&
                        stops_of(running.stops, request.change) != request.stops);
  if (met && stopped) {
    met = stopped_meanwhile(request);
  }
  if (met && request.hooks != nullptr) {
    met = request.hooks->check_prepared(**request.prepared);
  }
  if (met) {
    const auto whole = request.hooks == nullptr ? std::nullopt : request.hooks->lines();
    request.lines = whole ? *whole : lines_of(running, **request.prepared);
    met = may_change(running, call, request.lines);
    request.anew = whole ? request.anew : lines_anew(running, request);
    request.notes = place_notes(running, request.change);
    if (!whole) {  // a file brings its own rules
      std::ranges::move(notes_on_lost_names(running, **request.prepared),
                        std::back_inserter(request.notes));
    }
  }
  if (!met) {
    answer(running, call, met.error());
  }
  return met.has_value();
}

std::vector<std::string> components_of(const Change& change) {
  std::vector<std::string> names;
  for (const auto& edit : change.edits) {
    names.push_back(edit.member);
  }
  return names;
}

}  // namespace

void free_in_factory(Running& running, ChangeRequestPtr request, Ticket ticket) {
  running.control.in_factory(
      [&running, request = std::move(request)] { free_all(running, *request); },
      [ticket = std::move(ticket)] {});
}

void finish(Running& running, const Call& call, const Result<Receipt>& receipt,
            const std::string& state, ChangeRequest& request) {
  ChangeHooks* const hooks = request.hooks.get();
  const bool in_force = receipt || receipt.error().code == Errc::partly;
  if (hooks != nullptr && in_force) {
    hooks->in_force(receipt ? receipt->generation : call.made);
  }
  if (!receipt) {
    return answer(running, call, receipt.error(), state);
  }
  auto result = to_json(*receipt);
  say_who_stands(running, request.change, Asked::in_force, result);
  say_missed(running.deployer.realtime(), result);
  say_consequences(running, request, result);
  answer(running, call, std::move(result));
}

void say_consequences(const Running& running, ChangeRequest& request, Json& result) {
  say_sync(request.prepared, result);
  say_kept(running, request.change, result);
  if (request.change.probation) {
    say_probation(running, *request.change.probation, request.prepared, result);
  }
  if (request.hooks != nullptr) {
    request.hooks->complete(result);
  }
  auto lines = request.lines;
  std::ranges::copy(request.anew, std::back_inserter(lines));
  say_lines(lines, result);
  say_notes(request.notes, result);
}

std::vector<std::string> notes_on_lost_names(const Running& running, PreparedChange& change) {
  const auto& members = change.content().members;
  const auto next = [&members](std::string_view component) -> const CoreBase* {
    const auto member = std::ranges::find_if(members, [&](const exec::PreparedMember& one) {
      return one.component != nullptr && one.component->name() == component;
    });
    return member == members.end() || member->next == nullptr ? nullptr : member->next->core.get();
  };
  std::vector<std::string> notes;
  for (const auto& note :
       arch::names_lost_by(running.supervisor.supervision(), running.architecture, next)) {
    notes.push_back(to_string(note));
  }
  return notes;
}

std::uint64_t stops_of(const std::map<std::string, std::uint64_t>& stops, const Change& change) {
  std::uint64_t sum = 0;
  for (const auto& edit : change.edits) {
    const auto found = stops.find(edit.member);
    sum += found == stops.end() ? 0 : found->second;
  }
  return sum;
}

/// Between the stages of a stop of all, a start would leave half of the machine running.
Status check_being_stopped(const Running& running, const std::vector<std::string>& starts) {
  const auto found = std::ranges::find_if(starts, [&](const auto& name) {
    return running.user_stops != nullptr && running.user_stops->is_under_way(name);
  });
  if (found == starts.end()) {
    return ok();
  }
  return refuse({Errc::conflict, "stopped_meanwhile"}, *found,
                "is being stopped at this moment, so nothing starts it",
                "start it when the stop has been answered");
}

Status may_begin(const Running& running, const Change& change) {
  std::vector<std::string> starts;
  for (const auto& edit : change.edits) {
    if (edit.mode == Mode::run) {
      starts.push_back(edit.member);
    }
  }
  auto allowed = check_being_stopped(running, starts);
  allowed = allowed ? check_lock_of_all(running, change) : allowed;
  allowed = allowed ? check_quarantine(running, change) : allowed;
  return allowed ? check_abandoned_in(running, change) : allowed;
}

void prepare_then(Running& running, const CallPtr& call, ChangeRequestPtr request, Ticket ticket,
                  std::function<Result<PreparedChange>()> prepare, ChangeStep next) {
  running.control.in_factory(
      [request, prepare = std::move(prepare)] { request->prepared = prepare(); },
      [&running, call, request, next, ticket = std::move(ticket)]() mutable {
        const FromLookToAct still(running);
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

}  // namespace mauve::daemon
