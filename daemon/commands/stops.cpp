// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/stops.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "base/thread_role.h"
#include "commands/model.h"
#include "commands/say.h"
#include "mauve/host/architecture.h"
#include "state/state_store.h"

namespace mauve::daemon {

namespace {

constexpr const char* kNotSaved =
    "the stop is carried out and stands while mauved runs, but it is not saved: after a crash the "
    "list of stops before it holds; free the disk, then stop again";

/// Nothing but its mode was to be changed, and that stays.
bool does_nothing(const Edit& edit) {
  return edit.mode == Mode::keep && !edit.core && !edit.fsm && !edit.type && !edit.resource &&
         edit.properties.empty() && edit.connect.empty() && edit.disconnect.empty() && !edit.task &&
         !edit.lock_budget;
}

}  // namespace

bool SavedStop::over() const {
  return state_ != State::waits || std::chrono::steady_clock::now() > until_;
}

void SavedStop::say(server::Outcome& outcome) const {
  const bool saved = state_ == State::saved;
  if (auto* result = std::get_if<Json>(&outcome)) {
    (*result)["saved"] = saved;
    if (!saved) {
      (*result)["notes"].push_back(kNotSaved);
    }
  } else if (auto* fault = std::get_if<Fault>(&outcome); fault != nullptr && !saved) {
    fault->message += std::string("; ") + kNotSaved;
  }
}

UserStop stop_by(const Call& call) {
  return {call.caller.peer.uid, logging::utc(std::chrono::system_clock::now()), 0};
}

void write_first(StateStore& store) {
  store.disk().post_first([&store] { static_cast<void>(store.stops().write()); });
}

std::shared_ptr<SavedStop> save_stops(const Running& running) {
  MAUVE_ON_THREAD(control);
  if (running.store == nullptr || running.user_stops == nullptr) {
    return nullptr;
  }
  auto saved = std::make_shared<SavedStop>();
  running.store->stops().keep(*running.user_stops, [saved](bool done) { saved->done(done); });
  write_first(*running.store);
  return saved;
}

std::shared_ptr<SavedStop> save_stop_directly(const Running& running, const Call& call,
                                              const std::vector<std::string>& components) {
  if (running.store == nullptr) {
    return nullptr;
  }
  auto saved = std::make_shared<SavedStop>();
  running.store->stops().keep_directly(call.stage, components, stop_by(call),
                                       [saved](bool done) { saved->done(done); });
  write_first(*running.store);
  return saved;
}

void reply_when_saved(Running& running, const Call& call, server::Outcome outcome) {
  MAUVE_ON_THREAD(control);
  const auto saved = call.saved_stop;
  if (saved == nullptr) {
    return call.reply(std::move(outcome));
  }
  running.control.await([saved] { return saved->over(); },
                        [saved, reply = call.reply, outcome = std::move(outcome)]() mutable {
                          saved->say(outcome);
                          reply(std::move(outcome));
                        });
}

std::string in_words(const UserStop& stop) {
  if (!stop.cause.empty()) {
    return "mauved stopped it at " + stop.time + ": " + stop.cause;
  }
  return "uid " + std::to_string(stop.uid) + " stopped it at " + stop.time;
}

const UserStop* stop_of(const Running& running, const std::string& component) {
  return running.user_stops == nullptr ? nullptr : running.user_stops->of(component);
}

std::string note_on(const std::string& component, const UserStop& stop) {
  return component + " stays stopped: " + in_words(stop) + "; mauvectl start " + component +
         " starts it";
}

std::vector<std::string> leave_stopped(const Running& running, Change& change) {
  MAUVE_ON_THREAD(control);
  std::vector<std::string> notes;
  if (running.user_stops == nullptr || change.ends_stops) {
    return notes;
  }
  for (auto& edit : change.edits) {
    const auto* stop = running.user_stops->of(edit.member);
    if (edit.mode == Mode::run && stop != nullptr) {
      edit.mode = Mode::keep;
      notes.push_back(note_on(edit.member, *stop));
    }
  }
  if (!notes.empty()) {
    std::erase_if(change.edits, does_nothing);
  }
  return notes;
}

std::vector<std::string> leave_stopped(const UserStops& stops, Architecture& architecture) {
  std::vector<std::string> names;
  for (auto* component : architecture.components()) {
    if (component->task().start && stops.of(component->name()) != nullptr) {
      component->task().start = false;
      names.push_back(component->name());
    }
  }
  return names;
}

void leave_stopped(const Running& running, Json& plan) {
  MAUVE_ON_THREAD(control);
  const auto lines = plan.find("lines");
  if (running.user_stops == nullptr || lines == plan.end() || !lines->is_array()) {
    return;
  }
  Json kept = Json::array();
  for (const auto& line : *lines) {
    const auto address = line.value("address", "");
    const auto name = address.substr(0, address.find('.'));
    const auto* stop = running.user_stops->of(name);
    const bool starts = line.value("kind", "") == "start" && line.value("new", Json()) == true;
    if (starts && stop != nullptr) {
      plan["notes"].push_back(note_on(name, *stop));
    } else {
      kept.push_back(line);
    }
  }
  plan["same"] = kept.empty();
  plan["lines"] = std::move(kept);
}

}  // namespace mauve::daemon
