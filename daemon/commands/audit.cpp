// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/audit.h"

#include <unistd.h>

#include "base/thread_role.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "commands/answer.h"
#include "protocol/in_words.h"
#include "state/state_store.h"

namespace mauve::daemon {

namespace {

using logging::Event;

constexpr std::size_t kLongest = 1'000;  ///< bytes of a text that a client gives

std::int64_t number(std::uint64_t value) { return static_cast<std::int64_t>(value); }

std::string bounded(const std::string& text) { return text.substr(0, kLongest); }

/// The first fields of both kinds of line.
struct Line {
  logging::Fields fields;
  Json json;

  void add(const char* name, std::string value) {
    json[name] = value;
    fields.push_back({name, std::move(value)});
  }
  void add(const char* name, std::int64_t value) {
    json[name] = value;
    fields.push_back({name, value});
  }
};

Line begin(const Call& call) {
  Line line;
  line.json["time"] = logging::utc(std::chrono::system_clock::now());
  line.add("method", std::string(call.method->name));
  line.add("uid", number(call.caller.peer.uid));
  line.add("pid", static_cast<std::int64_t>(call.caller.peer.pid));
  if (!call.caller.peer.program.empty()) {
    line.add("program", call.caller.peer.program);
  }
  line.add("params", bounded(protocol::to_line(call.params)));
  const auto reason = text_or(call.params, "reason");
  if (!reason.empty()) {
    line.add("reason", bounded(reason));
  }
  // A change that the daemon makes by itself gives its reason: "by rule gnss_lost".
  const bool by_itself = call.method->name == kSupervision && !reason.empty();
  const auto user = "by uid " + std::to_string(call.caller.peer.uid) +
                    (reason.empty() ? "" : " (" + bounded(reason) + ")");
  line.fields.push_back({"by", by_itself ? bounded(reason) : user});
  line.add("before", number(call.before));
  return line;
}

/// The first parameter of the method: "first.core.gain, first.core.bias and 3 more". The text of a
/// file is left out for its name.
std::string object_of(const Call& call) {
  constexpr std::size_t kFew = 3;
  const auto params = call.method->params;
  const auto first = std::ranges::find_if(
      params, [](const protocol::Field& field) { return field.name != "text"; });
  const auto given = first == params.end() ? call.params.end() : call.params.find(first->name);
  if (given == call.params.end() || given->is_boolean()) {
    return {};
  }
  if (!given->is_structured()) {
    return bounded(given->is_string() ? given->get<std::string>() : given->dump());
  }
  std::string names;
  std::size_t count = 0;
  for (const auto& one : given->items()) {
    if (++count <= kFew) {
      const auto name = given->is_object() ? Json(one.key()) : one.value();
      names +=
          (names.empty() ? "" : ", ") + (name.is_string() ? name.get<std::string>() : name.dump());
    }
  }
  return bounded(names) + (count > kFew ? " and " + std::to_string(count - kFew) + " more" : "");
}

/// "dry run of param.set first.core.gain"
std::string request_of(const Call& call) {
  const auto object = object_of(call);
  return (flag(call.params, "dry_run") ? "dry run of " : "") + std::string(call.method->name) +
         (object.empty() ? "" : " ") + object;
}

/// Of a command that changes no component: "goal.write [{x: 1, y: 2}]", a plugin, a lock, a core.
std::string subject_of(const Call& call, const Json& result) {
  if (const auto service = text_or(call.params, "service"); !service.empty()) {
    const auto given = call.params.find("arguments");
    return bounded(service + (given == call.params.end() ? "" : " " + protocol::in_words(*given)));
  }
  for (const char* name : {"plugin", "lock", "core"}) {
    if (auto subject = text_or(result, name); !subject.empty()) {
      return subject;
    }
  }
  return {};
}

/// The changes of a receipt, in words: "~ control.core: pi -> pid; its state pi/2, 24
/// bytes, is dropped".
std::string detail_of(const Call& call, const Json& result) {
  auto detail = changes_of(result);
  if (!result.contains("components")) {
    return detail.empty() ? subject_of(call, result) : detail;
  }
  std::string names;
  for (const auto& member : result["components"]) {
    const bool dropped = member.contains("dropped");
    if (!detail.empty() && !dropped) {
      continue;
    }
    names += (names.empty() ? "" : ", ") + member["name"].get<std::string>();
    if (dropped) {
      names += " (its state " + member["dropped"].get<std::string>() + ", " +
               member["dropped_bytes"].dump() + " bytes, is dropped)";
    }
  }
  return detail + (detail.empty() || names.empty() ? "" : "; ") + names;
}

/// The audit log records that the daemon itself did it.
constexpr protocol::Method kByItself{.name = kSupervision, .effect = protocol::Effect::changes};

}  // namespace

bool by_itself(const Call& call) { return call.method == &kByItself; }

CallPtr call_by_itself(const Running& running, std::string reason) {
  auto call = std::make_shared<Call>();
  call->method = &kByItself;
  call->caller.role = server::Role::operator_;
  call->caller.peer.uid = geteuid();
  call->caller.peer.pid = getpid();
  call->params = {{"reason", std::move(reason)}};
  call->reply = [](const server::Outcome& /*no client waits*/) {};
  call->received = std::chrono::steady_clock::now();
  call->before = running.generation;
  return call;
}

std::string changes_of(const Json& result) {
  constexpr std::size_t kMost = 8;
  const auto lines = result.find("lines");
  return lines == result.end() ? std::string() : bounded(protocol::lines_in_words(*lines, kMost));
}

Json audit_applied(Running& running, const Call& call, const Json& result) {
  MAUVE_ON_THREAD(control);
  auto line = begin(call);
  line.add("generation", result.at("generation").get<std::int64_t>());
  const bool unchanged = result.contains("changed") && !flag(result, "changed");
  line.add("state", text_or(result, "state", unchanged ? "unchanged" : "applied"));
  line.json["outcome"] = "applied";
  if (auto changes = changes_of(result); !changes.empty()) {
    line.json["changes"] = std::move(changes);
  }
  auto detail = detail_of(call, result);
  line.json["detail"] = bounded(detail);
  line.fields.push_back({"detail", std::move(detail)});
  // The supervisor logs one event for each change that the system makes by itself.
  if (call.method->name != kSupervision) {
    running.log.write(Event::change_applied, std::move(line.fields));
  }
  return std::move(line.json);
}

std::optional<Json> audit_refused(Running& running, const Call& call, const Fault& fault) {
  const bool unsafe = fault.state != "unchanged";
  if (!unsafe &&
      !running.refusals.may_write(call.caller.peer.uid, std::chrono::steady_clock::now())) {
    return std::nullopt;
  }
  auto line = begin(call);
  line.add("text", bounded((fault.where.empty() ? "" : fault.where + ": ") + fault.message));
  line.add("error", fault.name);
  line.add("id", fault.id.empty() ? fault.name : fault.id);
  line.json["state"] = fault.state;
  line.json["outcome"] = "refused";
  line.json["generation"] = running.generation.load();
  if (call.method->name != kSupervision) {
    line.fields.push_back({"request", request_of(call)});
    running.log.write(unsafe ? Event::change_unsafe : Event::change_refused,
                      std::move(line.fields));
  }
  return std::move(line.json);
}

void report_counted_refusals(Running& running, std::chrono::steady_clock::time_point now) {
  MAUVE_ON_THREAD(control);
  for (const auto& [uid, count] : running.refusals.take_counted(now)) {
    running.log.write(Event::refusals_counted, {{"uid", number(uid)}, {"count", number(count)}});
    if (running.store != nullptr) {
      running.store->audit({{"time", logging::utc(std::chrono::system_clock::now())},
                            {"uid", uid},
                            {"outcome", "refused"},
                            {"state", "unchanged"},
                            {"count", count}});
    }
  }
}

}  // namespace mauve::daemon
