// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/change.h"

#include <algorithm>
#include <optional>

#include "commands/answer.h"

namespace mauve::daemon {

namespace {

/// Everything one change needs on its way between the threads. It is created on [control] and goes
/// away on [factory], since freeing elements runs user code.
struct Journey {
  Change change;
  std::uint64_t stops = 0;  ///< of its components, when it began
  std::optional<Result<PreparedChange>> prepared;
  std::optional<Retired> retired{std::in_place};
  Status exchanged;
};
using JourneyPtr = std::shared_ptr<Journey>;

/// [control] Nothing of the journey is touched on this thread afterwards.
void free_in_factory(Running& running, JourneyPtr journey, Ticket ticket) {
  running.control.in_factory(
      [&running, journey = std::move(journey)] {
        auto cleaned = journey->retired->release();
        journey->prepared.reset();
        if (!cleaned) {
          running.log.write(logging::Event::clean_up_failed,
                            {{"component", cleaned.error().at}, {"text", cleaned.error().message}});
        }
      },
      [ticket = std::move(ticket)] {});
}

void finish(Running& running, const Call& call, const Committed& done) {
  if (!done.receipt) {
    return answer(running, call, done.receipt.error(), done.state);
  }
  answer(running, call, to_json(*done.receipt));
}

std::uint64_t stops_of(Running& running, const Change& change) {
  std::uint64_t stops = 0;
  for (const auto& edit : change.edits) {
    stops += running.stops[edit.component];
  }
  return stops;
}

bool starts_something(const Change& change) {
  return std::any_of(change.edits.begin(), change.edits.end(),
                     [](const Edit& edit) { return edit.mode == Mode::run; });
}

Error stopped_meanwhile(const Journey& journey) {
  return refuse(Errc::conflict, journey.change.edits[0].component,
                "was stopped by request while this change was prepared", "start it again");
}

/// [control] False when the change was given up before anything happened.
bool may_go_on(Running& running, const Call& call, const Journey& journey) {
  if (!*journey.prepared) {
    answer(running, call, journey.prepared->error());
    return false;
  }
  auto met = check_conditions(running, call);
  if (met && starts_something(journey.change) &&
      stops_of(running, journey.change) != journey.stops) {
    met = stopped_meanwhile(journey);
  }
  if (!met) {
    answer(running, call, met.error());
  }
  return met.has_value();
}

void resume_in_place(Running& running, const CallPtr& call, const JourneyPtr& journey) {
  auto& change = **journey->prepared;
  if (stops_of(running, journey->change) != journey->stops) {
    // The new core takes its place, but the component stays where the stop put it.
    auto done = journey->exchanged ? commit(running, change, *journey->retired)
                                   : Committed{journey->exchanged.error(), "safe"};
    return finish(running, *call, done);
  }
  auto receipt = running.deployer.in_place_resume(change, journey->exchanged, *journey->retired);
  running.generation = running.deployer.generation();
  const bool back = !receipt && running.deployer.status(journey->change.edits[0].component).state ==
                                    ComponentState::running;
  finish(running, *call, {std::move(receipt), back ? "rolled_back" : "safe"});
}

}  // namespace

Committed commit(Running& running, PreparedChange& change, Retired& retired) {
  auto receipt = running.deployer.commit(change, retired);
  running.generation = running.deployer.generation();
  if (!receipt && receipt.error().code == Errc::partly) return {std::move(receipt), "partly"};
  return {std::move(receipt)};
}

void apply(Running& running, const CallPtr& call, Ticket ticket, Change change) {
  auto journey = std::make_shared<Journey>();
  journey->change = std::move(change);
  journey->stops = stops_of(running, journey->change);
  running.control.in_factory(
      [&running, journey] { journey->prepared = running.deployer.prepare(journey->change); },
      [&running, call, journey, ticket = std::move(ticket)]() mutable {
        if (may_go_on(running, *call, *journey)) {
          finish(running, *call, commit(running, **journey->prepared, *journey->retired));
        }
        free_in_factory(running, std::move(journey), std::move(ticket));
      });
}

void apply_in_place(Running& running, const CallPtr& call, Ticket ticket, Edit edit) {
  auto journey = std::make_shared<Journey>();
  journey->change.edits.push_back(std::move(edit));
  journey->stops = stops_of(running, journey->change);
  const auto exchange = [&running, journey] {
    journey->exchanged = running.deployer.in_place_exchange(**journey->prepared);
  };
  const auto resume = [&running, call, journey](Ticket held) {
    resume_in_place(running, call, journey);
    free_in_factory(running, journey, std::move(held));
  };
  running.control.in_factory(
      [&running, journey] {
        journey->prepared = running.deployer.prepare_in_place(journey->change.edits[0]);
      },
      [&running, call, journey, exchange, resume, ticket = std::move(ticket)]() mutable {
        auto go_on = may_go_on(running, *call, *journey);
        if (go_on) {
          auto parked = running.deployer.in_place_park(**journey->prepared);
          running.generation = running.deployer.generation();
          if (!parked) {
            answer(running, *call, parked.error());
            go_on = false;
          }
        }
        if (!go_on) {
          return free_in_factory(running, journey, std::move(ticket));
        }
        running.control.in_factory(exchange, [resume, ticket = std::move(ticket)]() mutable {
          resume(std::move(ticket));
        });
      });
}

Edit edit_of(std::string_view component) {
  Edit edit;
  edit.component = component;
  return edit;
}

Result<StatePolicy> state_policy(const Json& params) {
  const auto text = text_or(params, "state");
  if (text.empty()) {
    return StatePolicy::keep;
  }
  if (text == "drop") {
    return StatePolicy::drop;
  }
  return refuse(Errc::invalid_value, "state",
                "'" + text.substr(0, 64) + "' is no way to treat state",
                "leave it out to hand the state over, or say drop");
}

}  // namespace mauve::daemon
