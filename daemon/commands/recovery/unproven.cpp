// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/recovery/unproven.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include "mauve/host/architecture.h"
#include "state/recovery.h"
#include "state/state_store.h"

namespace mauve::daemon {

void begin_unproven(Running& running, Call& call, std::vector<FailureMark> changed) {
  MAUVE_ON_THREAD(control);
  call.mark = Confirmation::unconfirmed;
  running.unproven = {running.deployer.generation(), std::chrono::steady_clock::now(),
                      std::move(changed)};
}

void begin_start(Running& running, std::uint64_t replaces, unsigned crashes) {
  const auto now = std::chrono::steady_clock::now();
  running.started = {running.generation, now, crashes};
  running.unproven = {running.generation, now, {}, replaces};
  for (const auto* component : running.architecture.components()) {
    running.unproven.changed.push_back({component->name()});
  }
}

namespace {

/// A user who changed something and went back before the start was confirmed runs the start again.
void look_at_start(Running& running) {
  auto& started = running.started;
  const auto ran = std::chrono::steady_clock::now() - started.since;
  if (started.generation == 0) {
    return;
  }
  if (started.proves && ran >= Probation{}.time) {
    started.proves = false;
    if (started.generation != running.generation) {
      running.store->confirm_same(started.generation, running.generation);
    }
  }
  if (!started.long_ago && ran >= kSoon) {
    started.long_ago = true;
    running.store->ran_long();
    if (started.crashes > 0) {
      running.store->forget_crashes(started.generation);
    }
  }
}

/// It began to prove itself, and no later generation was confirmed.
bool is_pending(const Running& running) {
  return !running.proofs.is_confirmed(running.unproven.generation);
}

/// A change is on probation, or is being rolled back.
bool is_open(const Running& running) {
  return !running.places.empty() || !running.deployer.probations().empty();
}

/// A change under way may be in force before it is on probation.
bool is_proven(const Running& running) {
  return !is_open(running) && !is_pending(running) && !running.control.busy() &&
         running.proofs.all_decided() && running.deployer.generation() == running.generation;
}

}  // namespace

void look_at_unproven(Running& running) {
  MAUVE_ON_THREAD(control);
  look_at_start(running);
  const auto& unproven = running.unproven;
  if (unproven.generation == 0) {
    return;
  }
  const bool failed = std::ranges::any_of(
      unproven.changed, [&](const auto& mark) { return failure_since(running, mark).has_value(); });
  if (failed && unproven.since == running.started.since) {
    running.started.proves = false;
  }
  if (failed) {
    running.proofs.undecided(unproven.generation);
    running.unproven = {};
  } else if (!is_open(running) &&
             std::chrono::steady_clock::now() - unproven.since >= Probation{}.time) {
    static_cast<void>(confirm_unproven(running));
  }
}

void carry_unproven(Running& running, std::uint64_t generation) {
  MAUVE_ON_THREAD(control);
  const auto unproven = running.unproven.generation;
  const bool only_stopped = unproven >= running.deployer.generation(/*before_stops=*/true);
  if (unproven != 0 && (unproven + 1 == generation || only_stopped)) {
    running.unproven.generation = generation;
    running.unproven.replaces = 0;  // the copy is of another architecture
  }
}

bool confirm_unproven(Running& running) {
  MAUVE_ON_THREAD(control);
  const auto unproven = std::exchange(running.unproven, {});
  if (unproven.generation == 0 || unproven.generation != running.generation) {
    return false;
  }
  if (running.store != nullptr) {
    running.store->confirm_start(unproven.generation, unproven.replaces);
  }
  running.proofs.confirmed(unproven.generation);
  return true;
}

bool is_saved_unconfirmed(const Running& running) {
  return running.store != nullptr &&
         running.store->generations().mark_of(running.generation) == Confirmation::unconfirmed;
}

void account_proofs(Running& running, const Outcome& outcome) {
  MAUVE_ON_THREAD(control);
  auto& proofs = running.proofs;
  switch (outcome.kind) {
    case Outcome::Kind::passed:
      for (const auto generation : proofs.passed(outcome)) {
        if (generation != running.unproven.generation) {  // it holds new code without a probation
          running.store->mark(generation, Confirmation::confirmed);
          proofs.confirmed(generation);
        }
      }
      break;
    case Outcome::Kind::rolled_back:
      proofs.rolled_back(outcome);
      break;
    case Outcome::Kind::overtaken:  // it proved nothing, the newer one will
      proofs.undecided(outcome.generations.back());
      break;
    case Outcome::Kind::stays_failed:
      if (!outcome.generations.empty()) {  // else it ends no probation
        proofs.undecided(outcome.generation);
      }
      break;
    case Outcome::Kind::fell_back:
    case Outcome::Kind::restarted:
      proofs.undecided(outcome.generation);
      break;
  }
}

Confirmation mark_of_rollback(Running& running, const Outcome& outcome) {
  MAUVE_ON_THREAD(control);
  const bool proven = outcome.oldest_open == 0 && is_proven(running);
  if (!proven || outcome.generation != running.generation) {
    return Confirmation::unconfirmed;
  }
  running.proofs.confirmed(outcome.generation);
  return Confirmation::confirmed;
}

void confirm_proven(Running& running) {
  MAUVE_ON_THREAD(control);
  if (!is_saved_unconfirmed(running) || !is_proven(running)) {
    return;
  }
  running.report_outcomes();  // the look at the probations may have ended one
  if (is_proven(running)) {
    running.store->mark(running.generation, Confirmation::confirmed);
    running.proofs.confirmed(running.generation);
  }
}

}  // namespace mauve::daemon
