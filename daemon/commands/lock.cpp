// SPDX-License-Identifier: LGPL-3.0-or-later
/// lock.set: locks the robot against changes, for example during a mission. At once, also beside a
/// change that is prepared, which is then refused.
#include <algorithm>
#include <array>

#include "commands/answer.h"

#include "base/thread_role.h"
#include "commands/audit.h"
#include "commands/lock.h"
#include "judge/judgement.h"
#include "mauve/host/architecture.h"
#include "mauve/host/change.h"
#include "protocol/in_words.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

namespace {

constexpr std::array<std::string_view, 4> kLocks = {"none", "params", "topology", "all"};

/// The differences that an operator makes with the code that is loaded.
constexpr std::array<std::string_view, 5> kOfOperators = {"core", "port", "property", "start",
                                                          "task"};

bool is_stop(const arch::Line& line) { return line.kind == "start" && line.after == Value(false); }

/// The edit starts or stops its component, or does nothing; the core may be made anew for that.
bool changes_mode_only(const Edit& edit) {
  return !edit.fsm && !edit.type && !edit.task && !edit.resource && !edit.lock_budget &&
         edit.properties.empty() && edit.connect.empty() && edit.disconnect.empty();
}

bool only_parks(const Edit& edit) {
  return changes_mode_only(edit) && edit.mode == Mode::park && !edit.core;
}

bool changes_edits_only(const Change& change) {
  return !change.changes_rules && change.new_components.empty() && change.new_resources.empty() &&
         change.remove.empty() && change.fallbacks.empty();
}

constexpr std::string_view kAllIsLocked =
    "everything that runs is locked: components may be stopped and a change may be confirmed, "
    "nothing else";

/// "uid 1000 set the lock (mission); an administrator ends it: mauvectl lock none"
std::string step_under_a_lock(const Running& running) {
  const auto& [uid, time, reason] = running.locked;
  return "uid " + std::to_string(uid) + " set the lock" +
         (reason.empty() ? "" : " (" + reason + ")") +
         "; an administrator ends it: mauvectl lock none";
}

Error all_is_locked(const Running& running) {
  return refuse({Errc::conflict, "locked"}, "lock", std::string(kAllIsLocked),
                step_under_a_lock(running));
}

Status check_role(const Call& call, const std::vector<arch::Line>& lines) {
  const auto above = std::ranges::find_if(
      lines, [&](const arch::Line& line) { return role_for(line) > call.caller.role; });
  if (above == lines.end()) {
    return ok();
  }
  return refuse({Errc::not_permitted, "role_missing"}, above->address,
                "needs role " + std::string(server::to_string(role_for(*above))) +
                    " whichever command asks for it, you have " +
                    std::string(server::to_string(call.caller.role)) +
                    "; this change has: " + protocol::line_in_words(to_json(*above)),
                "ask a member of the group mauve-admin; mauvectl stop is free");
}

/// The first line that the lock holds; the end: none.
auto held_in(Lock lock, const std::vector<arch::Line>& lines) {
  switch (lock) {
    case Lock::none:
      break;
    case Lock::params:
      return std::ranges::find_if(lines, arch::changes_a_property);
    case Lock::topology:
      return std::ranges::find_if(lines, arch::changes_the_topology);
    case Lock::all:
      return std::ranges::find_if_not(lines, is_stop);
  }
  return lines.end();
}

std::string rule_of(Lock lock) {
  if (lock == Lock::params) {
    return "params are locked, so no property may be changed";
  }
  return lock == Lock::topology ? "topology is locked, so only properties may be changed, and "
                                  "components started and stopped"
                                : std::string(kAllIsLocked);
}

using HeldRules = std::map<std::string, std::string_view>;

/// The lock before a request changes it.
struct Before {
  Lock lock = Lock::none;
  LockRequest by;
  HeldRules held;
};

/// "the lock all of uid 1000, set at 2026-01-31T12:00:00Z (mission)"
std::string lock_in_words(const Before& before, uid_t asks) {
  constexpr std::size_t kSeconds = 19;
  const auto& [uid, time, reason] = before.by;
  return "the lock " + std::string(to_string(before.lock)) + " of " +
         (uid == asks ? "" : "another user, ") + "uid " + std::to_string(uid) + ", set at " +
         time.substr(0, kSeconds) + "Z" + (reason.empty() ? "" : " (" + reason + ")");
}

/// The lock or the reason that a request ends. Every step but that to `all` permits changes that
/// the lock before it refused.
std::string note_on_lock(const Before& before, Lock now, uid_t asks) {
  const auto words = lock_in_words(before, asks);
  if (now == Lock::none) {
    return "this ends " + words;
  }
  if (now == before.lock) {
    return before.by.reason.empty() ? words + ", had no reason"
                                    : "the new reason replaces that of " + words;
  }
  return "the lock " + std::string(to_string(now)) + " replaces " + words +
         (now == Lock::all ? "" : ", and permits changes that it refused");
}

/// "rule gnss_lost was held and may fire now"; empty: no rule was released.
std::string note_on_rules(const HeldRules& before, const HeldRules& now) {
  std::vector<std::string> names;
  for (const auto& [rule, why] : before) {
    if (!now.contains(rule)) {
      names.push_back(rule);
    }
  }
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    list += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  }
  if (names.size() == 1) {
    return "rule " + list + " was held and may fire now";
  }
  return names.empty() ? "" : "rules " + list + " were held and may fire now";
}

}  // namespace

std::string_view to_string(Lock lock) { return kLocks.at(static_cast<std::size_t>(lock)); }

Kind kind_of(const Call& call) {
  using protocol::Effect;
  switch (call.method->effect) {
    case Effect::adjusts:
      return Kind::harmless;
    case Effect::stops:
      return Kind::stop;
    case Effect::ends:
      return Kind::ending;
    default:
      break;
  }
  const auto method = call.method->name;
  return method == "change.apply" || method == kSupervision ? Kind::steps : Kind::other;
}

Status check_lock_of_all(const Running& running, Kind kind) {
  MAUVE_ON_THREAD(control);
  if (kind != Kind::other || running.lock != Lock::all) {
    return ok();
  }
  return all_is_locked(running);
}

bool only_stops(const Change& change) {
  return changes_edits_only(change) && std::ranges::all_of(change.edits, only_parks);
}

bool only_starts_and_stops(const Running& running, const Change& change) {
  const auto keeps_its_core = [&running](const Edit& edit) {
    const auto* component = running.architecture.find_component(edit.member);
    return !edit.core ||
           (component != nullptr && component->bundle()->core_type.name == edit.core->name);
  };
  return changes_edits_only(change) && std::ranges::all_of(change.edits, [&](const Edit& edit) {
           return edit.mode != Mode::keep && changes_mode_only(edit) && keeps_its_core(edit);
         });
}

Status check_lock_of_all(const Running& running, const Change& change) {
  MAUVE_ON_THREAD(control);
  if (running.lock != Lock::all || only_stops(change)) {
    return ok();
  }
  return all_is_locked(running);
}

Status may_change(const Running& running, const Call& call, const std::vector<arch::Line>& lines) {
  MAUVE_ON_THREAD(control);
  if (auto permitted = check_role(call, lines); !permitted) {
    return permitted;
  }
  const auto held = held_in(running.lock, lines);
  if (held == lines.end()) {
    return ok();
  }
  return refuse(
      {Errc::conflict, "locked"}, held->address,
      rule_of(running.lock) + "; this change has: " + protocol::line_in_words(to_json(*held)),
      step_under_a_lock(running));
}

server::Role role_for(const arch::Line& line) {
  const bool common = std::ranges::find(kOfOperators, line.kind) != kOfOperators.end();
  return common ? server::Role::operator_ : server::Role::admin;
}

std::string_view held_by(Lock lock, const rules::Steps& steps) {
  using rules::Action;
  const auto is_of = [&](auto matches) {
    return std::ranges::any_of(steps,
                               [&](const rules::Step& step) { return matches(step.action); });
  };
  switch (lock) {
    case Lock::none:
      return {};
    case Lock::all:
      return is_of([](Action action) { return action != Action::stop; }) ? "everything is locked"
                                                                         : "";
    case Lock::params:
      return is_of([](Action action) { return action == Action::set; }) ? "params are locked" : "";
    case Lock::topology:
      break;
  }
  const bool other = is_of([](Action action) {
    return action != Action::set && action != Action::start && action != Action::stop;
  });
  return other ? "topology is locked" : "";
}

std::map<std::string, std::string_view> held_rules(const Running& running) {
  MAUVE_ON_THREAD(control);
  const auto& supervision = running.supervisor.supervision();
  std::map<std::string, std::string_view> held;
  for (const auto& rule : supervision.rules) {
    const auto& steps = rule.transaction.empty() ? rule.steps : *supervision.find(rule.transaction);
    if (const auto why = held_by(running.lock, steps); !why.empty()) {
      held.emplace(rule.name, why);
    }
  }
  return held;
}

void set_lock(Running& running, const CallPtr& call, Ticket /*none: it waits for no change*/) {
  const auto word = text_or(call->params, "lock");
  const auto* found = std::find(kLocks.begin(), kLocks.end(), word);
  if (found == kLocks.end()) {
    return answer(
        running, *call,
        refuse({Errc::invalid_value, "not_a_choice"}, "lock",
               "'" + word.substr(0, 64) + "' is no lock", "none, params, topology or all"));
  }
  if (auto met = check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  const auto lock = static_cast<Lock>(found - kLocks.begin());
  const auto reason = text_or(call->params, "reason");
  const auto uid = call->caller.peer.uid;
  const Before before = {running.lock, running.locked, held_rules(running)};
  const bool new_reason = lock != Lock::none && !reason.empty() && reason != before.by.reason;
  const bool changed = lock != before.lock || new_reason;
  if (changed) {
    running.lock = lock;
    running.locked = {uid, logging::utc(std::chrono::system_clock::now()), reason};
  }
  const auto held = held_rules(running);
  Json names = Json::array();
  for (const auto& [rule, why] : held) {
    names.push_back(rule);
  }
  Json result = {{"lock", word},
                 {"changed", changed},
                 {"rules_held", held.size()},
                 {"held_rules", std::move(names)},
                 {"state", changed ? "applied" : "unchanged"},
                 {"generation", running.generation.load()}};
  if (changed && before.lock != Lock::none) {
    result["notes"].push_back(note_on_lock(before, lock, uid));
  }
  if (auto note = note_on_rules(before.held, held); !note.empty()) {
    result["notes"].push_back(std::move(note));
  }
  answer(running, *call, std::move(result));
}

}  // namespace mauve::daemon
