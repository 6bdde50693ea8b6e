// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/recovery/nothing_to_undo.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include "mauve/host/architecture.h"
#include "state/builds.h"
#include "state/state_store.h"

namespace mauve::daemon {

namespace {

constexpr std::string_view kReload = "plugin.reload";

/// The generation before the one that runs, or before the stops that made it, if it is saved; 0:
/// there is none. One that was rolled back is not meant, and neither is one before a reload: a
/// generation has no code.
std::uint64_t saved_before(const Running& running) {
  if (running.store == nullptr || running.author.command == kReload) {
    return 0;
  }
  const auto now = running.deployer.generation();
  const auto before = std::min(running.deployer.generation(/*before_stops=*/true), now - 1);
  const auto mark = running.store->generations().mark_of(before);
  return mark && *mark != Confirmation::rolled_back ? before : 0;
}

/// A reload changes code only, which no rollback brings back.
std::string step_after_reload(const Running& running) {
  const auto all =
      running.store == nullptr ? std::vector<Generation>() : running.store->generations().list();
  const auto before = std::ranges::find_if(all, [&](const Generation& saved) {  // the newest first
    return !saved.damaged && saved.number < running.deployer.generation();
  });
  const auto others =
      before == all.end() ? OtherBuilds() : other_builds(before->builds, running.catalog);
  return others.empty() ? "install the older build, then reload it; the newest change is " +
                              running.author.changes
                        : remedy_of(others.front()) + "; a rollback brings no code back";
}

/// The way back from the newest change where `undo` has none.
std::string step_without_undo(const Running& running) {
  const auto& newest = running.author;
  const bool is_newest = newest.generation == running.deployer.generation();
  if (!is_newest || newest.changes.empty() || newest.command == "change.undo") {
    return running.store == nullptr ? "mauvectl logs shows the changes"
                                    : "mauvectl history shows the saved generations, to which "
                                      "mauvectl rollback N goes back";
  }
  if (const auto before = saved_before(running); before != 0) {
    return "mauvectl rollback " + std::to_string(before) + ": to before the newest change (" +
           newest.changes + ")";
  }
  if (newest.command == kReload) {
    return step_after_reload(running);
  }
  return "set the old value, or make the opposite change; the newest change is " + newest.changes;
}

/// "was undone already by uid 1000: too loud", "was rolled back already: control threw: sensor
/// lost"; empty: it was not, as far as is known.
std::string already_undone(const Running& running, std::uint64_t generation) {
  if (const auto* rollback = running.rollbacks.of(generation)) {
    if (!rollback->by) {
      return "was rolled back already: " + rollback->cause;
    }
    const auto& [uid, reason] = *rollback->by;
    return "was undone already by uid " + std::to_string(uid) +
           (reason.empty() ? "" : ": " + reason);
  }
  if (is_rolling_back(running, generation)) {
    return "is being rolled back already";
  }
  const bool is_marked = running.store != nullptr && running.store->generations().mark_of(
                                                         generation) == Confirmation::rolled_back;
  return is_marked ? "was rolled back already" : "";
}

}  // namespace

bool is_rolling_back(const Running& running, std::uint64_t generation) {
  MAUVE_ON_THREAD(control);
  const auto in_place = std::ranges::any_of(running.places, [&](const PlaceProbation& place) {
    return place.rolls_back && place.generation == generation;
  });
  return in_place ||
         std::ranges::any_of(running.deployer.probations(), [&](const OpenProbation& open) {
           return open.rolls_back &&
                  std::ranges::find(open.generations, generation) != open.generations.end();
         });
}

Error nothing_to_undo(const Running& running, std::uint64_t generation) {
  MAUVE_ON_THREAD(control);
  auto refused = refuse({Errc::wrong_state, "nothing_to_undo"}, {},
                        "generation " + std::to_string(generation) +
                            " is not on probation, so there is nothing to undo");
  if (generation == 0) {
    refused.message = "no change is on probation, so there is nothing to undo";
    refused.hint = step_without_undo(running);
    return refused;
  }
  if (const auto undone = already_undone(running, generation); !undone.empty()) {
    refused.message = "generation " + std::to_string(generation) + " " + undone;
    refused.hint =
        running.store == nullptr ? "mauvectl logs shows it" : "mauvectl history shows it";
    return refused;
  }
  if (generation > running.deployer.generation()) {
    refused.message = "there is no generation " + std::to_string(generation) + " yet";
  }
  refused.hint =
      "mauvectl status shows the changes on probation, and mauvectl rollback N goes back to a "
      "saved generation";
  return refused;
}

}  // namespace mauve::daemon
