// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/table.h"

#include <algorithm>
#include <array>
#include <optional>

#include "commands/answer.h"
#include "commands/audit.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "mauve/host/version.h"
#include "monitor/watch.h"
#include "state/state_store.h"

namespace mauve::daemon {

namespace {

using server::Role;

constexpr Command kCommands[] = {
    {"ping", Role::viewer, Lane::any, ping, nullptr},
    {"version", Role::viewer, Lane::any, version, nullptr},
    {"command.list", Role::viewer, Lane::any, list_commands, nullptr},
    {"client.list", Role::viewer, Lane::any, list_clients, nullptr},
    {"status.get", Role::viewer, Lane::read, status, nullptr},
    {"component.list", Role::viewer, Lane::read, list_components, nullptr},
    {"resource.list", Role::viewer, Lane::read, list_resources, nullptr},
    {"service.list", Role::viewer, Lane::read, list_services, nullptr},
    {"core.list", Role::viewer, Lane::read, list_cores, nullptr},
    {"fsm.list", Role::viewer, Lane::read, list_fsms, nullptr},
    {"type.list", Role::viewer, Lane::read, list_types, nullptr},
    {"port.list", Role::viewer, Lane::read, list_ports, nullptr},
    {"plugin.list", Role::viewer, Lane::read, list_plugins, nullptr},
    {"system.analyze", Role::viewer, Lane::read, analyze, nullptr},
    {"stats.get", Role::viewer, Lane::read, statistics, nullptr},
    {"metrics.get", Role::viewer, Lane::read, metrics, nullptr},
    {"stats.reset", Role::operator_, Lane::urgent, nullptr, reset_statistics},
    {"rules.list", Role::viewer, Lane::read, list_rules, nullptr},
    {"object.get", Role::viewer, Lane::read, show, nullptr},
    {"component.why", Role::viewer, Lane::read, why, nullptr},
    {"param.get", Role::viewer, Lane::read, get, nullptr},
    {"condition.get", Role::viewer, Lane::read, condition, nullptr},
    {"config.get", Role::viewer, Lane::read, export_architecture, nullptr},
    {"config.check", Role::viewer, Lane::read, nullptr, check_architecture},
    {"architecture.graph", Role::viewer, Lane::read, graph, nullptr},
    {"architecture.diff", Role::viewer, Lane::read, nullptr, diff_architecture},
    {"config.history", Role::viewer, Lane::any, history, nullptr},
    {"config.compare", Role::viewer, Lane::read, nullptr, compare_generations},
    {"daemon.doctor", Role::viewer, Lane::factory, doctor, nullptr},
    {"watch.subscribe", Role::viewer, Lane::read, watch, nullptr},
    {"watch.unsubscribe", Role::viewer, Lane::read, unwatch, nullptr},
    {"log.tail", Role::viewer, Lane::read, nullptr, tail_log},
    {"log.level", Role::viewer, Lane::read, show_log_level, nullptr},
    {"log.set_level", Role::operator_, Lane::urgent, nullptr, set_log_level},
    {"trace.status", Role::viewer, Lane::read, trace_status, nullptr},
    {"trace.list", Role::viewer, Lane::read, list_recordings, nullptr},
    {"trace.read", Role::viewer, Lane::read, nullptr, read_trace},
    {"trace.start", Role::operator_, Lane::read, start_trace, nullptr},
    {"trace.stop", Role::operator_, Lane::read, stop_trace, nullptr},
    {"component.stop", Role::operator_, Lane::urgent, nullptr, stop},
    {"param.set", Role::operator_, Lane::change, nullptr, set},
    {"component.start", Role::operator_, Lane::change, nullptr, start},
    {"core.swap", Role::operator_, Lane::change, nullptr, swap_core},
    {"port.connect", Role::operator_, Lane::change, nullptr, connect},
    {"port.disconnect", Role::operator_, Lane::change, nullptr, disconnect},
    {"change.apply", Role::operator_, Lane::change, nullptr, change_steps},
    {"service.call", Role::operator_, Lane::change, nullptr, call_service},
    {"change.confirm", Role::operator_, Lane::urgent, nullptr, confirm},
    {"change.undo", Role::operator_, Lane::urgent, nullptr, undo},
    {"quarantine.list", Role::viewer, Lane::read, list_quarantine, nullptr},
    {"quarantine.release", Role::admin, Lane::urgent, nullptr, release_quarantine},
    {"architecture.apply", Role::admin, Lane::change, nullptr, apply_file},
    {"plugin.load", Role::admin, Lane::change, nullptr, load_plugin},
    {"plugin.unload", Role::admin, Lane::change, nullptr, unload_plugin},
    {"plugin.reload", Role::admin, Lane::change, nullptr, reload_plugin},
    {"config.rollback", Role::admin, Lane::change, nullptr, rollback},
    {"lock.set", Role::admin, Lane::urgent, nullptr, set_lock},
};

std::string_view group_of(Role role) {
  constexpr std::array<std::string_view, 4> kGroups = {"", "mauve-view", "mauve", "mauve-admin"};
  return kGroups.at(static_cast<std::size_t>(role));
}

Error not_permitted(const Command& command, const server::Caller& caller) {
  return refuse(Errc::not_permitted, std::string(command.method),
                "needs role " + std::string(to_string(command.role)) + ", you have " +
                    std::string(to_string(caller.role)),
                "join the group " + std::string(group_of(command.role)) + ", then log in again");
}

}  // namespace

std::span<const Command> commands() { return kCommands; }

const Command* find_command(std::string_view method) {
  const auto it = std::find_if(std::begin(kCommands), std::end(kCommands),
                               [&](const Command& row) { return row.method == method; });
  return it == std::end(kCommands) ? nullptr : it;
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
  if (method.mutation && !method.out_of_band) {
    running_.deadlines.watch(call);
  }
  const auto* command = find_command(method.name);
  if (command == nullptr) {
    return answer(running_, *call,
                  refuse(Errc::unsupported, std::string(method.name), "not in this version"));
  }
  if (caller.role < command->role) {
    return answer(running_, *call, not_permitted(*command, caller));
  }
  run(*command, call);
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
  const std::function<void()> serve = [this, &command, call] {
    answer(running_, *call, command.read(running_, *call));
  };
  const std::function<void()> look = [this, &command, call] {
    auto result = [&] {
      const StandStill still(running_);
      return command.read(running_, *call);
    }();
    answer(running_, *call, std::move(result));
  };
  const std::function<void()> by_itself = [this, &command, call] {
    command.change(running_, call, {});
  };
  switch (command.lane) {
    case Lane::any:
      return serve();
    case Lane::read:
      return running_.control.read(command.read != nullptr ? look : by_itself, asker_of(*call));
    case Lane::urgent:
      if (command.change == stop) {
        watch_over_stop(running_, call);
      }
      return running_.control.urgent(by_itself);
    case Lane::factory:
      return run_in_factory(command, call);
    case Lane::change:
      break;
  }
  const auto begin = [this, &command, call](Ticket ticket) {
    call->before = running_.generation;
    call->stops = running_.stops;
    auto met = check_conditions(running_, *call);
    if (met && !advance_to(Stage::preparing, *call->stage)) {
      met = deadline_passed(*call);
    }
    if (met) {
      met = may_prepare(running_.control.abandoned_threads(), call->caller.peer.uid);
    }
    if (!met) {
      return answer(running_, *call, met.error());
    }
    running_.control.works_for(call->caller.peer.uid);
    command.change(running_, call, std::move(ticket));
  };
  const bool queued = running_.control.change(begin, asker_of(*call));
  if (!queued) {
    answer(running_, *call,
           refuse(Errc::conflict, std::string(command.method), "too many changes wait already",
                  "try again when they are done"));
  }
}

void CommandTable::run_in_factory(const Command& command, const CallPtr& call) {
  if (auto free = may_prepare(running_.control.abandoned_threads(), call->caller.peer.uid); !free) {
    return answer(running_, *call, free.error());
  }
  auto result = std::make_shared<std::optional<Result<Json>>>();
  running_.control.in_factory(
      [this, &command, call, result] { *result = command.read(running_, *call); },
      [this, call, result] { answer(running_, *call, std::move(**result)); },
      [this, call](const std::string& hook) {
        answer(running_, *call, thread_abandoned(running_, hook, std::string(call->method->name)));
      },
      asker_of(*call));
}

void CommandTable::gone(std::uint64_t client) { running_.watches.forget(client); }

}  // namespace mauve::daemon
