// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/answer.h"

namespace mauve::daemon {

namespace {

using logging::Event;

std::int64_t number(std::uint64_t value) { return static_cast<std::int64_t>(value); }

/// A whole file does not belong into a log line.
std::string shown(Json params) {
  params.erase("text");
  return protocol::to_line(params).substr(0, 1000);
}

logging::Fields who(const Call& call) {
  logging::Fields fields = {{"method", std::string(call.method->name)},
                            {"uid", number(call.caller.peer.uid)},
                            {"pid", static_cast<std::int64_t>(call.caller.peer.pid)},
                            {"params", shown(call.params)}};
  if (const auto reason = text_or(call.params, "reason"); !reason.empty()) {
    fields.push_back({"reason", reason});
  }
  return fields;
}

void audit_done(Running& running, const Call& call, const Json& result) {
  auto fields = who(call);
  std::string detail;
  if (result.contains("components")) {
    for (const auto& member : result["components"]) {
      detail += (detail.empty() ? "" : ", ") + member["name"].get<std::string>();
    }
  } else if (result.contains("plugin")) {
    detail = result["plugin"].get<std::string>();
  }
  const auto state = text_or(result, "state", "applied");
  fields.push_back({"generation", number(running.generation)});
  fields.push_back({"state", state});
  fields.push_back({"detail", detail});
  running.log.write(Event::change_applied, std::move(fields));
}

void audit_refused(Running& running, const Call& call, const Fault& fault) {
  auto fields = who(call);
  fields.push_back({"text", (fault.where.empty() ? "" : fault.where + ": ") + fault.message});
  fields.push_back({"error", fault.name});
  const bool unsafe = fault.state != "unchanged";
  running.log.write(unsafe ? Event::change_unsafe : Event::change_refused, std::move(fields));
}

}  // namespace

void answer(Running& running, const Call& call, Result<Json> result, const std::string& state) {
  if (!result) {
    return answer_fault(running, call,
                        protocol::fault_of(result.error(), state, running.generation.load()));
  }
  if (call.method->mutation && !flag(*result, "dry_run")) {
    audit_done(running, call, *result);
  }
  call.reply(*std::move(result));
}

void answer_fault(Running& running, const Call& call, Fault fault) {
  if (call.method->mutation) {
    audit_refused(running, call, fault);
  }
  call.reply(std::move(fault));
}

Status check_conditions(const Running& running, const Call& call) {
  const auto wanted = call.params.find("if_generation");
  const auto generation = running.generation.load();
  if (wanted != call.params.end() && *wanted != generation) {
    return refuse(Errc::conflict, std::string(call.method->name),
                  "generation " + wanted->dump() + " was expected, " + std::to_string(generation) +
                      " is running",
                  "look at what was changed meanwhile, then try again");
  }
  const auto deadline = call.params.find("deadline_ms");
  if (deadline != call.params.end() && deadline->get<std::uint64_t>() < 86'400'000U) {
    const std::chrono::milliseconds allowed(deadline->get<std::int64_t>());
    if (std::chrono::steady_clock::now() - call.received > allowed) {
      return refuse(Errc::timed_out, std::string(call.method->name),
                    "the deadline passed before the change could begin, so it was given up",
                    "another change was under way; try again");
    }
  }
  return ok();
}

Json to_json(const Receipt& receipt) {
  Json members = Json::array();
  for (const auto& member : receipt.components) {
    members.push_back({{"name", member.name},
                       {"pause_ns", member.pause.count()},
                       {"missed", member.missed},
                       {"bytes", member.bytes}});
  }
  return {{"generation", receipt.generation},  {"changed", receipt.state != ChangeState::unchanged},
          {"state", to_string(receipt.state)}, {"commit", receipt.commit.count()},
          {"attempts", receipt.attempts},      {"components", std::move(members)}};
}

std::string text_or(const Json& params, const char* name, std::string otherwise) {
  const auto found = params.find(name);
  return found != params.end() && found->is_string() ? found->get<std::string>() : otherwise;
}

bool flag(const Json& params, const char* name) {
  const auto found = params.find(name);
  return found != params.end() && found->is_boolean() && found->get<bool>();
}

std::vector<std::string> texts(const Json& params, const char* name) {
  const auto found = params.find(name);
  return found == params.end() ? std::vector<std::string>()
                               : found->get<std::vector<std::string>>();
}

}  // namespace mauve::daemon
