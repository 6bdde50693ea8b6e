// SPDX-License-Identifier: LGPL-3.0-or-later
/// change.confirm and change.undo: the fate of the change on probation. They are served before all
/// requests that wait.
#include <algorithm>
#include <charconv>
#include <set>
#include <system_error>

#include "base/duration.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/lock.h"
#include "commands/model.h"
#include "commands/recovery/nothing_to_undo.h"
#include "commands/recovery/unproven.h"
#include "commands/say.h"
#include "exec/system/books.h"
#include "judge/judgement.h"
#include "mauve/host/architecture.h"
#include "state/state_store.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

namespace {

/// "2/64": late jobs that are tolerated, of so many.
Status read_misses(const std::string& text, Probation& probation) {
  unsigned misses = 0;
  unsigned window = 0;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, misses);
  const bool slash = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, window) : first;
  const bool sound = slash && second.ec == std::errc() && second.ptr == end && window >= 1 &&
                     window <= 64 && misses < window;
  if (!sound) {
    return refuse({Errc::invalid_value, "probation_invalid"}, "misses",
                  "'" + text.substr(0, 64) + "' is no M/K with M below K, and K at most 64",
                  "2/64: two late jobs of the last 64 are tolerated");
  }
  if (misses == 0) {
    return refuse({Errc::invalid_value, "probation_invalid"}, "misses",
                  "0 would roll back at a single late job, and a machine that stands still makes "
                  "any job late",
                  "1/" + std::to_string(std::max(window, 2U)) + " is the strictest");
  }
  probation.misses = misses;
  probation.window = window;
  return ok();
}

/// Refuses options that would have no effect in a change without a probation.
Status nothing_else(const Json& params) {
  for (const char* option : {"misses", "confirm_within"}) {
    if (params.contains(option)) {
      return refuse({Errc::invalid_value, "probation_invalid"}, option,
                    "probation is off, so this would do nothing",
                    "leave out " + std::string(option) + ", or probation off");
    }
  }
  return ok();
}

/// A change on probation, with those that it joined.
struct ChangeOnProbation {
  std::vector<std::uint64_t> generations;
  std::vector<std::string> components;
  std::optional<PlaceTarget> place;  ///< of a swap in place
  std::vector<std::string> notes = {};
};

/// Of `undo`; 0: the newest change.
std::uint64_t wanted_generation(const Call& call) {
  return call.params.value("generation", std::uint64_t{0});
}

Json change_json(const ChangeOnProbation& change) {
  return {{"generations", change.generations}, {"components", change.components}};
}

/// The changes on probation, each with the changes that it joined. A change that a rollback is
/// taking back is left out.
Json on_probation(const Running& running) {
  Json all = Json::array();
  for (const auto& open : running.deployer.probations()) {
    if (!open.rolls_back) {
      all.push_back(
          change_json(ChangeOnProbation{open.generations, open.components, std::nullopt}));
    }
  }
  for (const auto& place : running.places) {
    if (!place.rolls_back) {
      all.push_back(
          change_json(ChangeOnProbation{{place.generation}, {place.component}, std::nullopt}));
    }
  }
  return all;
}

/// The generations that are on probation, also those that a rollback takes back.
std::set<std::uint64_t> unproven_now(const Running& running) {
  std::set<std::uint64_t> all;
  for (const auto& open : running.deployer.probations()) {
    all.insert(open.generations.begin(), open.generations.end());
  }
  for (const auto& place : running.places) {
    all.insert(place.generation);
  }
  return all;
}

/// The one that `undo` takes back: the one that made this generation, or the newest for 0. No
/// generations: there is none.
ChangeOnProbation meant_by(const Running& running, std::uint64_t generation) {
  ChangeOnProbation newest;
  for (const auto& open : running.deployer.probations()) {
    const bool meant = generation == 0 ||
                       std::ranges::find(open.generations, generation) != open.generations.end();
    if (meant && !open.rolls_back) {
      newest = {open.generations, open.components, std::nullopt, open.notes};
    }
  }
  const auto than = newest.generations.empty() ? 0 : newest.generations.back();
  if (auto place = newest_place(running, than, generation)) {
    newest = {{place->generation}, {place->component}, std::move(place)};
    const auto before = newest.place->before.lock();
    const auto* component = running.architecture.find_component(newest.place->component);
    if (before != nullptr && component != nullptr) {
      exec::note_one_way(component->name(), component->core(), *before->core, StatePolicy::keep,
                         newest.notes);
    }
  }
  return newest;
}

/// The answer to `undo` of these changes, before they are rolled back.
Json undone_json(const Running& running, const ChangeOnProbation& newest) {
  Json result = {{"lines", running.rollback_lines.back_from(newest.generations)},
                 {"undone", change_json(newest)},
                 {"components", Json::array()}};
  const auto& undone = newest.generations;
  if (!undone.empty() && result["lines"].empty() && running.rollback_lines.knows(undone)) {
    say_notes({"the undo changes no value and no connection: it brings back the elements from "
               "before generation " +
               std::to_string(undone.front())},
              result);
  }
  say_notes(newest.notes, result);
  say_notes(running.supervisor.notes_on(newest.generations), result);
  say_notes(notes_on_files(running, newest.generations), result);
  return result;
}

/// A rollback that mauved decides is a matter of safety, and no lock holds it. One that a user asks
/// for is a change like any other.
Status may_undo(const Running& running, const Call& call, const ChangeOnProbation& newest,
                const Json& lines) {
  if (running.rollback_lines.knows(newest.generations)) {
    return may_change(running, call, lines_of(lines));
  }
  if (running.lock == Lock::none && call.caller.role == server::Role::admin) {
    return ok();
  }
  return refuse({Errc::conflict, "undo_too_far"}, "change.undo",
                "goes back over so many changes that their differences are not all known any more, "
                "so no lock and no role can judge them",
                "an administrator may do it while nothing is locked");
}

/// `undone`: the generation of the newest change that went back.
void answer_undone(Running& running, Call& call, std::uint64_t undone, Json result) {
  const auto* rollback = running.rollbacks.of(undone);
  call.made = rollback == nullptr ? running.generation.load() : rollback->generation;
  result["generation"] = call.made;
  result["changed"] = true;
  result["state"] = "applied";
  answer(running, call, std::move(result));
}

void answer_plan(Running& running, const Call& call, Json result) {
  result["generation"] = running.generation.load();
  result["changed"] = false;
  result["state"] = "unchanged";
  result["dry_run"] = true;
  answer(running, call, std::move(result));
}

/// Back to the core before a swap in place, which takes as long as the swap did.
void undo_in_place(Running& running, const CallPtr& call, const PlaceTarget& target, Json result,
                   const std::string& reason) {
  if (auto begun = undo_place(running, target, reason); !begun) {
    return answer(running, *call, begun.error());
  }
  running.rollbacks.ask(target.generation,
                        {call->caller.peer.uid, text_or(call->params, "reason")});
  running.control.await([&running] { return !places_roll_back(running); },
                        [&running, call, target, result = std::move(result)]() mutable {
                          if (auto back = is_back(running, target); !back) {
                            return answer(running, *call, back.error());
                          }
                          answer_undone(running, *call, target.generation, std::move(result));
                        });
}

/// A change came into force while an undo waited: its user did not ask for the undo of that one.
Error not_the_newest(const ChangeOnProbation& wanted, const ChangeOnProbation& newest) {
  const auto now = newest.generations.empty()
                       ? std::string("no change is on probation now")
                       : "generation " + std::to_string(newest.generations.back()) +
                             " is the newest change on probation now";
  return refuse({Errc::conflict, "changed_meanwhile"}, "change.undo",
                "another change ended while undo waited: generation " +
                    std::to_string(wanted.generations.back()) + " was to be rolled back, but " +
                    now + "; nothing is rolled back",
                "mauvectl undo --dry-run shows what undo rolls back now");
}

/// Judges and begins the undo of the change that was the newest when the user asked for it. The
/// caller lets the system stand still, so the undo concerns the changes that are shown and judged.
void begin_undo(Running& running, const CallPtr& call, const ChangeOnProbation& wanted) {
  if (auto met = check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  note_place_failures(running);
  const auto newest = meant_by(running, wanted_generation(*call));
  const auto last = wanted.generations.empty() ? 0 : wanted.generations.back();
  if (running.rollbacks.of(last) != nullptr) {
    return answer(running, *call, nothing_to_undo(running, last));
  }
  if (newest.generations != wanted.generations) {
    return answer(running, *call, not_the_newest(wanted, newest));
  }
  auto result = undone_json(running, newest);
  if (auto allowed = may_undo(running, *call, newest, result["lines"]); !allowed) {
    return answer(running, *call, allowed.error());
  }
  if (flag(call->params, "dry_run") && !newest.generations.empty()) {
    return answer_plan(running, *call, std::move(result));
  }
  const auto reason = text_or(call->params, "reason");
  const auto text = std::string(kUndone) + (reason.empty() ? " by request" : ": " + reason);
  const bool goes_back =
      !newest.generations.empty() && is_rolling_back(running, newest.generations.back());
  if (newest.place && !goes_back) {
    return undo_in_place(running, call, *newest.place, std::move(result), text);
  }
  if (newest.generations.empty() || goes_back || !running.deployer.undo(text, newest.generations)) {
    return answer(running, *call, nothing_to_undo(running, wanted_generation(*call)));
  }
  running.rollbacks.ask(newest.generations.back(), {call->caller.peer.uid, reason});
  const auto undone = newest.generations.back();
  running.control.await(
      [&running, undone] { return !is_rolling_back(running, undone); },
      [&running, call, undone, result = std::move(result)]() mutable {
        running.report_outcomes();  // that saves it, with the mark of the one that it goes back to
        answer_undone(running, *call, undone, std::move(result));
      });
}

/// Nothing is on probation and nothing waits for a confirmation: the generation that runs is kept,
/// but if a rollback made it, its user wanted to confirm another one.
Status check_kept(Running& running) {
  running.report_outcomes();
  const auto open = running.deployer.probations();
  if (places_roll_back(running) || std::ranges::any_of(open, &OpenProbation::rolls_back)) {
    return refuse({Errc::wrong_state, "nothing_on_probation"}, {},
                  "the newest change is being rolled back, so there is nothing to confirm",
                  "mauvectl logs shows the cause");
  }
  const auto now = running.deployer.generation(/*before_stops=*/true);
  if (running.rollback != now) {
    return ok();
  }
  return refuse({Errc::wrong_state, "nothing_on_probation"}, {},
                "the newest change was rolled back, so there is nothing to confirm: generation " +
                    std::to_string(now) + " has the system from before it",
                "mauvectl logs shows the cause");
}

}  // namespace

Result<std::optional<Probation>> probation_of(const Json& params) {
  Probation probation;
  if (const auto given = params.find("probation"); given != params.end()) {
    const auto& text = given->get_ref<const std::string&>();
    if (text == "off") {
      if (auto alone = nothing_else(params); !alone) {
        return alone.error();
      }
      return std::optional<Probation>{};
    }
    const bool digits =
        !text.empty() && text.size() < 10 && text.find_first_not_of("0123456789") == text.npos;
    if (!digits || std::stoul(text) == 0) {
      return refuse({Errc::invalid_value, "probation_invalid"}, "probation",
                    "'" + text.substr(0, 64) + "' is no number of jobs",
                    "a number such as 3000, or off");
    }
    probation.activations = std::stoul(text);
    probation.time = Duration{24h};  // the number alone decides
  }
  if (params.contains("misses")) {
    if (auto sound = read_misses(text_or(params, "misses"), probation); !sound) {
      return sound.error();
    }
  }
  if (const auto text = text_or(params, "confirm_within"); !text.empty()) {
    const auto within = parse_duration(text);
    if (!within || *within <= Duration{0}) {
      return refuse({Errc::invalid_value, "not_a_time"}, "confirm_within",
                    "'" + text.substr(0, 64) + "' is no time", "write it with a unit: 30s");
    }
    probation.confirm_within = *within;
  }
  return std::optional<Probation>{probation};
}

Json to_json(const Probation& probation) {
  Json json = {{"activations", probation.activations}, {"time_ns", probation.time.count()}};
  if (probation.confirm_within > Duration{0}) {
    json["confirm_within_ns"] = probation.confirm_within.count();
  }
  return json;
}

// A member may fail in the instant of the confirmation: its change is rolled back all the same. The
// generation that runs then holds elements that go back, so no start may use it.
void confirm(Running& running, const CallPtr& call, Ticket /*none*/) {
  if (auto met = check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  note_place_failures(running);
  auto confirmed = on_probation(running);
  if (flag(call->params, "dry_run")) {
    return answer(running, *call,
                  Json{{"generation", running.deployer.generation()},
                       {"changed", false},
                       {"confirmed", std::move(confirmed)},
                       {"dry_run", true}});
  }
  const bool done = running.deployer.confirm().has_value();
  const bool places = confirm_places(running);
  const auto left = unproven_now(running);
  const bool whole = left.empty();
  const bool new_code = whole && confirm_unproven(running);
  // Also when nothing else confirms it, such as a start in which a component failed.
  const bool changes = done || places || new_code || (whole && is_saved_unconfirmed(running));
  if (auto kept = changes ? ok() : check_kept(running); !kept) {
    return answer(running, *call, kept.error());
  }
  Json result{{"generation", running.deployer.generation()},
              {"changed", changes},
              {"confirmed", Json::array()}};
  for (auto& one : confirmed) {
    if (!left.contains(one["generations"].back().get<std::uint64_t>())) {
      result["confirmed"].push_back(std::move(one));
    }
  }
  if (whole) {
    call->confirms = true;  // a power cut must not take it back, so the answer waits for the disk
  } else {
    say_notes({"generation " + std::to_string(*left.rbegin()) +
               " is not confirmed: it is being rolled back, or another change joins it. So the "
               "generation that runs is not kept for a start; try again"},
              result);
  }
  answer(running, *call, std::move(result));
}

// The undo of a swap in place is a change, so it waits for the end of the change under way. That
// change may have its answer already, while [factory] frees the elements that it retired.
void undo(Running& running, const CallPtr& call, Ticket /*none*/) {
  auto wanted = meant_by(running, wanted_generation(*call));
  if (!wanted.place || !running.control.busy()) {
    return begin_undo(running, call, wanted);
  }
  const auto until = std::chrono::steady_clock::now() + running.control.prepare_within();
  running.control.await(
      [&running, until] {
        return !running.control.busy() || std::chrono::steady_clock::now() >= until;
      },
      [&running, call, wanted = std::move(wanted)] {
        const FromLookToAct still(running);
        begin_undo(running, call, wanted);
      });
}

}  // namespace mauve::daemon
