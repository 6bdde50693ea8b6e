// SPDX-License-Identifier: LGPL-3.0-or-later
/// The books of a commit: the model shows the bundles that the members run, and the bundles from
/// before are retired.
#include <utility>
#include <vector>

#include "exec/admission/membership.h"
#include "exec/admission/timing_model.h"
#include "exec/commit/commit.h"
#include "exec/commit/late_jobs.h"
#include "exec/commit/under_way.h"
#include "exec/recovery/probations.h"
#include "exec/system/books.h"
#include "exec/system/make_update.h"
#include "exec/system/report_control.h"

#include <mauve/host/architecture.h>
#include <mauve/host/receipt.h>

namespace mauve::exec {
namespace {

std::uint64_t make_generation(System& system, bool by_stop) {
  if (by_stop && system.generation != system.stopped) system.before_stops = system.generation;
  ++system.generation;
  if (by_stop) system.stopped = system.generation;
  return system.generation;
}

/// A user started these components: older stops of theirs are over.
void end_stops(System& system, PreparedChange::Content& content,
               const std::vector<Member>& swapped) {
  if (!content.ends_stops) return;
  for (std::size_t i = 0; i < swapped.size(); ++i) {
    const PreparedMember& member = content.members[i];
    if (member.mode != Mode::run || !swapped[i].in_force) continue;
    const std::string& name = member.component->name();
    content.ended_stops.insert(name);
    system.stops.start(
        name, member.ends_stop,
        content.probation ? UserStops::Ends::unless_undone : UserStops::Ends::for_good);
  }
  system.obey_stops();
}

}  // namespace

/// The member's thread has answered, so the model shows the bundle that it runs.
void Commit::enter(std::size_t index) {
  const Member& settled = swap_->members()[index];
  const SwapResult::State state = swap_->result().state;
  const bool another_attempt = !settled.in_force && (state == SwapResult::State::under_way);
  if (another_attempt) return;
  PreparedMember& member = content_->members[index];
  entered_[index] = true;
  // A member that follows runs the same bundle, and its thread has applied this change as well.
  if (settled.in_force) deployed_[index]->shown = number_;
  if (member.part == Part::follows) {
    deployed_[index]->changing = false;
    return;
  }
  deployed_[index]->parking = false;
  deployed_[index]->changing = settled.in_force && member.part == Part::leaves;
  if (!settled.in_force) return;
  ++system_.revision;
  if (member.next != member.base) member.component->install(member.next);
  if (member.type) {
    ComponentType before = member.component->type();
    member.component->renew(*std::exchange(member.type, std::move(before)));
  }
  schedule(system_, *deployed_[index]);
  if (!is_timed_alike(*member.base, *member.next)) {
    deployed_[index]->timed = system_.runner->now();
  }
  system_.runner->look_again();
  // Elements that an abandoned thread may use are freed when that thread has ended: see collect().
  const bool lost = system_.runner->has_abandoned(deployed_[index]->task.get());
  // adopt() deals with the elements that a rollback may need, when the change joins the one before.
  if (heritage_.origin_of(*member.component) == nullptr) {
    retire(*member.base, *member.next, lost ? system_.retired : retired_);
  }
  if (member.next != member.base || member.standby != nullptr) {
    StandbyCore& standby = deployed_[index]->standby;
    system_.retired.keep(std::exchange(standby, std::exchange(standby_cores_[index], {})).content);
    member.standby.reset();
  }
  member.made.forget();
  const std::uint64_t missed = deployed_[index]->task->counters().missed.load();
  MemberReceipt row{member.component->name(), settled.pause, missed - missed_before_[index],
                    settled.bytes};
  say_states(*member.base->core, *member.next->core, member.state, row);
  receipt_.components.push_back(std::move(row));
}

void Commit::enter_resources() {
  Retired& retired = system_.runner->has_abandoned() ? system_.retired : retired_;
  for (std::size_t i = 0; i < swap_->resources().size(); ++i) {
    const ResourceUpdate& update = *swap_->resources()[i].update;
    if (update.state() != ResourceUpdate::State::in_force) continue;
    PreparedResource& change = content_->resources[i];
    ++system_.revision;
    change.resource->install(change.parts.core, change.parts.bindings);
    if (change.lock_budget) change.resource->lock().set_budget(*change.lock_budget);
    if (change.parts.core != nullptr) retired.add(change.base.core);
    change.made.forget();
    MemberReceipt row{change.resource->name(), update.pause(), 0, update.bytes()};
    if (change.parts.core != nullptr) {
      say_states(*change.base.core, *change.parts.core, change.state, row);
    }
    receipt_.components.push_back(std::move(row));
  }
}

/// Each attempt, once it is decided.
void Commit::report_attempt() {
  const SwapResult& swapped = swap_->result();
  if (swapped.attempts == attempts_reported_) return;
  attempts_reported_ = swapped.attempts;
  const bool committed = swap_->decision() == Decision::State::committed;
  report_control(system_, committed ? TraceKind::commit : TraceKind::abort, content_->what,
                 swapped.instant, number_);
  if (!committed) return;
  report_members(system_, *content_, number_);
  for (const std::string& address : content_->sets) {
    report_control(system_, TraceKind::set, address, 0, number_);
  }
}

/// A committed change is revoked when no member reached its boundary in time.
void Commit::report_end() {
  if (swap_->result().state != SwapResult::State::revoked) return;
  report_control(system_, TraceKind::abort, content_->what, swap_->result().instant, number_);
}

void Commit::conclude() {
  report_end();
  const SwapResult& swapped = swap_->result();
  const bool nothing_happened = swapped.state == SwapResult::State::missed ||
                                swapped.state == SwapResult::State::revoked ||
                                swapped.state == SwapResult::State::overtaken;
  if (nothing_happened) {
    take_back_stops(system_, *content_);
    result_ = not_applied(late_jobs_->reason(silent()));
    for (const auto& before : before_) before->give_way_to(nullptr);
    heritage_.let_go();
    return let_go_new();
  }
  if (heritage_.generations().empty()) overtake_before();
  enter_resources();
  if (system_.runner->has_abandoned())
    system_.retired.keep(content_);  // an abandoned thread may be inside a leaving element
  receipt_.state = ChangeState::applied;
  receipt_.commit = Duration{swapped.instant - system_.t0};
  receipt_.attempts = swapped.attempts;
  receipt_.warnings = content_->warnings;
  // A change of a rule stays in force although a converter of it failed.
  const bool stays = rollback_ != nullptr && rollback_->only_undo();
  if (stays && !failed().empty()) {
    receipt_.notes.push_back("the state was not converted, so the new core failed: " + failed());
  }
  const bool whole = swapped.state == SwapResult::State::committed && (stays || failed().empty());
  exchange_fallbacks(system_.architecture, content_->fallbacks);  // the rollback does so again
  if (barrier_ != nullptr) {
    barrier_->report(receipt_);
    barrier_->end();
  }
  if (!whole && rollback_ != nullptr) return trigger_rollback();
  end_stops(system_, *content_, swap_->members());
  if (!content_->step) made_ = make_generation(system_, is_unconditional());
  receipt_.generation = system_.generation;
  system_.newest = weak_from_this();
  system_.looks_at_newest = 0;
  change_membership();
  if (whole) {
    result_ = receipt_;
    if (rollback_ != nullptr) return begin_probation();
  } else {
    result_ = not_applied(late_jobs_->reason(silent()));
  }
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    if (content_->members[i].part != Part::leaves || !swap_->members()[i].in_force) continue;
    static_cast<void>(let_go(system_, *std::exchange(deployed_[i], nullptr)));
  }
}

/// The probations that this change joins pass on their origins; it ends the others early.
void Commit::overtake_before() {
  for (const auto& before : before_) {
    ProbationPeriod* const one = probation_of(system_, *before);
    if (one == nullptr) continue;  // its probation ended by itself
    if (heritage_.has(*before)) {
      one->pass_on_to(*content_, rollbacks_);
    } else {
      one->overtake();
    }
  }
  heritage_.let_go();
  let_fade(system_);
}

/// Some member hangs in its job, or its state was not converted: those that have changed go back,
/// so that there is no mixture.
void Commit::trigger_rollback() {
  take_back_stops(system_, *content_);
  const bool quietly =
      rollback_->trigger(system_.runner->clock(), "some member did not end its job in time");
  if (!quietly) made_ = ++system_.generation;  // a core failed meanwhile, which is reported
  change_membership();
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    rollbacks_[i].in_force = swap_->members()[i].in_force;
  }
  begin_probation();
  if (quietly) system_.probations.back()->go_quietly();
  back_by_ = system_.runner->now() + kLongestJob.count();
}

/// Or some member that has changed does not go back in time either.
bool Commit::all_went_back() {
  if (const ModelLock::Hold hold(system_.model, std::try_to_lock); hold) look_after_itself(system_);
  ProbationPeriod* const one = probation_of(system_, *rollback_);
  const bool under_way = one != nullptr;
  if (under_way && system_.runner->now() < back_by_) return false;
  if (under_way) {
    one->report_after_all();
    made_ = one->generations().back();
  }
  const std::string late = late_jobs_->reason(silent());
  result_ = not_applied(late);
  if (!under_way && !failed().empty()) {
    result_ = refuse({Errc::hook_threw, "conversion_failed"}, failed(),
                     "could not convert the state of the core before, so the change was revoked",
                     "correct its converter: the log says how it failed");
  } else if (!under_way) {
    result_ = refuse(
        {Errc::timed_out, "component_hangs"}, result_->error().at,
        "did not end its job within 2 s, so the change was revoked on all others" + late, kHoldsUp);
  }
  return true;
}

/// Enters elements that joined into the architecture, and takes out those that left; the content
/// keeps the latter alive.
void Commit::change_membership() {
  ++system_.revision;
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    PreparedMember& member = content_->members[i];
    if (!entered_[i] || !swap_->members()[i].in_force) continue;
    if (member.part == Part::leaves) {
      member.owner = system_.architecture.take_out(*member.component);
      deployed_[i]->hidden = true;
      deployed_[i]->changing = false;
    }
  }
  // A member that hangs may still use the resources that were to leave.
  const bool whole = swap_->result().state == SwapResult::State::committed;
  for (ResourceBase* resource : content_->leaving_resources) {
    if (!whole) break;
    content_->left_resources.push_back(system_.architecture.take_out(*resource));
    // The rollback of an earlier change may lead through it until no thread looks at it any more,
    // and its earlier cores may use its shell until they are freed.
    for (const auto& one : system_.fading) one->keep_longest(content_->left_resources.back());
    system_.retired.keep_longest(content_->left_resources.back());
  }
  for (const auto& resource : content_->new_resources) system_.architecture.own(resource);
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    PreparedMember& member = content_->members[i];
    if (member.part != Part::joins) continue;
    if (rollback_ != nullptr && !swap_->members()[i].in_force) {
      static_cast<void>(let_go(system_, *deployed_[i]));
      continue;
    }
    system_.architecture.own(member.owner);
    deployed_[i]->hidden = false;
  }
}

void Commit::begin_probation() {
  if (!heritage_.generations().empty()) {
    overtake_before();
    for (const PreparedMember& member : content_->members) {
      if (heritage_.origin_of(*member.component) == nullptr) continue;
      retire(*member.base, *member.next, retired_);
    }
    roll_back_late_members();
  }
  system_.probations.push_back(std::make_unique<ProbationPeriod>(
      system_, content_, std::move(rollbacks_), rollback_, std::move(retired_), back_number_,
      heritage_.generations()));
}

/// A member that hangs runs the bundle that the change before gave it. It goes back when it ends
/// its job.
void Commit::roll_back_late_members() {
  for (std::size_t i = 0; i < rollbacks_.size(); ++i) {
    MemberRollback& member = rollbacks_[i];
    const PreparedMember& change = content_->members[i];
    if (member.in_force || heritage_.origin_of(*change.component) == nullptr) continue;
    auto back = make_rollback(change, member.origin);
    decide_by_rollback(*back);
    member.back = back.get();
    member.answer = back->answer;
    member.in_force = true;
    member.deployed->task->mailbox().publish_rollback(*back.release());
    system_.runner->wake(*member.deployed->task);
  }
}

/// The names of members whose state was not converted.
std::string Commit::failed() const {
  std::string names;
  for (const ResourceMember& one : swap_->resources()) {
    if (!one.update->failed()) continue;
    names += (names.empty() ? "" : ", ") + one.resource->name();
  }
  for (std::size_t i = 0; i < swap_->members().size() && i < deployed_.size(); ++i) {
    if (!swap_->members()[i].failed) continue;
    names += (names.empty() ? "" : ", ") + deployed_[i]->task->name();
  }
  return names;
}

/// `late`: the reason of LateJobs.
Error Commit::not_applied(const std::string& late) const {
  if (const std::string names = failed(); !names.empty() && rollback_ == nullptr) {
    return refuse(
        {Errc::partly, "conversion_failed_in_force"}, names,
        "could not convert the state of the core before: a component failed with its safe "
        "values written, a resource is poisoned; the change is in force",
        content_->in_place ? "correct its converter, then swap again"
                           : "correct its converter, then swap again; without --probation off it "
                             "would have been rolled back");
  }
  std::string names;
  for (const Deployed* one : silent()) {
    names += (names.empty() ? "" : ", ") + one->task->name();
  }
  for (const ResourceMember& one : swap_->resources()) {
    if (one.update->state() == ResourceUpdate::State::in_force) continue;
    names += (names.empty() ? "" : ", ") + one.resource->name();
  }
  if (swap_->members().empty() && swap_->result().state != SwapResult::State::overtaken) {
    return refuse({Errc::timed_out, "resource_held"}, names,
                  "is held by a caller that does not leave it, so it was not changed", kHoldsUp);
  }
  const std::string look = kHoldsUp;
  switch (swap_->result().state) {
    case SwapResult::State::overtaken:
      return being_rolled_back(system_.generation);
    case SwapResult::State::missed:
      return refuse({Errc::timed_out, "instant_missed"}, names,
                    "every attempt missed its instant: the machine is overloaded", "try again");
    case SwapResult::State::revoked:
      return refuse({Errc::timed_out, "component_hangs"}, names,
                    "did not end its job within 2 s, so the change was revoked" + late, look);
    case SwapResult::State::waiting:
      return refuse({Errc::partly, "stops_later"}, names,
                    "did not end its job in time; it will obey when it does" + late, look);
    default:
      if (rollback_ != nullptr) {
        return refuse(
            {Errc::partly, "rollback_incomplete"}, names,
            "did not end its job within 2 s: the change is rolled back on the others, but "
            "some of them do not end their job either" +
                late,
            look);
      }
      return refuse({Errc::partly, "change_incomplete"}, names,
                    "did not end its job within 2 s: the change is in force on the others only, a "
                    "mixture that is not safe to keep" +
                        late,
                    "stop the component that hangs, then change it, or all others back");
  }
}

}  // namespace mauve::exec
