// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/swap/two_phase_commit.h"

#include <algorithm>

#include "base/fail_point.h"
#include "exec/run/runner.h"
#include "exec/task/task.h"
#include "model/job/keep_for_abandoned.h"

namespace mauve::exec {
namespace {

constexpr Duration kShortestLead = 200us;
constexpr Duration kLeadPerMember = 1us;

/// An unconditional update is decided before it is published. It gets its instant when every member
/// has it, so that nothing that holds up [control] meanwhile lets a member pass the instant unaware
/// of it.
class UnconditionalDecision final : public Decision {
 public:
  UnconditionalDecision() : Decision(kNever, State::committed) {}
  using Decision::claim;
};

using Progress = TaskUpdate::Progress;

}  // namespace

TwoPhaseCommit::TwoPhaseCommit(std::vector<Member> members, std::vector<ResourceMember> resources,
                               Runner& runner, Duration bound, Kind kind,
                               std::vector<std::shared_ptr<Rollback>> before)
    : members_(std::move(members)),
      resources_(std::move(resources)),
      runner_(runner),
      bound_(bound),
      kind_(kind),
      before_(std::move(before)),
      lead_(std::max(kShortestLead, kLeadPerMember * static_cast<std::int64_t>(members_.size()))) {
  // A change of resources alone waits for no task: their callers meet it from now on.
  if (members_.empty()) lead_ = Duration{0};
  attempt();
}

TwoPhaseCommit::~TwoPhaseCommit() {
  bool in_use = stopped_waiting_;
  for (ResourceMember& member : resources_) old_updates_.push_back(std::move(member.update));
  for (auto& update : old_updates_) {
    if (!update->lost() && update->disarm()) continue;
    keep_for_abandoned(std::shared_ptr<ResourceUpdate>(std::move(update)));
    in_use = true;
  }
  // A thread may be about to read a decision when the wait for it was ended, or when the system
  // goes down over it.
  for (Member& member : members_) {
    in_use = in_use || member.update != nullptr;
    take_back(member);
  }
  if (!in_use) return;
  for (auto& decision : decisions_) keep_for_abandoned(std::move(decision));
}

/// Publishes and decides. The whole of it is a few stores, so it runs just above ordinary threads
/// (and below every component): a loaded machine does not make it miss its instant.
void TwoPhaseCommit::attempt() {
  ++result_.attempts;
  const auto urgency = runner_.raise_priority();
  result_.instant = runner_.now() + lead_.count();
  const auto unconditional =
      kind_ == Kind::unconditional ? std::make_shared<UnconditionalDecision>() : nullptr;
  const bool decided = members_.empty() && before_.empty();
  decisions_.push_back(unconditional);
  if (unconditional == nullptr) {
    decisions_.back() = std::make_shared<Decision>(
        result_.instant, decided ? Decision::State::committed : Decision::State::prepared);
  }
  for (const auto& before : before_) before->give_way_to(decisions_.back());
  MAUVE_FAIL_POINT("commit.before_publish");
  for (Member& member : members_) publish(member);
  for (ResourceMember& resource : resources_) arm(resource);
  if (unconditional != nullptr) {
    result_.instant = runner_.now() + lead_.count();
    static_cast<void>(unconditional->claim(result_.instant));
  }
  deadline_ = result_.instant + bound_.count();
  const bool late = !members_.empty() && runner_.now() >= result_.instant - kDecisionMargin.count();
  const bool led_back = is_rolled_back();
  MAUVE_FAIL_POINT("commit.before_decide");
  decisions_.back()->decide(late || led_back ? Decision::State::aborted
                                             : Decision::State::committed);
  MAUVE_FAIL_POINT("commit.after_decide");
  for (Member& member : members_) runner_.wake(*member.task);
}

void TwoPhaseCommit::publish(Member& member) {
  static_cast<void>(member.task->mailbox().reclaim());  // frees old updates; their elements stay
  member.next->decision = decisions_.back().get();
  member.next->answer->progress = Progress::published;
  member.answer = member.next->answer;
  member.settled = false;
  member.update = member.next.release();
  member.task->mailbox().publish(*member.update);
}

void TwoPhaseCommit::arm(ResourceMember& resource) {
  if (resource.update != nullptr) old_updates_.push_back(std::move(resource.update));
  resource.update = std::make_unique<ResourceUpdate>(*resource.resource, resource.parts,
                                                     resource.state, *decisions_.back());
}

bool TwoPhaseCommit::all_settled() {
  bool settled = true;
  for (Member& member : members_) {
    if (!member.settled) settle(member);
    settled = settled && member.settled;
  }
  for (ResourceMember& resource : resources_) {
    resource.update->help(runner_.now());
    settled = settled && resource.update->settled();
  }
  return settled;
}

bool TwoPhaseCommit::advance() {
  if (!all_settled()) {
    if (result_.state != SwapResult::State::under_way || runner_.now() < deadline_) return false;
    if (is_taking()) return false;
    stop_waiting();
    return result_.state != SwapResult::State::waiting;
  }
  const bool open =
      result_.state == SwapResult::State::under_way || result_.state == SwapResult::State::waiting;
  if (!open) return true;
  if (decisions_.back()->state() == Decision::State::committed) {
    result_.state = SwapResult::State::committed;
    return true;
  }
  if (is_rolled_back()) {
    result_.state = SwapResult::State::overtaken;
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

/// Is one of the earlier changes rolled back?
bool TwoPhaseCommit::is_rolled_back() const {
  return std::any_of(before_.begin(), before_.end(),
                     [](const std::shared_ptr<Rollback>& before) { return before->rolls_back(); });
}

/// Is a caller just applying an update? That is settled in a moment.
bool TwoPhaseCommit::is_taking() const {
  return std::any_of(resources_.begin(), resources_.end(), [](const ResourceMember& member) {
    return member.update->state() == ResourceUpdate::State::taking;
  });
}

/// The task may have claimed the update and given it back, for instance on a rollback: then the
/// update is freed, and only its answer is left.
void TwoPhaseCommit::settle(Member& member) {
  const Progress progress = member.answer->progress.load(std::memory_order_acquire);
  if (progress == Progress::published) return;
  if (progress == Progress::done) {
    member.pause = member.answer->pause;
    member.bytes = member.answer->bytes;
    member.failed = member.answer->failed;
    member.in_force = true;
    static_cast<void>(
        member.task->mailbox().reclaim());  // frees the updates before; their elements stay
  } else {
    take_back(member);  // untouched, ready for another attempt
  }
  member.update = nullptr;
  member.settled = true;
}

/// Owns an update again that the task has given back.
void TwoPhaseCommit::take_back(Member& member) {
  if (member.update == nullptr || member.answer->progress != Progress::given_back) return;
  member.next.reset(std::exchange(member.update, nullptr));
}

/// Some member does not come to a boundary, or met the update at a release and does not end the job
/// of that release. Revokes the updates that no task has claimed.
void TwoPhaseCommit::stop_waiting() {
  if (kind_ == Kind::unconditional) {
    result_.state = SwapResult::State::waiting;
    return;
  }
  const bool committed = decisions_.back()->state() == Decision::State::committed;
  std::size_t in_force = 0;
  for (Member& member : members_) {
    if (!member.settled) stop_waiting(member, committed);
    in_force += member.in_force ? 1 : 0;
  }
  for (ResourceMember& resource : resources_) {
    resource.update->revoke();
    in_force += resource.update->state() == ResourceUpdate::State::dropped ? 0 : 1;
  }
  result_.state = in_force == 0                                     ? SwapResult::State::revoked
                  : in_force == members_.size() + resources_.size() ? SwapResult::State::committed
                                                                    : SwapResult::State::partly;
}

/// If claim() fails, the task has claimed the update: it runs it, will run it, or has returned it
/// unused.
void TwoPhaseCommit::stop_waiting(Member& member, bool committed) {
  stopped_waiting_ = true;
  if (member.task->mailbox().claim(*member.update)) {
    // An update that a thread may be about to read is kept for ever; the elements are not.
    member.update->bundle.reset();
    member.update->back.reset();
    keep_for_abandoned(std::shared_ptr<TaskUpdate>(std::exchange(member.update, nullptr)));
  } else {
    member.in_force = committed;
  }
  member.settled = true;
}

}  // namespace mauve::exec
