// SPDX-License-Identifier: LGPL-3.0-or-later
/// change.confirm and change.undo: what becomes of the change on probation. Served before
/// everything that waits.
#include <algorithm>
#include <charconv>
#include <system_error>

#include "base/duration.h"
#include "commands/answer.h"
#include "commands/change.h"
#include "commands/unproven.h"
#include "keeper.h"

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
    return refuse(Errc::invalid_value, "misses",
                  "'" + text.substr(0, 64) + "' is no M/K with M below K, and K at most 64",
                  "2/64: two late jobs of the last 64 are tolerated");
  }
  if (misses == 0) {
    return refuse(Errc::invalid_value, "misses",
                  "0 would roll back at a single late job, and a machine that stands still makes "
                  "any job late",
                  "1/" + std::to_string(std::max(window, 2U)) + " is the strictest");
  }
  probation.misses = misses;
  probation.window = window;
  return ok();
}

/// What a change without a probation would silently not do.
Status nothing_else(const Json& params) {
  for (const char* option : {"misses", "confirm_within"}) {
    if (params.contains(option)) {
      return refuse(Errc::invalid_value, option, "probation is off, so this would do nothing",
                    "leave out " + std::string(option) + ", or probation off");
    }
  }
  return ok();
}

/// What to do instead, where anything is kept.
Error no_way_back(const Running& running, Error error) {
  const auto now = running.deployer.generation();
  error.hint.clear();
  if (running.keeper == nullptr) {
    return error;
  }
  for (const auto& saved : running.keeper->generations().list()) {
    if (saved.number < now && !saved.damaged) {
      error.hint = "mauvectl rollback " + std::to_string(saved.number);
      break;  // the newest first
    }
  }
  return error;
}

void answer_undone(Running& running, const Call& call) {
  answer(running, call,
         Json{{"generation", running.generation.load()},
              {"changed", true},
              {"state", "applied"},
              {"components", Json::array()}});
}

/// Back to the core before a swap in place, which takes as long as the swap did.
void undo_in_place(Running& running, const CallPtr& call, const PlaceTarget& target,
                   const std::string& reason) {
  if (auto begun = undo_place(running, target, reason); !begun) {
    return answer(running, *call, begun.error());
  }
  running.control.await([&running] { return !places_lead_back(running); },
                        [&running, call, target] {
                          if (auto back = is_back(running, target); !back) {
                            return answer(running, *call, back.error());
                          }
                          answer_undone(running, *call);
                        });
}

/// The generation of the newest probation of the deployer; 0: there is none.
std::uint64_t newest_open(const Running& running) {
  std::uint64_t newest = 0;
  for (const auto& open : running.deployer.probations()) {
    newest = std::max(newest, open.changes.back());
  }
  return newest;
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
      return refuse(Errc::invalid_value, "probation",
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
      return refuse(Errc::invalid_value, "confirm_within",
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

void confirm(Running& running, const CallPtr& call, Ticket /*none*/) {
  // A commit may be newer than the last look.
  running.generation = running.deployer.generation();
  if (auto met = check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  const auto done = running.deployer.confirm();
  const bool places = confirm_places(running);
  if (const bool new_code = confirm_unproven(running); !done && !places && !new_code) {
    return answer(running, *call, done.error());
  }
  call->confirms = true;  // what a power cut could take back is no confirmation: the answer waits
  answer(running, *call, Json{{"generation", running.deployer.generation()}, {"changed", true}});
}

void undo(Running& running, const CallPtr& call, Ticket /*none*/) {
  if (auto met = check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  const auto reason = text_or(call->params, "reason");
  const auto text = std::string(kUndone) + (reason.empty() ? " by request" : ": " + reason);
  if (const auto target = newest_place(running, newest_open(running))) {
    return undo_in_place(running, call, *target, text);
  }
  auto begun = running.deployer.undo(text);
  if (!begun) {
    return answer(running, *call, no_way_back(running, begun.error()));
  }
  const auto before = running.deployer.generation();
  running.control.await(
      [&running, before] {
        running.generation = running.deployer.generation();
        return running.generation != before || !running.deployer.going_back();
      },
      [&running, call] {
        running.tell_outcomes();  // that saves it, with the mark of the one that it goes back to
        answer_undone(running, *call);
      });
}

}  // namespace mauve::daemon
