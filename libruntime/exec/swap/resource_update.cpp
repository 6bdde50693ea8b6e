// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/swap/resource_update.h"

#include "base/thread_role.h"

#include "exec/task/write_quietly.h"

#include <mauve/host/clock.h>
#include <mauve/host/resource.h>
#include <mauve/observable.h>

namespace mauve::exec {
namespace {

std::vector<std::pair<const PortBase*, const Binding*>> lost_connections(
    const ResourceBase& resource, const Bindings* next) {
  std::vector<std::pair<const PortBase*, const Binding*>> lost;
  if (next == nullptr) return lost;
  for (const PortBase* port : resource.shell().ports()) {
    const auto& before = resource.bindings()[port->index()];
    const auto& after = (*next)[port->index()];
    if (before == nullptr || before == after || goes_on_at_replacement(*before, after.get()))
      continue;
    lost.emplace_back(port, before.get());
  }
  return lost;
}

}  // namespace

ResourceUpdate::ResourceUpdate(ResourceBase& resource, ResourceParts parts, StatePolicy state,
                               Decision& decision)
    : resource_(resource),
      parts_(std::move(parts)),
      replaced_{parts_.core != nullptr ? resource.shared_core() : nullptr,
                parts_.bindings != nullptr ? resource.shared_bindings() : nullptr},
      decision_(decision),
      safe_writes_(lost_connections(resource, parts_.bindings.get())) {
  if (parts_.core != nullptr) {
    // Refused only on the rollback to a core that cannot take the state of a later one: it goes on
    // from the value it had.
    const auto plan = plan_hand_over(*replaced_.core, *parts_.core, state);
    if (plan) hand_over_ = *plan;
    for (ObservableBase* observable : parts_.core->observables()) {
      const ObservableBase* same = replaced_.core->find_observable(observable->name());
      const bool goes_on = same != nullptr && same_type(same->type(), observable->type());
      if (goes_on) observables_.emplace_back(observable, same);
    }
  }
  resource_.lock().defer(*this);
}

ResourceUpdate::~ResourceUpdate() = default;

bool ResourceUpdate::apply(Instant release) {
  if (state() == State::in_force || state() == State::dropped) return true;
  if (release == 0) return false;
  // The coordinator is late: the first caller at the instant aborts the change for all.
  const Decision::Verdict verdict = decision_.at_boundary(release);
  if (verdict == Decision::Verdict::not_yet) return false;
  const bool aborted = verdict == Decision::Verdict::aborted;
  State expected = State::waiting;
  const State wanted = aborted ? State::dropped : State::taking;
  if (!state_.compare_exchange_strong(expected, wanted, std::memory_order_acq_rel)) return true;
  if (!aborted) take();
  return true;
}

/// Applies the update. Under the lock.
void ResourceUpdate::take() {
  const Instant begin = MonotonicClock().now();
  for (const auto& [port, before] : safe_writes_) write_quietly(*port, *before, true);
  if (!resource_.lock().poisoned()) {  // else it may be half written: the new core begins anew
    converting_.store(true);
    const bool failed = hand_over_.run().happened();
    if (!converting_.exchange(false))
      return;  // its thread was abandoned: see finish_for_abandoned()
    failed_ = failed;
    bytes_ = failed ? 0 : hand_over_.bytes;
  }
  for (const auto& [into, from] : observables_) into->continue_from(*from);
  switch_callers();
  pause_ = Duration{MonotonicClock().now() - begin};
  state_.store(State::in_force, std::memory_order_release);
}

/// Users must not see half a state: the resource refuses them, as after a caller crashed in it.
void ResourceUpdate::switch_callers() {
  resource_.switch_to(parts_.core, parts_.bindings);
  if (failed_) resource_.lock().poison();
  if (parts_.core != nullptr) resource_.lock().forget_times();
}

/// A caller never returned from the converter; the guard took its lock away and poisoned the
/// resource.
void ResourceUpdate::finish_for_abandoned() {
  if (state() != State::taking || !resource_.lock().poisoned()) return;
  if (!converting_.exchange(false)) return;
  failed_ = lost_ = true;
  switch_callers();
  state_.store(State::in_force, std::memory_order_release);
}

void ResourceUpdate::help(Instant now) {
  MAUVE_ON_THREAD(control);
  finish_for_abandoned();
  if (state() != State::waiting) return;
  if (decision_.is_final_abort()) return revoke();
  if (decision_.state() != Decision::State::committed || now < decision_.instant()) return;
  if (!resource_.lock().try_enter()) return;
  static_cast<void>(apply(now));
  resource_.lock().forget(*this);
  resource_.lock().leave();
}

void ResourceUpdate::revoke() {
  MAUVE_ON_THREAD(control);
  State expected = State::waiting;
  state_.compare_exchange_strong(expected, State::dropped, std::memory_order_acq_rel);
}

bool ResourceUpdate::disarm() {
  MAUVE_ON_THREAD(control);
  if (!armed_) return true;
  resource_.lock().forget(*this);
  if (!resource_.lock().try_enter()) return false;
  resource_.lock().leave();
  armed_ = false;
  return true;
}

}  // namespace mauve::exec
