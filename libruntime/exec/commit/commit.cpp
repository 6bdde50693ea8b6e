// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/commit/commit.h"
#include "exec/commit/late_jobs.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include "exec/admission/admission.h"
#include "exec/admission/membership.h"
#include "exec/recovery/probations.h"
#include "exec/recovery/standby.h"
#include "exec/swap/rewired.h"
#include "exec/system/books.h"
#include "exec/system/make_update.h"
#include "exec/system/report_control.h"

#include <mauve/detail/job.h>
#include <mauve/host/architecture.h>
#include <mauve/host/receipt.h>
#include <mauve/host/resource.h>

namespace mauve::exec {
namespace {

Status check_member(const PreparedMember& member, const Deployed& deployed) {
  if (deployed.changing) {
    return refuse({Errc::conflict, "job_not_ended"}, member.component->name(),
                  "has not ended the job it is in, and a change waits for that",
                  "try again; " + std::string(kHoldsUp));
  }
  if (member.component->bundle() != member.base) {
    return refuse({Errc::conflict, "changed_meanwhile"}, member.component->name(),
                  "was changed by somebody else while this change was prepared", "try again");
  }
  return ok();
}

Status check_resource(const PreparedResource& change) {
  const ResourceBase& resource = *change.resource;
  const bool same_lock_budget =
      !change.lock_budget || resource.lock().budget() == change.base_lock_budget;
  if (resource.shared_core() == change.base.core &&
      resource.shared_bindings() == change.base.bindings && same_lock_budget) {
    return ok();
  }
  return refuse({Errc::conflict, "changed_meanwhile"}, resource.name(),
                "was changed by somebody else while this change was prepared", "try again");
}

/// True while the command that made the newest generation has not read its result: for some calls,
/// `next` makes no other generation. The parts of a stop do not wait for each other. [control]
bool leaves_newest_in_place(System& system, const Commit& next) {
  MAUVE_ON_THREAD(control);
  constexpr unsigned kLooks = 8;
  const auto made = system.newest.lock();
  if (made == nullptr || !made->is_unreported() ||
      (made->is_unconditional() && next.is_unconditional()))
    return false;
  return ++system.looks_at_newest <= kLooks;
}

Status check_is_there(const Architecture& architecture, const ResourceBase* resource) {
  const auto& there = architecture.resources();
  if (std::find(there.begin(), there.end(), resource) != there.end()) return ok();
  return refuse({Errc::conflict, "left_meanwhile"}, resource->name(),
                "has left while this change was prepared", "look at `status`");
}

/// A change that was prepared against an older revision of the model still fits to it.
Status check_fit_again(System& system, const PreparedChange::Content& content) {
  Status sound = check_fit(system.architecture, content);
  if (sound && system.options.admission == Admission::strict) {
    if (auto admitted = admit_change(system, content); !admitted) sound = admitted.error();
  }
  if (sound) return ok();
  return refuse({Errc::conflict, "changed_meanwhile"}, sound.error().at,
                sound.error().message +
                    "; the architecture changed while this change was prepared, for example by a "
                    "rollback",
                "try again; `logs` and `history` show what came between");
}

/// A rollback of the change must find these stops, so they do not wait for its end.
void begin_stops(System& system, PreparedChange::Content& content) {
  MAUVE_ON_THREAD(control);
  for (const std::string& name : content.stops) {
    if (system.may_run(name)) content.newly_stopped.push_back(name);
    system.stops.stop(name, content.stopped_by);
  }
  content.last_stop = system.stops.newest();
  system.obey_stops();
}

/// A component that a user has stopped starts only if a user names it.
void leave_stopped(System& system, PreparedChange::Content& content) {
  MAUVE_ON_THREAD(control);
  for (PreparedMember& member : content.members) {
    if (stays_stopped(system, content, member)) member.mode = Mode::keep;
    member.ends_stop = content.ends_stops ? system.stops.newest() : 0;
  }
}

}  // namespace

Commit::Commit(System& system, Content content, TwoPhaseCommit::Kind kind, Duration longest_job)
    : system_(system), departed_(system.departed), content_(std::move(content)), kind_(kind) {
  Status sound = check(kind);
  if (sound) sound = let_in_new();
  if (sound && barrier_ != nullptr) sound = end_probations_before();
  if (!sound) {
    refuse_all(std::move(sound.error()));
    return;
  }
  number_ = ++system_.changes;
  if (content_->probation) {
    rollback_ = std::make_shared<Rollback>(content_->probation->only_undo);
    back_number_ = ++system_.changes;
  }
  begin_stops(system_, *content_);
  leave_stopped(system_, *content_);
  hold_members();
  if (barrier_ == nullptr) {
    publish(kind, longest_job);
  } else {
    barrier_->begin(deployed_, number_);
  }
}

/// Ends the commit with an error: nothing has changed, and nothing will.
void Commit::refuse_all(Error error) {
  take_back_stops(system_, *content_);
  let_go_new();
  heritage_.let_go();
  result_ = std::move(error);
  over_ = true;
  content_.reset();
}

/// False: not yet, or never. A waiting member applies an unconditional update at once, so nothing
/// can fail after it.
bool Commit::pass_barrier() {
  if (!barrier_->advance()) return false;
  if (barrier_->all_wait() && barrier_->hand_over(content_->resources)) {
    publish(TwoPhaseCommit::Kind::unconditional, kLongestJob);
    return true;
  }
  if (barrier_->advance()) {
    for (Deployed* deployed : deployed_) deployed->changing = false;
    barrier_->end();
    refuse_all(barrier_->refusal());
  }
  return false;
}

Status Commit::check(TwoPhaseCommit::Kind kind) {
  if (Status outside = refuse_in_job("deployer", "commit()"); !outside) return outside;
  for (const PreparedMember& member : content_->members) {
    if (member.part == Part::joins) {
      deployed_.push_back(nullptr);  // see let_in_new()
      continue;
    }
    deployed_.push_back(system_.find(*member.component));
    // A member that was rolled back can be ordered to park before its rollback is in the books.
    const bool there = deployed_.back() != nullptr &&
                       (kind == TwoPhaseCommit::Kind::unconditional || !deployed_.back()->hidden);
    if (!there) {
      return refuse({Errc::conflict, "left_meanwhile"}, member.component->name(),
                    "has left while this change was prepared", "look at `status`");
    }
    if (Status current = check_member(member, *deployed_.back()); !current) return current;
  }
  for (const ResourceBase* leaving : content_->leaving_resources) {
    if (Status there = check_is_there(system_.architecture, leaving); !there) return there;
  }
  for (const PreparedResource& resource : content_->resources) {
    Status there = check_is_there(system_.architecture, resource.resource);
    if (!there) return there;
    if (Status current = check_resource(resource); !current) return current;
  }
  if (Status same = system_.check_made_from(content_->made_from); !same) return same;
  const bool outdated = content_->revision && *content_->revision != system_.revision;
  if (outdated && !content_->in_place) {
    if (Status fits = check_fit_again(system_, *content_); !fits) return fits;
  }
  if (content_->barrier) {
    barrier_ = std::make_unique<Barrier>(system_);
    if (Status ready = barrier_->check(*content_); !ready) return ready;
  }
  return check_probations(kind);
}

Status Commit::check_probations(TwoPhaseCommit::Kind kind) {
  if (kind == TwoPhaseCommit::Kind::unconditional) return ok();
  receipt_.notes = notes_of(system_, *content_);
  for (const auto& one : system_.probations) {
    if (one->reported() || !concerns(system_, *content_, one->content())) continue;
    if (one->awaits_confirmation() && !changes_modes_only(*content_)) {
      return refuse({Errc::conflict, "waits_for_confirmation"},
                    "generation " + std::to_string(one->generations().back()),
                    "waits to be confirmed, so nothing of it is changed meanwhile",
                    "mauvectl undo " + std::to_string(one->generations().back()) +
                        " rolls it back; mauvectl confirm keeps all changes on probation");
    }
    if (one->rollback()->rolls_back()) return being_rolled_back(one->generations().back());
    if (changes_modes_only(*content_)) continue;
    before_.push_back(one->rollback());
    if (!can_join(*content_, one->content())) continue;
    heritage_.add(*one);
    if (Status there = follow(*one); !there) return there;
  }
  return ok();
}

/// The members that only the change before changed are rolled back with the members of this one.
Status Commit::follow(const ProbationPeriod& before) {
  if (!content_->probation) content_->probation = before.content().probation;
  for (std::size_t i = 0; i < before.members().size(); ++i) {
    ComponentBase& component = *before.content().members[i].component;
    const auto same = [&](const PreparedMember& one) { return one.component == &component; };
    if (std::any_of(content_->members.begin(), content_->members.end(), same)) continue;
    content_->members.push_back(member_of(component, Mode::keep));
    content_->members.back().part = Part::follows;
    deployed_.push_back(before.members()[i].deployed);
    const Status ready = check_member(content_->members.back(), *deployed_.back());
    if (!ready) return ready;
  }
  return ok();
}

/// A member that waits at a barrier does not go back: there the probations of the changes before
/// end when the members are called.
Status Commit::end_probations_before() {
  for (const auto& before : std::exchange(before_, {})) {
    ProbationPeriod* const one = probation_of(system_, *before);
    if (one == nullptr || one->pass("a newer change", Outcome::Kind::overtaken)) continue;
    if (one->rollback()->closed()) {  // by a failure, which the next look ends
      one->overtake();
      continue;
    }
    return being_rolled_back(one->generations().back());
  }
  return ok();
}

Status Commit::let_in_new() {
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    if (deployed_[i] != nullptr) continue;
    Result<Deployed*> joining = let_in(system_, *content_->members[i].component);
    if (!joining) return joining.error();
    deployed_[i] = *joining;
  }
  return ok();
}

void Commit::let_go_new() {
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    if (deployed_[i] == nullptr || content_->members[i].part != Part::joins) continue;
    static_cast<void>(let_go(system_, *std::exchange(deployed_[i], nullptr)));
  }
}

void Commit::add_standby(std::size_t index, const Deployed& deployed, TaskUpdate& next) {
  const Content& standby = content_->members[index].standby;
  if (standby == nullptr) return;
  PreparedMember& takes_over = standby->members.front();
  next.standby = make_standby(takes_over, deployed.restarts.size());
  standby_cores_[index] = {standby, &takes_over, next.standby->answer};
}

Member Commit::make_member(std::size_t index, Deployed& deployed) {
  const PreparedMember& change = content_->members[index];
  Member member;
  member.task = deployed.task.get();
  member.next = make_update(change);
  member.next->number = number_;
  add_standby(index, deployed, *member.next);
  if (rollback_ != nullptr) add_rollback(change, deployed, *member.next);
  return member;
}

void Commit::add_rollback(const PreparedMember& change, Deployed& deployed, TaskUpdate& next) {
  Origin origin = origin_of(change, deployed.state() == ComponentState::running);
  const Origin* const before = heritage_.origin_of(*change.component);
  if (before != nullptr) origin = further_back(*before, origin, change);
  next.back = make_rollback(change, origin);
  next.rollback = rollback_.get();
  decide_by_rollback(*next.back);
  next.tolerated = content_->probation->misses;
  const unsigned window = std::min(content_->probation->window, 64U);
  next.window = window == 64 ? ~0ULL : (1ULL << window) - 1;
  MemberRollback& member = rollbacks_.emplace_back();
  member.deployed = &deployed;
  member.origin = std::move(origin);
  member.back = next.back.get();
  member.answer = next.back->answer;
  member.releases_before = deployed.task->counters().releases.load();
}

void Commit::decide_by_rollback(TaskUpdate& back) {
  back.decision = &rollback_->decision();
  back.rollback = rollback_.get();
  back.number = back_number_;
}

std::vector<ResourceMember> Commit::resource_members() const {
  std::vector<ResourceMember> resources;
  for (const PreparedResource& change : content_->resources) {
    resources.push_back({change.resource, change.parts, change.state, nullptr});
  }
  return resources;
}

void Commit::hold_members() {
  entered_.resize(deployed_.size());
  standby_cores_.resize(deployed_.size());
  for (Deployed* deployed : deployed_) {
    missed_before_.push_back(deployed->task->counters().missed.load());
    deployed->changing = true;
  }
}

void Commit::publish(TwoPhaseCommit::Kind kind, Duration longest_job) {
  std::vector<Member> members;
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    members.push_back(make_member(i, *deployed_[i]));
  }
  if (barrier_ != nullptr) {
    for (Member& bystander : barrier_->resume()) members.push_back(std::move(bystander));
  }
  late_jobs_.emplace(*system_.runner, deployed_);
  swap_ = std::make_unique<TwoPhaseCommit>(std::move(members), resource_members(), *system_.runner,
                                           longest_job, kind, before_);
  report_attempt();
}

bool Commit::advance() {
  if (over_) return true;
  if (swap_ == nullptr && !pass_barrier()) return over_;
  over_ = back_by_ != 0 ? all_went_back() : all_changed();
  if (over_) content_.reset();  // freed by the thread that prepared it
  return over_ || answered();
}

/// True when no member is left to wait for. The model shows a change whole and together with
/// its generation: when the model is saved meanwhile, the saved one is no mixture.
bool Commit::all_changed() {
  const bool settled = swap_->advance();
  report_attempt();
  if (!answered() && leaves_newest_in_place(system_, *this)) return false;
  // Behind a barrier no member is in a job.
  const bool late = barrier_ == nullptr && swap_->result().state == SwapResult::State::waiting;
  const bool shows = kind_ == TwoPhaseCommit::Kind::unconditional || settled;
  for (std::size_t i = 0; shows && i < deployed_.size(); ++i) {
    if (swap_->members()[i].settled && !entered_[i]) enter(i);
  }
  if (!answered() && (settled || late)) conclude();
  return settled && back_by_ == 0;
}

Result<Receipt> Commit::result() const {
  reported_ = answered();
  if (result_) return *result_;
  return refuse({Errc::wrong_state, "change_under_way"}, "commit", "is still under way",
                "call advance() until it is not");
}

std::vector<Deployed*> Commit::silent() const {
  std::vector<Deployed*> silent;
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    if (swap_ != nullptr && !swap_->members()[i].in_force) silent.push_back(deployed_[i]);
  }
  return silent;
}

}  // namespace mauve::exec
