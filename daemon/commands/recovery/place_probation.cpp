// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/recovery/place_probation.h"
#include "commands/recovery/former.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include "commands/change/change.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "exec/recovery/incident.h"
#include "exec/system/prepared.h"
#include "exec/update/fault_record.h"
#include "mauve/host/architecture.h"
#include "mauve/host/clock.h"
#include "mauve/shell.h"

namespace mauve::daemon {

namespace {

/// The core before takes over again. Created on [control], freed on [factory].
struct RollbackInPlace {
  PlaceProbation place;  ///< with its failure
  bool starts = true;    ///< false: the component did not run before the swap, nor since
  std::optional<Result<PreparedChange>> prepared;
  Status exchanged;
  Retired retired;
};
using RollbackPtr = std::shared_ptr<RollbackInPlace>;

std::uint64_t stops_of_component(const Running& running, const std::string& component) {
  const auto found = running.stops.find(component);
  return found == running.stops.end() ? 0 : found->second;
}

Outcome outcome_of(const Running& running, const PlaceProbation& place, Outcome::Kind kind,
                   std::string reason) {
  Outcome outcome;
  outcome.kind = kind;
  outcome.began = place.generation;
  outcome.generations = {place.generation};
  outcome.generation = running.deployer.generation();
  outcome.reason = std::move(reason);
  for (const auto& open : running.deployer.probations()) {
    const auto first = open.generations.front();
    outcome.oldest_open = outcome.oldest_open == 0 ? first : std::min(outcome.oldest_open, first);
  }
  for (const auto& other : running.places) {
    const auto first = other.generation;
    if (first != place.generation && (outcome.oldest_open == 0 || first < outcome.oldest_open)) {
      outcome.oldest_open = first;
    }
  }
  return outcome;
}

/// The component did not run before the swap, it is faulted, and it was not started since.
bool is_at_rest(const Running& running, const PlaceProbation& place) {
  const auto status = running.deployer.status(place.component);
  return status.state == ComponentState::faulted && !place.before.ran &&
         status.releases == place.releases;
}

/// Elements are freed on [factory], since their destructors are user code.
void free_in_factory(Running& running, RollbackPtr way, Ticket ticket) {
  running.control.in_factory(
      [&running, way = std::move(way)]() mutable {
        clean_up(running, way->retired);
        way.reset();
      },
      [ticket = std::move(ticket)] {});
}

void free_bundles(Running& running, PlaceProbation place) {
  auto kept = std::make_shared<PlaceProbation>(std::move(place));
  running.control.in_factory([kept = std::move(kept)]() mutable { kept.reset(); }, [] {});
}

void conclude(Running& running, const PlaceProbation& place, const Status& done) {
  const auto& failure = *place.failure;
  auto outcome = outcome_of(running, place, Outcome::Kind::rolled_back, failure.reason);
  outcome.incident = failure.incident;
  outcome.component = failure.incident ? place.component : std::string();
  const bool own_fault = failure.incident && failure.incident->resource.empty();
  if (own_fault && exec::is_other_code(*place.before.bundle->core, *place.now->core)) {
    outcome.cores.push_back(place.now->core_type.name);
  }
  if (!done) {
    outcome.kind = Outcome::Kind::stays_failed;
    outcome.component = place.component;
    outcome.reason =
        failure.reason + "; the core before could not take over again: " + to_string(done.error());
  }
  std::erase_if(running.places,
                [&](const auto& one) { return one.generation == place.generation; });
  running.settle(outcome);
}

void end(Running& running, RollbackPtr way, Ticket ticket, const Status& done) {
  conclude(running, way->place, done);
  free_in_factory(running, std::move(way), std::move(ticket));
}

/// A hook did not return. Its thread goes on with the rollback, which is its own from now on.
void abandon(Running& running, const PlaceProbation& place, const std::string& hook) {
  const auto& name = place.component;
  note_abandoned_in(running, {name}, hook, true);
  conclude(
      running, place,
      thread_abandoned(running, hook, name, name + " is stopped with its safe values written"));
  free_bundles(running, place);
}

void resume(Running& running, RollbackPtr way, Ticket ticket) {
  const FromLookToAct still(running);
  auto& change = **way->prepared;
  const auto& place = way->place;
  if (!way->starts || stops_of_component(running, place.component) != place.failure->stops) {
    change.content().members.front().resume = false;  // the rollback starts no component at rest
  }
  auto resumed = running.deployer.begin_in_place_resume(change, way->exchanged);
  if (!resumed) {
    return end(running, std::move(way), std::move(ticket), resumed.error());
  }
  when_answered(running, *std::move(resumed),
                [&running, way, ticket = std::move(ticket)](Ongoing& done) mutable {
                  const auto receipt = done.result();
                  way->retired = std::move(done.retired());
                  end(running, std::move(way), std::move(ticket),
                      receipt ? ok() : Status(receipt.error()));
                });
}

void exchange(Running& running, RollbackPtr way, Ticket ticket) {
  running.control.in_factory(
      [&running, way] { way->exchanged = running.deployer.in_place_exchange(**way->prepared); },
      [&running, way, ticket]() mutable { resume(running, std::move(way), std::move(ticket)); },
      [&running, place = way->place, ticket](const std::string& hook) {
        abandon(running, place, hook);
      });
}

void park(Running& running, RollbackPtr way, Ticket ticket) {
  if (!*way->prepared) {
    const Status refused = way->prepared->error();
    return end(running, std::move(way), std::move(ticket), refused);
  }
  const FromLookToAct still(running);
  way->starts = !is_at_rest(running, way->place);
  auto parking = running.deployer.begin_in_place_park(**way->prepared);
  when_answered(running, std::move(parking),
                [&running, way, ticket = std::move(ticket)](Ongoing& done) mutable {
                  if (const auto parked = done.result(); !parked) {
                    return end(running, std::move(way), std::move(ticket), parked.error());
                  }
                  exchange(running, std::move(way), std::move(ticket));
                });
}

/// A change like any other, so that no two prepare at the same time. False: one is under way.
bool roll_back(Running& running, PlaceProbation& place, const PlaceFailure& why) {
  if (running.control.busy()) {
    return false;
  }
  auto way = std::make_shared<RollbackInPlace>();
  way->place = place;
  way->place.failure = why;
  place.rolls_back = running.control.change([&running, way](Ticket ticket) {
    running.control.works_for(std::nullopt);
    running.control.in_factory(
        [&running, way] {
          const auto& from = way->place;
          way->prepared = running.deployer.prepare_back_in_place(from.component, from.before.bundle,
                                                                 from.before.type);
        },
        [&running, way, ticket]() mutable { park(running, std::move(way), std::move(ticket)); },
        [&running, place = way->place, ticket](const std::string& hook) {
          abandon(running, place, hook);
        });
  });
  return place.rolls_back;
}

/// The result of a look: a failure, its end, or neither yet.
struct Verdict {
  std::optional<Outcome::Kind> kind = std::nullopt;
  std::string reason = {};
  std::optional<Incident> incident = std::nullopt;
};

/// A value of the new core that a port did not let out, told as a failure of the core.
std::optional<Incident> implausible_since(const ComponentBase& component,
                                          const ComponentStatus& status, const FailureMark& mark) {
  const auto before = status.implausible < mark.implausible ? 0 : mark.implausible;  // new ports: 0
  if (status.implausible == before || mark.hands_over_implausible) {
    return std::nullopt;
  }
  const auto& ports = component.shell().ports();
  const auto port = std::ranges::find_if(
      ports, [](const PortBase* one) { return one->implausible().of_core > 0; });
  return Incident{MonotonicClock().now(),
                  std::string(to_string(exec::Cause::implausible)),
                  std::string(port == ports.end() ? "" : (*port)->name()),
                  status.core,
                  status.fsm_state,
                  status.releases,
                  {}};
}

Verdict judge(const Running& running, const PlaceProbation& place) {
  const auto* component = running.architecture.find_component(place.component);
  if (component == nullptr || component->bundle() != place.now) {
    return {Outcome::Kind::overtaken, "a newer change", std::nullopt};
  }
  const auto status = running.deployer.status(place.component);
  if (const auto failure = failure_since(running, place.before.failure)) {
    return {Outcome::Kind::rolled_back, to_string(*failure), failure};
  }
  if (const auto refused = implausible_since(*component, status, place.before.failure)) {
    return {Outcome::Kind::rolled_back, to_string(*refused), refused};
  }
  const Duration passed = std::chrono::steady_clock::now() - place.since;
  if (place.rules.confirm_within > Duration{0}) {
    const bool late = passed >= place.rules.confirm_within;
    return late ? Verdict{Outcome::Kind::rolled_back, "not confirmed within its time", std::nullopt}
                : Verdict{};
  }
  const auto over = exec::over_budget_in_words(status.over_present_budget, place.component);
  if (status.releases - place.releases >= place.rules.activations) {
    return {Outcome::Kind::passed,
            std::to_string(place.rules.activations) + " jobs without a fault" + over, std::nullopt};
  }
  return passed >= place.rules.time
             ? Verdict{Outcome::Kind::passed, "its time passed without a fault" + over,
                       std::nullopt}
             : Verdict{};
}

/// The first failure counts. The rollback waits while another change is being prepared, and a stop
/// or a start in that time would hide the failure.
void note_failure(const Running& running, PlaceProbation& place, const Verdict& verdict) {
  if (place.failure || verdict.kind != Outcome::Kind::rolled_back) {
    return;
  }
  place.failure = {verdict.reason, verdict.incident, stops_of_component(running, place.component)};
}

void settle(Running& running, std::size_t index, Outcome::Kind kind, const std::string& reason) {
  auto place = std::move(running.places[index]);
  running.places.erase(running.places.begin() + static_cast<std::ptrdiff_t>(index));
  running.settle(outcome_of(running, place, kind, reason));
  free_bundles(running, std::move(place));
}

}  // namespace

FailureMark mark_failure(const Running& running, const std::string& component) {
  const auto failure = failure_since(running, {component});
  const auto status = running.deployer.status(component);
  return {component, failure ? std::optional(failure->time) : std::nullopt, status.implausible,
          status.implausible_of_core > 0};
}

std::optional<Incident> failure_since(const Running& running, const FailureMark& mark) {
  MAUVE_ON_THREAD(control);
  auto incident = running.deployer.status(mark.component).incident;
  return incident && incident->time != mark.before ? std::move(incident) : std::nullopt;
}

void begin_place_probation(Running& running, Call& call, std::uint64_t generation,
                           const std::string& component, CoreBefore before,
                           const Probation& rules) {
  MAUVE_ON_THREAD(control);
  call.mark = Confirmation::unconfirmed;
  const auto* found = running.architecture.find_component(component);
  if (found == nullptr) {
    return;
  }
  running.places.push_back({generation, component, rules, std::chrono::steady_clock::now(),
                            running.deployer.status(component).releases, std::move(before),
                            found->bundle()});
}

void look_at_places(Running& running) {
  MAUVE_ON_THREAD(control);
  for (std::size_t i = 0; i < running.places.size();) {
    auto& place = running.places[i];
    const auto verdict = place.rolls_back ? Verdict{} : judge(running, place);
    note_failure(running, place, verdict);
    if (verdict.kind && (!place.failure || verdict.kind == Outcome::Kind::overtaken)) {
      settle(running, i, *verdict.kind, verdict.reason);
      continue;
    }
    if (place.failure && !place.rolls_back) {
      static_cast<void>(roll_back(running, place, *place.failure));
    }
    ++i;
  }
}

void note_place_failures(Running& running) {
  MAUVE_ON_THREAD(control);
  for (auto& place : running.places) {
    note_failure(running, place, place.rolls_back ? Verdict{} : judge(running, place));
  }
}

bool confirm_places(Running& running) {
  MAUVE_ON_THREAD(control);
  note_place_failures(running);
  bool any = false;
  for (std::size_t i = 0; i < running.places.size();) {
    if (running.places[i].rolls_back || running.places[i].failure) {
      ++i;
      continue;
    }
    settle(running, i, Outcome::Kind::passed, "confirmed");
    any = true;
  }
  return any;
}

std::optional<PlaceTarget> newest_place(const Running& running, std::uint64_t than,
                                        std::uint64_t generation) {
  MAUVE_ON_THREAD(control);
  const auto newest =
      generation == 0 ? std::ranges::max_element(running.places, {}, &PlaceProbation::generation)
                      : std::ranges::find(running.places, generation, &PlaceProbation::generation);
  if (newest == running.places.end() || newest->generation < than) {
    return std::nullopt;
  }
  return PlaceTarget{newest->generation, newest->component, newest->before.bundle};
}

Status undo_place(Running& running, const PlaceTarget& target, const std::string& reason) {
  MAUVE_ON_THREAD(control);
  const auto found =
      std::ranges::find(running.places, target.generation, &PlaceProbation::generation);
  const PlaceFailure undone{reason, std::nullopt, stops_of_component(running, target.component)};
  if (roll_back(running, *found, found->failure.value_or(undone))) {
    return ok();
  }
  return refuse({Errc::conflict, "change_under_way_elsewhere"}, target.component,
                "another change is being prepared, so the core before cannot be configured now",
                "mauvectl undo again when that change has ended");
}

Status is_back(const Running& running, const PlaceTarget& target) {
  MAUVE_ON_THREAD(control);
  const auto* component = running.architecture.find_component(target.component);
  const auto now = component == nullptr ? nullptr : component->bundle();
  if (now != nullptr && !target.before.owner_before(now) && !now.owner_before(target.before)) {
    return ok();
  }
  return refuse({Errc::partly, "undo_in_place_failed"}, target.component,
                "the core before could not take over again; the component is " +
                    std::string(to_string(running.deployer.status(target.component).state)) +
                    " and its outputs have their safe values",
                "mauvectl why " + target.component);
}

bool places_roll_back(const Running& running) {
  MAUVE_ON_THREAD(control);
  return std::ranges::any_of(running.places, &PlaceProbation::rolls_back);
}

bool is_place(const Running& running, const std::string& component) {
  MAUVE_ON_THREAD(control);
  return std::ranges::any_of(running.places,
                             [&](const auto& one) { return one.component == component; });
}

std::uint64_t oldest_place(const Running& running) {
  MAUVE_ON_THREAD(control);
  std::uint64_t oldest = 0;
  for (const auto& place : running.places) {
    oldest = oldest == 0 ? place.generation : std::min(oldest, place.generation);
  }
  return oldest;
}

std::vector<std::string> place_notes(const Running& running, const Change& change) {
  MAUVE_ON_THREAD(control);
  std::vector<std::string> notes;
  for (const auto& place : running.places) {
    const bool changed = std::ranges::any_of(
        change.edits, [&](const Edit& edit) { return edit.member == place.component; });
    if (changed && !place.rolls_back) {
      notes.push_back("the probation of generation " + std::to_string(place.generation) + " (" +
                      place.component +
                      ", swapped in place) ends early: nothing rolls back to the core before it");
    }
  }
  return notes;
}

}  // namespace mauve::daemon
