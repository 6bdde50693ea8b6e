// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/answer.h"

#include "base/thread_role.h"

#include "commands/audit.h"
#include "commands/lock.h"
#include "commands/look/notice.h"
#include "commands/model.h"
#include "commands/recovery/unproven.h"
#include "commands/say.h"
#include "commands/stops.h"
#include "state/state_store.h"

namespace mauve::daemon {

namespace {

bool some_change_is_on_probation(const Running& running) {
  return running.deployer.on_probation() || !running.places.empty();
}

/// [control] Saves the running system, then adds a line with the request and its outcome to the
/// audit log. The generation in force may be that of another change, whose answer comes later,
/// names its author and marks it.
void keep(Running& running, const Call& call, std::optional<Confirmation> mark, Json line,
          std::function<void(bool saved)> then) {
  MAUVE_ON_THREAD(control);
  const StandStill still(running);
  Generation about;
  about.number = running.deployer.generation();
  about.boot = running.boot;
  about.time = logging::utc(std::chrono::system_clock::now());
  if (call.made == about.number) {
    about.uid = call.caller.peer.uid;
    about.command = call.method->name;
    about.reason = text_or(call.params, "reason");
    about.changes = text_or(line, "changes");
  }
  about.builds = builds_of(running.catalog);
  const bool on_probation = some_change_is_on_probation(running);
  about.mark = on_probation ? Confirmation::unconfirmed : mark.value_or(Confirmation::unconfirmed);
  auto as = on_probation || mark ? StateStore::As::marked : StateStore::As::before;
  if (call.confirms) {
    as = StateStore::As::confirmed;
  }
  if (call.confirms || about.mark == Confirmation::confirmed) {
    running.proofs.confirmed(about.number);
  }
  save_stops(running);  // a start has ended some
  running.store->keep(std::move(about), described(running), std::move(line), std::move(then), as,
                      running.deployer.generation(/*before_stops=*/true));
}

void remember_author(Running& running, const Call& call, const Json& result) {
  if (call.made > running.author.generation) {
    running.author = {call.made, call.caller.peer.uid, std::string(call.method->name),
                      changes_of(result), text_or(call.params, "reason")};
  }
}

/// For a later `why` about a component that failed.
void remember_change(Running& running, const Call& call, const Json& result,
                     std::uint64_t generation) {
  const auto members = result.find("components");
  if (members == result.end() || !members->is_array()) {
    return;
  }
  std::vector<std::string> names;
  for (const auto& member : *members) {
    names.push_back(text_or(member, "name"));
  }
  if (const auto undone = result.find("undone"); undone != result.end()) {
    names = (*undone)["components"].get<std::vector<std::string>>();
  }
  running.failures.changed(names, {generation, logging::utc(std::chrono::system_clock::now()),
                                   std::string(call.method->name), call.caller.peer.uid,
                                   text_or(call.params, "reason")});
  remember_cores(running);
}

/// A stop or a start proves nothing by itself: it continues the proof of the start before it.
void continue_proof(Running& running, const Call& call) {
  if (!call.mark && call.made != 0 && call.made == running.deployer.generation()) {
    carry_unproven(running, call.made);
  }
}

/// The mark of a call belongs to the generation that the call made.
std::optional<Confirmation> mark_of_its(Running& running, const Call& call) {
  if (call.made == running.deployer.generation()) {
    return call.mark;
  }
  const bool proven = call.mark == Confirmation::confirmed && !some_change_is_on_probation(running);
  if (call.made != 0 && proven) {
    running.proofs.confirmed(call.made);
  }
  return std::nullopt;
}

/// [disk] A failure, or another change, may have made a generation before this one was saved.
void say_followed(const StateStore& store, std::uint64_t made, Json& result) {
  if (made == 0 || store.generations().find(made)) {
    return;
  }
  const auto number = std::to_string(made);
  say_notes({"a later generation came before generation " + number +
             " was saved, so the history has no generation " + number},
            result);
}

/// [control] The answer states whether the change was also saved, so it waits for the disk; that of
/// a stop waits for the list of stops only.
void answer_applied(Running& running, const Call& call, Json result) {
  MAUVE_ON_THREAD(control);
  // The one in force may be a rollback of this change already, or of another one.
  const auto its =
      result.emplace("generation", running.deployer.generation()).first->get<std::uint64_t>();
  if (!call.method->harmless()) {
    remember_author(running, call, result);
    remember_change(running, call, result, its);
  }
  if (const auto lines = result.find("lines");
      lines != result.end() && some_change_is_on_probation(running)) {
    running.rollback_lines.remember(its, *lines);
  }
  look_at_places(running);  // its answer says that it ended a probation
  continue_proof(running, call);
  auto line = audit_applied(running, call, result);
  if (running.store == nullptr) {
    return call.reply(std::move(result));
  }
  const auto mark = mark_of_its(running, call);
  if (call.method->out_of_band()) {
    keep(running, call, mark, std::move(line), {});
    return reply_when_saved(running, call, std::move(result));
  }
  keep(running, call, mark, std::move(line),
       [reply = call.reply, store = running.store, made = call.made,
        result = std::move(result)](bool saved) mutable {
         result["saved"] = saved;
         if (saved) {
           say_followed(*store, made, result);
         }
         reply(std::move(result));
       });
}

/// ", made by uid 1000 with param.set", ", made by rule gnss_lost", ", requested by pilot"
std::string made_by(const Author& author, std::uint64_t generation) {
  if (author.generation != generation || author.command.empty()) {
    return {};
  }
  if (author.command == kSupervision) {
    return (author.reason.starts_with("by ") ? ", made " : ", ") + author.reason;
  }
  return ", made by uid " + std::to_string(author.uid) + " with " + author.command;
}

}  // namespace

void answer(Running& running, const Call& call, Result<Json> result, const std::string& state) {
  if (!result) {
    return answer_fault(running, call,
                        protocol::fault_of(result.error(), state, running.generation.load()));
  }
  if (call.method->mutation() && !flag(*result, "dry_run")) {
    return answer_applied(running, call, *std::move(result));
  }
  call.reply(*std::move(result));
}

void answer_fault(Running& running, const Call& call, Fault fault) {
  if (call.method->mutation()) {
    auto line = audit_refused(running, call, fault);
    if (line && running.store != nullptr && fault.state != "unchanged") {
      // No start may use a mixture of old and new.
      const bool mixed = fault.state == "partly";
      const auto mark =
          mixed ? std::optional(Confirmation::unconfirmed) : mark_of_its(running, call);
      if (mixed) {
        running.proofs.undecided(running.deployer.generation());
      }
      if (call.method->effect == protocol::Effect::stops) {
        continue_proof(running, call);  // a component that hangs stops later
      }
      keep(running, call, mark, *std::move(line), {});
    } else if (line && running.store != nullptr) {
      running.store->audit(*line);
    }
  }
  if (call.saved_stop != nullptr) {
    return reply_when_saved(running, call, std::move(fault));
  }
  call.reply(std::move(fault));
}

void refuse_text(Running& running, const Call& call, const std::string& subject,
                 const std::string& hint, Json errors) {
  const auto count = errors.size();
  auto fault = protocol::fault_of(
      refuse({Errc::invalid_value, "file_has_errors"}, text_or(call.params, "file", "text"),
             subject + " " + std::to_string(count) + (count == 1 ? " error" : " errors"), hint),
      "unchanged", running.generation.load());
  fault.errors = std::move(errors);
  answer_fault(running, call, std::move(fault));
}

Status check_long_answers(const Running& running, const Call& call) {
  MAUVE_ON_THREAD(control);
  const auto uid = call.caller.peer.uid;
  if (running.control.long_answers(uid) < Control::kLongAnswers) {
    return ok();
  }
  return refuse({Errc::limit, "too_many_answers"}, "uid " + std::to_string(uid),
                "waits for " + std::to_string(Control::kLongAnswers) +
                    " long answers (such as log.tail and trace.read) already",
                "send the next request when one of them has come");
}

Status check_conditions(const Running& running, const Call& call) {
  MAUVE_ON_THREAD(control);
  if (auto allowed = check_lock_of_all(running, kind_of(call)); !allowed) {
    return allowed;
  }
  const auto wanted = call.params.find("if_generation");
  const auto generation = running.generation.load();
  if (wanted != call.params.end() && *wanted != generation) {
    return refuse({Errc::conflict, "generation_differs"}, std::string(call.method->name),
                  "generation " + wanted->dump() + " was expected, " + std::to_string(generation) +
                      " is running" + made_by(running.author, generation),
                  "look at what was changed meanwhile, then try again");
  }
  const auto allowed = deadline_in(call.params);
  const bool late = allowed && std::chrono::steady_clock::now() - call.received > *allowed;
  if (late || !advance_to(Stage::under_way, *call.stage)) {
    return deadline_passed(call);
  }
  return ok();
}

std::optional<std::chrono::milliseconds> deadline_in(const Json& params) {
  const auto deadline = params.find("deadline_ms");
  if (deadline == params.end() || deadline->get<std::uint64_t>() >= 86'400'000U) {
    return std::nullopt;
  }
  return std::chrono::milliseconds(deadline->get<std::int64_t>());
}

Error deadline_passed(const Call& call) {
  return refuse({Errc::timed_out, "deadline_passed"}, std::string(call.method->name),
                "the deadline passed before the change could begin, so the change was dropped",
                "another change was under way; try again");
}

Json to_json(const Receipt& receipt) {
  Json members = Json::array();
  for (const auto& member : receipt.components) {
    Json row = {{"name", member.name},
                {"pause_ns", member.pause.count()},
                {"missed", member.missed},
                {"bytes", member.bytes}};
    if (!member.dropped.empty()) {
      row["dropped"] = member.dropped;
      row["dropped_bytes"] = member.dropped_bytes;
    }
    if (!member.converted.empty()) {
      row["converted"] = member.converted;
    }
    if (member.begins_anew) {
      row["begins_anew"] = true;
    }
    members.push_back(std::move(row));
  }
  Json result = {
      {"generation", receipt.generation},  {"changed", receipt.state != ChangeState::unchanged},
      {"state", to_string(receipt.state)}, {"commit", receipt.commit.count()},
      {"attempts", receipt.attempts},      {"components", std::move(members)}};
  if (!receipt.warnings.empty()) {
    result["warnings"] = receipt.warnings;
  }
  if (!receipt.notes.empty()) {
    result["notes"] = receipt.notes;
  }
  return result;
}

std::string text_or(const Json& params, const char* name, std::string otherwise) {
  const auto found = params.find(name);
  return found != params.end() && found->is_string() ? found->get<std::string>() : otherwise;
}

std::size_t number_or(const Json& params, const char* name, std::size_t otherwise) {
  const auto found = params.find(name);
  return found == params.end() ? otherwise : found->get<std::size_t>();
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
