// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/commit/barrier.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include "base/fail_point.h"
#include "exec/commit/commit.h"
#include "exec/commit/late_jobs.h"
#include "exec/swap/bystanders.h"
#include "exec/system/books.h"
#include "rt/thread/deadline.h"

#include <mauve/host/receipt.h>
#include <mauve/host/resource.h>
#include <mauve/observable.h>

namespace mauve::exec {
namespace {

Member member_at(Deployed& deployed, TaskUpdate::Barrier step, std::uint64_t number) {
  Member member;
  member.task = deployed.task.get();
  member.next = std::make_unique<TaskUpdate>();
  member.next->barrier = step;
  member.next->number = number;
  return member;
}

/// False also for a resource that an abandoned thread holds for good.
bool is_free(ResourceBase& resource) {
  if (!resource.lock().try_enter()) return false;
  resource.lock().leave();
  return true;
}

/// Counters and the like of a resource of the same type.
void go_on_counting(const ResourceBase& from, const ResourceBase& into) {
  if (from.type().name != into.type().name) return;
  for (ObservableBase* observable : into.core().observables()) {
    const ObservableBase* same = from.core().find_observable(observable->name());
    if (same != nullptr && same_type(same->type(), observable->type())) {
      observable->continue_from(*same);
    }
  }
}

}  // namespace

Status Barrier::check(const PreparedChange::Content& content) {
  for (const PreparedBarrier::Replacement& replacement : content.barrier->replacements) {
    const std::string& name = replacement.from->name();
    if (replacement.from->shared_core() != replacement.base.core ||
        replacement.from->shared_bindings() != replacement.base.bindings ||
        replacement.from->lock().budget() != replacement.base_lock_budget) {
      return refuse({Errc::conflict, "changed_meanwhile"}, name,
                    "was changed by somebody else while this change was prepared", "try again");
    }
    auto plan = plan_transfer(*replacement.from, *replacement.into, replacement.state,
                              content.probation.has_value());
    if (!plan) return plan.error();
    replacements_.push_back({replacement.from, replacement.into, replacement.state, *plan});
  }
  for (const ComponentBase* component : bystanders_of(system_, content)) {
    Deployed* const deployed = system_.find(component->name());
    if (deployed->changing) {
      return refuse({Errc::conflict, "job_not_ended"}, component->name(),
                    "has not ended the job it is in, and a change waits for that", "try again");
    }
    bystanders_.push_back({deployed, deployed->task->counters().missed.load()});
  }
  return ok();
}

void Barrier::begin(const std::vector<Deployed*>& members, std::uint64_t number) {
  number_ = number;
  gathered_ = members;
  for (const Bystander& one : bystanders_) {
    one.deployed->changing = true;
    gathered_.push_back(one.deployed);
  }
  std::erase_if(gathered_,
                [](const Deployed* one) { return one->state() != ComponentState::running; });
  std::vector<Member> waiting;
  for (Deployed* one : gathered_)
    waiting.push_back(member_at(*one, TaskUpdate::Barrier::wait, number_));
  gathering_ =
      std::make_unique<TwoPhaseCommit>(std::move(waiting), std::vector<ResourceMember>{},
                                       *system_.runner, kLongestWait, TwoPhaseCommit::Kind::change);
}

bool Barrier::advance() {
  if (phase_ == Phase::gathering && gathering_->advance()) {
    const SwapResult::State state = gathering_->result().state;
    if (state == SwapResult::State::committed) {
      phase_ = Phase::waiting;
    } else if (state == SwapResult::State::missed) {
      call_off(refuse({Errc::timed_out, "instant_missed"}, absent(),
                      "every attempt missed its instant: the machine is overloaded", "try again"));
    } else {
      call_off(refuse({Errc::timed_out, "barrier_not_reached"}, absent(),
                      "did not come to the barrier within " + std::to_string(kLongestWait / 1ms) +
                          " ms, so the change was revoked and all go on as before",
                      kHoldsUp));
    }
  }
  if (phase_ == Phase::parting && parting_->advance()) phase_ = Phase::over;
  return phase_ == Phase::waiting || phase_ == Phase::over;
}

std::string Barrier::absent() const {
  std::string names;
  for (std::size_t i = 0; i < gathered_.size(); ++i) {
    if (gathering_->members()[i].in_force) continue;
    names += (names.empty() ? "" : ", ") + gathered_[i]->component->name();
  }
  return names;
}

void Barrier::call_off(Error why) {
  if (phase_ != Phase::gathering && phase_ != Phase::waiting) return;
  refusal_ = std::move(why);
  gathering_->call_off();
  part();
}

void Barrier::give_way(const Deployed& stopped) {
  if (std::find(gathered_.begin(), gathered_.end(), &stopped) == gathered_.end()) return;
  call_off(refuse({Errc::conflict, "stopped_meanwhile"}, stopped.component->name(),
                  "was to be stopped while others waited for it at the barrier, so the change was "
                  "revoked",
                  "try again"));
}

void Barrier::part() {
  std::vector<Member> leaving;
  for (std::size_t i = 0; i < gathered_.size(); ++i) {
    if (!gathering_->members()[i].in_force) continue;
    leaving.push_back(member_at(*gathered_[i], TaskUpdate::Barrier::resume, number_));
  }
  parting_ = std::make_unique<TwoPhaseCommit>(std::move(leaving), std::vector<ResourceMember>{},
                                              *system_.runner, kLongestWait,
                                              TwoPhaseCommit::Kind::unconditional);
  phase_ = Phase::parting;
}

bool Barrier::hand_over(const std::vector<PreparedResource>& changed) {
  std::string held;
  for (const Replacement& replacement : replacements_) {
    if (!is_free(*replacement.from)) held = replacement.from->name();
  }
  for (const PreparedResource& one : changed) {
    if (!is_free(*one.resource)) held = one.resource->name();
  }
  if (!held.empty()) {
    call_off(refuse({Errc::timed_out, "resource_held"}, held,
                    "is held by a caller that does not leave it, so the change was revoked and "
                    "all go on as before",
                    "look at `status`: a core that never returns holds what it is inside"));
    return false;
  }
  for (const Replacement& replacement : replacements_) {
    const bool takes =
        replacement.plan.hand_over.from != nullptr || replacement.plan.from != nullptr;
    if (!takes) continue;
    // Since the plan was made a call may have been aborted inside the resource.
    if (Status whole = check_whole(*replacement.from, StatePolicy::keep); !whole) {
      call_off(whole.error());
      return false;
    }
  }
  MAUVE_FAIL_POINT("barrier.before_hand_over");
  if (!hand_over()) return false;
  MAUVE_FAIL_POINT("barrier.after_hand_over");
  return true;
}

/// All states are handed over, or none: states moved before one fails are moved back. A converter
/// that does not return fails too: members wait for it, and so does each request to [control].
bool Barrier::hand_over() {
  MAUVE_ON_THREAD(control);
  const rt::Deadline deadline(kLongestWait);
  for (std::size_t i = 0; i < replacements_.size(); ++i) {
    const auto bytes = replacements_[i].plan.run(replacements_[i].into->name(), deadline.watched());
    if (!bytes) {
      while (i > 0) replacements_[--i].plan.undo();
      call_off(bytes.error());
      return false;
    }
    replacements_[i].bytes = *bytes;
  }
  if (const Deployed* const stopped = halted()) {
    for (std::size_t i = replacements_.size(); i > 0;) replacements_[--i].plan.undo();
    give_way(*stopped);
    return false;
  }
  for (const Replacement& replacement : replacements_)
    go_on_counting(*replacement.from, *replacement.into);
  return true;
}

/// The member that a direct stop parked while a converter held [control] up; null: none.
const Deployed* Barrier::halted() const {
  MAUVE_ON_THREAD(control);
  const auto found = std::find_if(gathered_.begin(), gathered_.end(), [](const Deployed* one) {
    return one->task->mailbox().halted();
  });
  return found == gathered_.end() ? nullptr : *found;
}

std::vector<Member> Barrier::resume() const {
  std::vector<Member> members;
  for (const Bystander& one : bystanders_) {
    members.push_back(member_at(*one.deployed, TaskUpdate::Barrier::resume, number_));
  }
  return members;
}

void Barrier::end() {
  for (const Bystander& one : bystanders_) one.deployed->changing = false;
}

void Barrier::report(Receipt& receipt) const {
  receipt.attempts = gathering_->result().attempts;
  for (const Bystander& one : bystanders_) {
    const std::uint64_t missed = one.deployed->task->counters().missed.load();
    receipt.components.push_back(
        {one.deployed->component->name(), Duration{0}, missed - one.missed_before, 0});
  }
  for (const Replacement& replacement : replacements_) {
    MemberReceipt row{replacement.into->name(), Duration{0}, 0, replacement.bytes};
    say_replaced(*replacement.from, *replacement.into, replacement.state, row);
    receipt.components.push_back(std::move(row));
  }
}

}  // namespace mauve::exec
