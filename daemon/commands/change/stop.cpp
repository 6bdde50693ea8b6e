// SPDX-License-Identifier: LGPL-3.0-or-later
/// component.stop: ends the current job, writes safe values, parks. Served before everything else,
/// also while a long change is prepared, and without [control] when that is held up.
#include <algorithm>
#include <atomic>

#include "commands/answer.h"

#include "base/thread_role.h"
#include "commands/change/change.h"
#include "commands/change/stop.h"
#include "commands/look/named.h"
#include "commands/say.h"
#include "commands/stops.h"
#include "state/state_store.h"

namespace mauve::daemon {

namespace {

/// [stop] The first checks that [control] is going to make: false when it will refuse the stop.
bool applies(const Running& running, const Call& call) {
  if (flag(call.params, "all") == !texts(call.params, "components").empty()) {
    return false;
  }
  const auto wanted = call.params.find("if_generation");
  if (wanted != call.params.end() && *wanted != running.generation.load()) {
    return false;
  }
  const auto passed = std::chrono::steady_clock::now() - call.received;
  const auto deadline = call.params.find("deadline_ms");
  return deadline == call.params.end() || deadline->get<std::uint64_t>() >= 86'400'000U ||
         passed <= std::chrono::milliseconds(deadline->get<std::int64_t>());
}

/// Those that ran are the members of the receipt, although an ordinary stop met them parked.
Json directly(Json receipt, const std::vector<std::string>& ran) {
  receipt["directly"] = true;
  receipt["changed"] = !ran.empty();
  receipt["state"] = ran.empty() ? "unchanged" : "applied";
  receipt["components"] = Json::array();
  for (const auto& name : ran) {
    receipt["components"].push_back({{"name", name}, {"pause_ns", 0}, {"missed", 0}, {"bytes", 0}});
  }
  return receipt;
}

/// [stop] The books follow when [control] goes on.
server::Outcome outcome_of(const Running& running, const DirectStop& done,
                           const std::vector<std::string>& ran) {
  const auto generation = running.generation.load();
  if (!done.run_still().empty()) {
    std::string names;
    for (const auto& name : done.run_still()) {
      names += (names.empty() ? "" : ", ") + name;
    }
    return protocol::fault_of(
        refuse({Errc::partly, "stops_later"}, names,
               "did not end its job in time, while [control] is held up; it stops as soon as the "
               "job ends, all others are stopped",
               "end mauved with SIGTERM, which writes all safe values"),
        "partly", generation);
  }
  Json receipt = {{"generation", generation}, {"commit", 0}, {"attempts", 0}};
  receipt["warnings"] = Json::array(
      {"the thread that executes commands did not come to this stop within 25 ms (a long command, "
       "or "
       "code of a plugin that does not return), so the stop was carried out without it; other "
       "commands wait until that thread goes on; SIGTERM ends mauved safely all the same"});
  return directly(std::move(receipt), ran);
}

/// [stop] Called until it returns true: the answer waits for the disk.
std::function<bool(const DirectStop&, const std::vector<std::string>&)> answering_directly(
    const Running& running, std::shared_ptr<const Call> call) {
  return [&running, call = std::move(call), begun = false, saved = std::shared_ptr<SavedStop>()](
             const DirectStop& done, const std::vector<std::string>& ran) mutable {
    if (!std::exchange(begun, true)) {
      saved = save_stop_directly(running, *call, names_in(call->params, "components"));
    }
    if (saved != nullptr && !saved->over()) {
      return false;
    }
    auto outcome = outcome_of(running, done, ran);
    if (saved != nullptr) {
      saved->say(outcome);
    }
    call->reply(std::move(outcome));
    return true;
  };
}

/// Ends the order when the stop is over, on whichever path.
std::shared_ptr<void> until_over(Running& running, std::shared_ptr<StopOrder> order) {
  return {nullptr, [&running, order = std::move(order)](void*) {
            if (order != nullptr) {
              order->end(running.deployer);
            }
          }};
}

/// A rollback may bring the component back, or a change under way brings it.
std::string note_on_away(const std::string& component) {
  return component +
         " is not part of the system now; if a rollback brings it back, it stays stopped";
}

/// The components of a stop.
struct Meant {
  std::vector<std::string> stopped = {};  ///< already
  std::vector<arch::Line> lines = {};     ///< of those that are to stop
  std::vector<std::string> away = {};     ///< a note for each
};

Meant sort(const Running& running, const std::vector<std::string>& names) {
  Meant meant;
  for (const auto& name : names) {
    if (is_away(running, name)) {
      meant.away.push_back(note_on_away(name));
    } else if (running.deployer.status(name).state == ComponentState::stopped) {
      meant.stopped.push_back(name);
    } else {
      meant.lines.push_back(arch::make_line("start", name + ".start", true, false));
    }
  }
  return meant;
}

std::vector<std::string> running_of(const Meant& meant) {
  std::vector<std::string> names;
  for (const auto& line : meant.lines) {
    names.push_back(line.address.substr(0, line.address.find('.')));
  }
  return names;
}

/// The answer to a dry run of a stop.
Json planned(const Running& running, const Meant& meant) {
  Receipt nothing;
  nothing.generation = running.deployer.generation();
  auto result = to_json(nothing);
  result["dry_run"] = true;
  say_lines(meant.lines, result);
  if (!result.contains("lines")) {
    result["lines"] = Json::array();
  }
  say_already(meant.stopped, "stopped", result);
  say_notes(meant.away, result);
  return result;
}

}  // namespace

Json answer_to_stop(const Call& call, const Receipt& receipt) {
  MAUVE_ON_THREAD(control);
  const auto ran =
      call.order != nullptr ? call.order->stopped_directly() : std::vector<std::string>();
  return ran.empty() ? to_json(receipt) : directly(to_json(receipt), ran);
}

bool overtaken_by_stop(const Running& running, const Call& call, const Change& change) {
  MAUVE_ON_THREAD(control);
  return std::any_of(change.edits.begin(), change.edits.end(), [&](const Edit& edit) {
    const auto came = running.stops_came.find(edit.member);
    return edit.mode == Mode::run && came != running.stops_came.end() &&
           came->second > call.received;
  });
}

void watch_over_own_stop(Running& running, const CallPtr& call,
                         std::vector<std::string> components) {
  MAUVE_ON_THREAD(control);
  if (running.stopper == nullptr || components.empty()) {
    return;
  }
  call->order = std::make_shared<StopOrder>(std::move(components), nullptr, nullptr);
  call->order->begin();
  call->watched = until_over(running, call->order);
  running.stopper->watch(call->order);
}

void stop_only(Running& running, const CallPtr& call, Ticket ticket, const Change& change,
               std::shared_ptr<ChangeHooks> hooks) {
  MAUVE_ON_THREAD(control);
  if (auto met = check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  auto names = change.stops;
  std::vector<arch::Line> lines;
  for (const auto& edit : change.edits) {
    if (std::ranges::find(names, edit.member) == names.end()) {
      names.push_back(edit.member);
    }
    lines.push_back(arch::make_line("start", edit.member + ".start", true, false));
  }
  std::vector<std::string> ran;
  for (const auto& name : names) {
    ++running.stops[name];
    if (running.deployer.status(name).state != ComponentState::stopped) ran.push_back(name);
  }
  if (call->order != nullptr) {
    call->order->found(std::move(ran));
  }
  auto stopping = running.deployer.begin_stop(
      names, change.stops.empty() ? std::nullopt : std::optional(change.stopped_by));
  if (!stopping) {
    return answer(running, *call, stopping.error());
  }
  when_answered(running, call, *std::move(stopping),
                [&running, call, lines, hooks, ticket = std::move(ticket)](Ongoing& done) {
                  const auto receipt = done.result();
                  call->watched.reset();
                  if (!receipt) {
                    return answer(running, *call, receipt.error(), "safe");
                  }
                  auto result = answer_to_stop(*call, *receipt);
                  if (flag(result, "changed")) {
                    say_lines(lines, result);
                  }
                  if (hooks != nullptr) {
                    hooks->complete(result);
                  }
                  answer(running, *call, std::move(result));
                });
}

void watch_over_stop(Running& running, const CallPtr& call) {
  if (running.stopper == nullptr || flag(call->params, "dry_run")) {
    return;
  }
  // [control] and [stop] may both have an answer: the first one counts.
  call->reply = [reply = std::move(call->reply),
                 answered = std::make_shared<std::atomic<bool>>(false)](server::Outcome outcome) {
    if (!answered->exchange(true)) {
      reply(std::move(outcome));
    }
  };
  // [stop] uses a copy of the call that no other thread changes.
  const std::shared_ptr<const Call> asked = std::make_shared<Call>(*call);
  call->order = std::make_shared<StopOrder>(
      names_in(call->params, "components"), [&running, asked] { return applies(running, *asked); },
      answering_directly(running, asked));
  running.stopper->watch(call->order);
}

void stop(Running& running, const CallPtr& call, Ticket /*none: it waits for no other change*/) {
  const bool ordered = call->order != nullptr && call->order->begin();
  auto over = until_over(running, call->order);
  if (auto met = ordered ? ok() : check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  const auto names = components_meant(running, *call, "stop", Away::too);
  if (!names) {
    return answer(running, *call, names.error());
  }
  const auto meant = sort(running, *names);
  if (flag(call->params, "dry_run")) {
    return answer(running, *call, planned(running, meant));
  }
  note_place_failures(running);
  if (call->order != nullptr) {
    call->order->found(running_of(meant));
  }
  for (const auto& name : *names) {
    ++running.stops[name];
    auto& came = running.stops_came[name];
    came = std::max(came, call->received);
  }
  const auto by = stop_by(*call);
  auto stopping = flag(call->params, "all")
                      ? Result<std::shared_ptr<Ongoing>>(running.deployer.begin_stop_all(2s, by))
                      : running.deployer.begin_stop(*names, by);
  if (!stopping) {
    return answer(running, *call, stopping.error());
  }
  call->saved_stop = save_stops(running);
  if (running.store != nullptr) {
    running.store->stops().served(call->stage);
  }
  when_answered(running, call, *std::move(stopping),
                [&running, call, over, meant](Ongoing& done) mutable {
                  const auto receipt = done.result();
                  over.reset();  // [stop] does not watch it while it waits for the disk
                  if (!receipt) {
                    return answer(running, *call, receipt.error(), "safe");
                  }
                  auto result = answer_to_stop(*call, *receipt);
                  if (!result.contains("directly")) {
                    say_already(meant.stopped, "stopped", result);
                  }
                  say_notes(meant.away, result);
                  if (flag(result, "changed")) {
                    say_lines(meant.lines, result);
                  }
                  answer(running, *call, std::move(result));
                });
}

}  // namespace mauve::daemon
