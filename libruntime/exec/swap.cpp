// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/swap.h"

#include <algorithm>

#include "base/fail_point.h"
#include "model/left_behind.h"

namespace mauve::exec {
namespace {

constexpr Duration kShortestLead = 200us;
constexpr Duration kLeadPerMember = 1us;
/// Nearer than this the coordinator does not decide: a member might be at its boundary already.
constexpr Duration kDecisionMargin = 50us;

using Progress = Published::Progress;

/// What a thread may be about to look at is left behind; the elements are not.
void leave_words_behind(Member& member) {
  member.next->bundle.reset();
  leave_behind(std::shared_ptr<Published>(std::move(member.next)));
}

}  // namespace

Swap::Swap(std::vector<Member> members, Runner& runner, Duration bound, Kind kind)
    : members_(std::move(members)),
      runner_(runner),
      bound_(bound),
      kind_(kind),
      lead_(std::max(kShortestLead, kLeadPerMember * static_cast<std::int64_t>(members_.size()))) {
  attempt();
}

Swap::~Swap() {
  if (all_settled()) return;
  // Only when the system goes down over it: the thread of some member hangs.
  for (Member& member : members_) {
    if (member.next != nullptr && !member.settled) {
      leave_behind(std::shared_ptr<Published>(std::move(member.next)));
    }
  }
  leave_behind(std::shared_ptr<Transaction>(std::move(transaction_)));
}

/// Publishes and decides. The whole of it is a few stores, so it runs just above ordinary threads
/// (and below every component): a loaded machine does not make it miss its instant.
void Swap::attempt() {
  ++result_.attempts;
  const auto urgency = runner_.hurry();
  result_.instant = runner_.now() + lead_.count();
  deadline_ = result_.instant + bound_.count();
  const bool decided = kind_ == Kind::order;
  transaction_ = std::make_unique<Transaction>(
      result_.instant, decided ? Transaction::State::committed : Transaction::State::prepared);
  for (Member& member : members_) {
    static_cast<void>(member.task->reclaim());  // of a change that was given up
    member.next->transaction = transaction_.get();
    member.next->progress = Progress::published;
    member.settled = false;
    member.task->publish(*member.next);
  }
  const bool late = runner_.now() >= result_.instant - kDecisionMargin.count();
  MAUVE_FAIL_POINT("commit.before_decide");
  transaction_->decide(late ? Transaction::State::aborted : Transaction::State::committed);
  MAUVE_FAIL_POINT("commit.after_decide");
  for (Member& member : members_) runner_.wake(*member.task);
}

bool Swap::all_settled() const {
  return std::all_of(members_.begin(), members_.end(),
                     [](const Member& member) { return member.settled; });
}

bool Swap::advance() {
  for (Member& member : members_) {
    if (!member.settled) settle(member);
  }
  if (!all_settled()) {
    if (result_.state == SwapResult::State::under_way && runner_.now() >= deadline_) give_up();
    return all_settled();
  }
  const bool open =
      result_.state == SwapResult::State::under_way || result_.state == SwapResult::State::waiting;
  if (!open) return true;
  if (transaction_->state() == Transaction::State::committed) {
    result_.state = SwapResult::State::committed;
    return true;
  }
  if (result_.attempts == kMaxAttempts) {
    result_.state = SwapResult::State::missed;
    return true;
  }
  lead_ *= 2;
  attempt();
  return false;
}

void Swap::settle(Member& member) {
  const Progress progress = member.next->progress.load(std::memory_order_acquire);
  if (progress == Progress::done) {
    member.pause = member.next->pause;
    member.bytes = member.next->bytes;
    static_cast<void>(member.next.release());   // the task owns what it runs with
    static_cast<void>(member.task->reclaim());  // what it ran with before: words, no elements
    member.in_force = member.settled = true;
  } else if (progress == Progress::given_back) {
    static_cast<void>(member.next.release());
    member.next = member.task->reclaim();  // untouched, ready for another attempt
    member.settled = true;
  }
}

/// Some member does not come to a boundary, or does not end its first job after it: takes the
/// bundles back that no thread has claimed.
void Swap::give_up() {
  if (kind_ == Kind::order) {
    result_.state = SwapResult::State::waiting;
    return;
  }
  const bool committed = transaction_->state() == Transaction::State::committed;
  std::size_t in_force = 0;
  for (Member& member : members_) {
    if (!member.settled && member.task->revoke(*member.next)) {
      leave_words_behind(member);
    } else if (!member.settled) {
      // Claimed: its thread runs with it, or is about to, or gave it back and the task keeps it.
      static_cast<void>(member.next.release());
      member.in_force = committed;
    }
    member.settled = true;
    in_force += member.in_force ? 1 : 0;
  }
  result_.state = in_force == 0                 ? SwapResult::State::revoked
                  : in_force == members_.size() ? SwapResult::State::committed
                                                : SwapResult::State::partly;
  leave_behind(std::shared_ptr<Transaction>(std::move(transaction_)));
}

}  // namespace mauve::exec
