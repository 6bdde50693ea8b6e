// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/swap.h"

#include <algorithm>

#include "model/left_behind.h"

namespace mauve::exec {
namespace {

constexpr Duration kShortestLead = 200us;
constexpr Duration kLeadPerMember = 1us;
/// Nearer than this the coordinator does not decide: a member might be at its boundary already.
constexpr Duration kDecisionMargin = 50us;

bool all_done(const Transaction& transaction, const std::vector<Member>& members) {
  return transaction.done() == members.size();
}

/// Publishes and decides. The whole of it is a few stores, so it runs just above ordinary threads
/// (and below every component): a loaded machine does not make it miss its instant.
Transaction::State publish_and_decide(Transaction& transaction, std::vector<Member>& members,
                                      Runner& runner) {
  const auto urgency = runner.hurry();
  for (Member& member : members) {
    static_cast<void>(member.task->reclaim());  // of a change that was given up
    member.next->transaction = &transaction;
    member.task->publish(*member.next);
  }
  const bool late = runner.now() >= transaction.instant() - kDecisionMargin.count();
  const auto decision =
      transaction.decide(late ? Transaction::State::aborted : Transaction::State::committed);
  for (Member& member : members) runner.wake(*member.task);
  return decision;
}

/// The task owns the bundle it took until the next change; what it ran before comes back.
void settle_committed(std::vector<Member>& members) {
  for (Member& member : members) {
    member.in_force = member.next.release();
    member.replaced = member.task->reclaim();
  }
}

/// The bundles come back untouched and are ready for another attempt.
void settle_aborted(std::vector<Member>& members) {
  for (Member& member : members) {
    static_cast<void>(member.next.release());
    member.next = member.task->reclaim();
    member.next->taken = false;
  }
}

/// Some member does not come to a boundary, or does not end its first job after it: takes the
/// bundles back that nobody has taken. The words that a thread may be about to look at are left
/// behind, the elements are not.
SwapResult::State give_up(std::vector<Member>& members, Transaction::State decision) {
  std::size_t revoked = 0;
  std::size_t taken = 0;
  for (Member& member : members) {
    if (member.task->revoke(*member.next)) {
      member.next->bundle.reset();
      leave_behind(std::shared_ptr<Published>(std::move(member.next)));
      ++revoked;
    } else if (member.next->taken.load(std::memory_order_acquire)) {
      member.in_force = member.next.release();
      member.replaced = member.task->reclaim();
      ++taken;
    } else {
      static_cast<void>(member.next.release());  // given back: it lies with the task
    }
  }
  if (decision == Transaction::State::aborted) return SwapResult::State::revoked;
  if (taken == members.size()) return SwapResult::State::committed;
  return revoked == members.size() ? SwapResult::State::revoked : SwapResult::State::partly;
}

}  // namespace

SwapResult swap(std::vector<Member>& members, Runner& runner, Duration bound) {
  SwapResult result;
  Duration lead =
      std::max(kShortestLead, Duration(kLeadPerMember * static_cast<std::int64_t>(members.size())));
  for (; result.attempts < kMaxAttempts; lead *= 2) {
    ++result.attempts;
    auto transaction = std::make_unique<Transaction>(runner.now() + lead.count());
    result.instant = transaction->instant();
    const auto decision = publish_and_decide(*transaction, members, runner);
    const auto settled = [&] { return all_done(*transaction, members); };
    if (!runner.await(settled, runner.now() + (lead + bound).count())) {
      result.state = give_up(members, transaction->state());
      leave_behind(std::shared_ptr<Transaction>(std::move(transaction)));
      return result;
    }
    if (decision == Transaction::State::committed) {
      settle_committed(members);
      result.state = SwapResult::State::committed;
      return result;
    }
    settle_aborted(members);
  }
  result.state = SwapResult::State::missed;
  return result;
}

}  // namespace mauve::exec
