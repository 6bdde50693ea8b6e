// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/table.h"

#include <array>
#include <optional>

#include "commands/answer.h"
#include "commands/audit.h"
#include "commands/lock.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "mauve/host/version.h"
#include "monitor/watch.h"
#include "state/state_store.h"

namespace mauve::daemon {

namespace {

using server::Role;

// In the order of protocol::methods().
constexpr Command kCommands[] = {
#define MAUVE_RECORD(...)
#define MAUVE_METHOD(name, handler, ...) Command(handler),
#include "protocol/methods.def"
};

std::string_view group_of(Role role) {
  constexpr std::array<std::string_view, 4> kGroups = {"", "mauve-view", "mauve", "mauve-admin"};
  return kGroups.at(static_cast<std::size_t>(role));
}

Error not_permitted(const protocol::Method& method, const server::Caller& caller) {
  return refuse({Errc::not_permitted, "role_missing"}, std::string(method.name),
                "needs role " + std::string(to_string(method.role)) + ", you have " +
                    std::string(to_string(caller.role)),
                "ask to be added to the group '" + std::string(group_of(method.role)) +
                    "', then log in again");
}

}  // namespace

const Command& command_of(const protocol::Method& method) {
  return kCommands[static_cast<std::size_t>(&method - protocol::methods().data())];
}

Json CommandTable::hello() {
  return {{"server", std::string("mauved ") + kVersion},
          {"protocol", {protocol::kVersion}},
          {"caps", {"events", "oob"}},
          {"generation", running_.generation.load()},
          {"boot", running_.boot}};
}

void CommandTable::dispatch(const server::Caller& caller, const protocol::Method& method,
                            protocol::Request request, server::Reply reply) {
  auto call = call_of(caller, method, std::move(request), counted(method, std::move(reply)));
  // A stop is answered by itself when it is held up: see Stopper.
  if (method.mutation() && !method.out_of_band()) {
    running_.deadlines.watch(call);
  }
  if (caller.role < method.role) {
    return answer(running_, *call, not_permitted(method, caller));
  }
  run(command_of(method), call);
}

server::Reply CommandTable::counted(const protocol::Method& method, server::Reply reply) const {
  return [&counts = running_.counts, &method, reply = std::move(reply)](server::Outcome outcome) {
    const auto* fault = std::get_if<Fault>(&outcome);
    counts.answered(method.name, fault == nullptr ? std::string() : fault->name);
    reply(std::move(outcome));
  };
}

void CommandTable::refused(const server::Caller& caller, const protocol::Method& method,
                           protocol::Request request, const Fault& fault) {
  running_.counts.answered(method.name, fault.name);
  const auto call = call_of(caller, method, std::move(request), {});
  const auto line = audit_refused(running_, *call, fault);
  if (line && running_.store != nullptr) {
    running_.store->audit(*line);
  }
}

CallPtr CommandTable::call_of(const server::Caller& caller, const protocol::Method& method,
                              protocol::Request request, server::Reply reply) const {
  auto call = std::make_shared<Call>();
  call->caller = caller;
  call->method = &method;
  call->params = std::move(request.params);
  call->reply = std::move(reply);
  call->received = std::chrono::steady_clock::now();
  call->before = running_.generation;
  return call;
}

void CommandTable::run(const Command& command, const CallPtr& call) {
  switch (call->method->lane) {
    case Lane::any:
      return answer(running_, *call, command.at_once(running_, *call));
    case Lane::read:
      return running_.control.read([this, &command, call] { look(command, *call); },
                                   asker_of(*call));
    case Lane::later:
      return running_.control.read([this, &command, call] { command.later(running_, call, {}); },
                                   asker_of(*call));
    case Lane::aside:
      return running_.control.read([this, &command, call] { run_aside(command, call); },
                                   asker_of(*call));
    case Lane::urgent:
      if (command.later == stop) {
        watch_over_stop(running_, call);
      }
      return running_.control.urgent([this, &command, call] {
        const FromLookToAct still(running_);
        command.later(running_, call, {});
      });
    case Lane::factory:
      return run_in_factory(command, call);
    case Lane::change:
      return run_as_change(command, call);
  }
}

/// Nobody reads the answer.
bool CommandTable::has_gone(const Call& call) {
  return call.caller.outbox != nullptr && call.caller.outbox->is_shut();
}

void CommandTable::look(const Command& command, const Call& call) {
  if (has_gone(call)) {
    return;
  }
  auto result = [&] {
    const StandStill still(running_);
    return command.at_once(running_, call);
  }();
  answer(running_, call, std::move(result));
}

void CommandTable::run_aside(const Command& command, const CallPtr& call) {
  if (has_gone(*call)) {
    return;
  }
  if (auto room = check_long_answers(running_, *call); !room) {
    return answer(running_, *call, room.error());
  }
  running_.control.write_out(
      [this, &command, call] { answer(running_, *call, command.at_once(running_, *call)); },
      asker_of(*call));
}

void CommandTable::run_as_change(const Command& command, const CallPtr& call) {
  const auto begin = [this, &command, call](Ticket ticket) {
    const FromLookToAct still(running_);
    call->before = running_.generation;
    call->stops = running_.stops;
    auto met = check_conditions(running_, *call);
    if (met && !advance_to(Stage::preparing, *call->stage)) {
      met = deadline_passed(*call);
    }
    // Steps may be stops only, so their handler asks when it knows the change.
    if (met && kind_of(*call) != Kind::steps) {
      met = may_prepare(running_.control.abandoned_threads(), call->caller.peer.uid);
    }
    if (!met) {
      return answer(running_, *call, met.error());
    }
    running_.control.works_for(call->caller.peer.uid);
    command.later(running_, call, std::move(ticket));
  };
  const bool queued = running_.control.change(begin, asker_of(*call));
  if (!queued) {
    answer(running_, *call,
           refuse({Errc::conflict, "too_many_changes"}, std::string(call->method->name),
                  "too many changes wait already", "try again when they are done"));
  }
}

void CommandTable::run_in_factory(const Command& command, const CallPtr& call) {
  if (auto allowed = may_prepare(running_.control.abandoned_threads(), call->caller.peer.uid);
      !allowed) {
    return answer(running_, *call, allowed.error());
  }
  auto result = std::make_shared<std::optional<Result<Json>>>();
  running_.control.in_factory(
      [this, &command, call, result] { *result = command.at_once(running_, *call); },
      [this, call, result] { answer(running_, *call, std::move(**result)); },
      [this, call](const std::string& hook) {
        answer(running_, *call, thread_abandoned(running_, hook, std::string(call->method->name)));
      },
      asker_of(*call));
}

void CommandTable::gone(std::uint64_t client) { running_.watches.forget(client); }

}  // namespace mauve::daemon
