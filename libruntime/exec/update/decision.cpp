// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/update/decision.h"

#include "base/thread_role.h"
#include "rt/thread/crash_handler.h"

namespace mauve::exec {
namespace {

/// The rollback begins so much later, so that no member passes the instant unaware of it.
constexpr Duration kLeadOfRollback = 200us;
constexpr int kAttempts = 6;

}  // namespace

bool Rollback::trigger(const Clock& clock, std::string_view reason) {
  FaultRecord asked;
  asked.time = clock.now();
  copy_text(asked.text, reason);
  return trigger(clock, asked, nullptr);
}

bool Rollback::trigger(const Clock& clock, const FaultRecord& fault,
                       const TaskReport* failed_member) {
  if (rt::is_dying()) return false;
  if (!decision_.claim(kBeingTriggered)) return false;
  Decision* const newer = newer_.load();
  if (newer != nullptr && newer->decide(Decision::State::aborted) == Decision::State::committed) {
    decision_.put_off(kClosed);
    return false;
  }
  fault_ = fault;
  failed_member_ = failed_member;
  decide(clock);
  decided_.store(true, std::memory_order_release);
  return true;
}

/// The deciding thread may be preempted at any point, until the instant has passed.
void Rollback::decide(const Clock& clock) {
  Duration lead = kLeadOfRollback;
  for (int attempt = 0; attempt < kAttempts; ++attempt, lead *= 2) {
    const Instant instant = clock.now() + lead.count();
    decision_.attempt(instant);
    const bool late = clock.now() >= instant - kDecisionMargin.count();
    const auto wanted = late ? Decision::State::aborted : Decision::State::committed;
    if (decision_.decide(wanted) == Decision::State::committed) return;
    decision_.put_off(kBeingTriggered);
  }
  // The attempts have to end: this one cannot be aborted. A member that passes the instant between
  // the two calls goes back one job later.
  decision_.attempt(kBeingTriggered, Decision::State::committed);
  decision_.put_off(clock.now() + lead.count());
}

void Rollback::give_way_to(std::shared_ptr<Decision> newer) {
  MAUVE_ON_THREAD(control);
  newer_.store(newer.get());
  if (newer != nullptr) all_newer_.push_back(std::move(newer));
}

}  // namespace mauve::exec
