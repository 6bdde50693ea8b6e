// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/transaction.h"

namespace mauve::exec {
namespace {

/// The way back begins so much later, so that no member passes the instant unaware of it.
constexpr Duration kLeadOfWayBack = 200us;
constexpr int kAttempts = 6;

}  // namespace

bool WayBack::set_off(const Clock& clock, std::string_view reason) {
  FaultRecord asked;
  asked.time = clock.now();
  copy_text(asked.text, reason);
  return set_off(clock, asked, nullptr);
}

bool WayBack::set_off(const Clock& clock, const FaultRecord& fault, const void* member) {
  if (!transaction_.claim(kBeingSetOff)) return false;
  Transaction* const newer = newer_.load();
  if (newer != nullptr &&
      newer->decide(Transaction::State::aborted) == Transaction::State::committed) {
    transaction_.put_off(kClosed);
    return false;
  }
  fault_ = fault;
  member_ = member;
  decide(clock);
  told_.store(true, std::memory_order_release);
  return true;
}

/// Whoever does this may be preempted at any point, until the instant has passed.
void WayBack::decide(const Clock& clock) {
  Duration lead = kLeadOfWayBack;
  for (int attempt = 0; attempt < kAttempts; ++attempt, lead *= 2) {
    const Instant instant = clock.now() + lead.count();
    transaction_.attempt(instant);
    const bool late = clock.now() >= instant - kDecisionMargin.count();
    const auto wanted = late ? Transaction::State::aborted : Transaction::State::committed;
    if (transaction_.decide(wanted) == Transaction::State::committed) return;
    transaction_.put_off(kBeingSetOff);
  }
  // It has to end. A member that passes the instant between these two goes back one job later.
  transaction_.attempt(kBeingSetOff, Transaction::State::committed);
  transaction_.put_off(clock.now() + lead.count());
}

void WayBack::give_way_to(std::shared_ptr<Transaction> newer) {
  newer_.store(newer.get());
  if (newer != nullptr) all_newer_.push_back(std::move(newer));
}

}  // namespace mauve::exec
