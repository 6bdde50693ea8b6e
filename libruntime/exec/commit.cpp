// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/commit.h"

#include <algorithm>
#include <utility>

#include "exec/membership.h"
#include "exec/relief.h"

#include <mauve/job.h>

namespace mauve::exec {
namespace {

Status check_member(const PreparedMember& member, const Deployed& deployed) {
  if (deployed.changing) {
    return refuse(Errc::conflict, member.component->name(),
                  "has not ended the job it is in, and a change waits for that",
                  "try again; look at `status`: a core that never returns holds its component");
  }
  if (member.component->bundle() != member.base) {
    return refuse(Errc::conflict, member.component->name(),
                  "was changed by somebody else while this change was prepared", "try again");
  }
  return ok();
}

Status check_resource(const PreparedResource& change) {
  const ResourceBase& resource = *change.resource;
  if (resource.shared_core() == change.base.core &&
      resource.shared_bindings() == change.base.bindings) {
    return ok();
  }
  return refuse(Errc::conflict, resource.name(),
                "was changed by somebody else while this change was prepared", "try again");
}

}  // namespace

void retire(const Bundle& old, const Bundle& now, Retired& retired) {
  if (now.shell != old.shell) retired.add(old.shell);
  if (now.core != old.core) retired.add(old.core);
  if (now.fsm != old.fsm) retired.add(old.fsm);
}

void schedule(System& system, Deployed& deployed) {
  const TaskAttributes& task = deployed.component->bundle()->task;
  const bool moves = !task.cpus.empty() && task.cpus != deployed.cpus;
  if (!moves && task.priority == deployed.priority) return;
  if (moves) deployed.cpus = task.cpus;
  deployed.priority = task.priority;
  // Both were found possible when the change was prepared.
  static_cast<void>(system.runner->reschedule(*deployed.task, system.realtime ? task.priority : 0,
                                              deployed.cpus));
  deployed.realtime = system.realtime && system.runner->is_fifo(*deployed.task, task.priority);
}

Commit::Commit(System& system, Content content, Swap::Kind kind, Duration longest_job)
    : system_(system), content_(std::move(content)) {
  Status sound = check(kind);
  if (sound) sound = let_in_new();
  if (!sound) {
    refuse_all(std::move(sound.error()));
    return;
  }
  if (content_->probation) way_back_ = std::make_shared<WayBack>();
  hold_members();
  if (barrier_ == nullptr) {
    publish(kind, longest_job);
  } else {
    barrier_->begin(deployed_);
  }
}

/// Nothing has happened, and nothing will.
void Commit::refuse_all(Error error) {
  let_go_new();
  result_ = std::move(error);
  over_ = true;
  content_.reset();
}

Status Commit::check(Swap::Kind kind) {
  if (Status outside = refuse_in_job("deployer", "commit()"); !outside) return outside;
  for (const PreparedMember& member : content_->members) {
    if (member.part == Part::joins) {
      deployed_.push_back(nullptr);  // see let_in_new()
      continue;
    }
    deployed_.push_back(system_.find(*member.component));
    // What was led back but is not in the books yet can be ordered to park.
    const bool there = deployed_.back() != nullptr &&
                       (kind == Swap::Kind::order || !deployed_.back()->hidden);
    if (!there) {
      return refuse(Errc::conflict, member.component->name(),
                    "has left while this change was prepared", "look at `status`");
    }
    if (Status current = check_member(member, *deployed_.back()); !current) return current;
  }
  for (const PreparedResource& resource : content_->resources) {
    if (Status current = check_resource(resource); !current) return current;
  }
  if (content_->barrier) {
    barrier_ = std::make_unique<Barrier>(system_);
    if (Status ready = barrier_->check(*content_); !ready) return ready;
  }
  return check_probation(kind);
}

/// There is one way back at a time: the newest change ends the probation of the one before.
Status Commit::check_probation(Swap::Kind kind) {
  if (kind == Swap::Kind::order || system_.probation == nullptr) return ok();
  OnProbation& before = *system_.probation;
  if (before.awaits_confirmation()) {
    return refuse(Errc::conflict, "generation " + std::to_string(system_.generation),
                  "waits to be confirmed, so nothing else is changed meanwhile",
                  "confirm it, or undo it");
  }
  if (before.pass("a newer change", Outcome::Kind::overtaken)) {
    system_.fading.push_back(std::move(system_.probation));
    return ok();
  }
  return refuse(Errc::conflict, "generation " + std::to_string(system_.generation),
                "is being rolled back", "try again when it is over: see the log");
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

Member Commit::forth(std::size_t index, Deployed& deployed) {
  const PreparedMember& change = content_->members[index];
  Member member;
  member.task = deployed.task.get();
  member.next = make_published(change);
  if (way_back_ == nullptr) return member;
  const bool was_running = deployed.state() == ComponentState::running;
  member.next->back = make_way_back(change, was_running);
  member.next->back->transaction = &way_back_->transaction();
  member.next->back->way_back = way_back_.get();
  member.next->tolerated = content_->probation->misses;
  const unsigned window = std::min(content_->probation->window, 64U);
  member.next->window = window == 64 ? ~0ULL : (1ULL << window) - 1;
  ways_back_.push_back({&deployed, member.next->back.get(), member.next->back->answer,
                        deployed.task->counters().releases.load(), 0, nullptr});
  return member;
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
  for (Deployed* deployed : deployed_) {
    missed_before_.push_back(deployed->task->counters().missed.load());
    deployed->changing = true;
  }
}

void Commit::publish(Swap::Kind kind, Duration longest_job) {
  std::vector<Member> members;
  for (std::size_t i = 0; i < deployed_.size(); ++i) members.push_back(forth(i, *deployed_[i]));
  if (barrier_ != nullptr) {
    for (Member& bystander : barrier_->go_on()) members.push_back(std::move(bystander));
  }
  swap_ = std::make_unique<Swap>(std::move(members), resource_members(), *system_.runner,
                                 longest_job, kind);
}

bool Commit::advance() {
  if (over_) return true;
  if (swap_ == nullptr && !pass_barrier()) return over_;
  over_ = swap_->advance();
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    if (swap_->members()[i].settled && !entered_[i]) enter(i);
  }
  if (!answered() && (over_ || swap_->result().state == SwapResult::State::waiting)) conclude();
  if (over_) content_.reset();  // freed by whoever prepared it
  return over_ || answered();
}

/// The member's thread has answered: what it runs is what the model shows.
void Commit::enter(std::size_t index) {
  const Member& settled = swap_->members()[index];
  const SwapResult::State state = swap_->result().state;
  const bool another_attempt = !settled.in_force && (state == SwapResult::State::under_way);
  if (another_attempt) return;
  PreparedMember& member = content_->members[index];
  entered_[index] = true;
  deployed_[index]->parking = false;
  deployed_[index]->changing = settled.in_force && member.part == Part::leaves;
  if (!settled.in_force) return;
  if (member.next != member.base) member.component->install(member.next);
  if (member.type) {
    ComponentType before = member.component->type();
    member.component->renew(*std::exchange(member.type, std::move(before)));
  }
  schedule(system_, *deployed_[index]);
  system_.runner->look_again();
  // Where a lost thread is inside, it is freed when that has ended: see tend().
  const bool lost = system_.runner->has_lost(deployed_[index]->task.get());
  retire(*member.base, *member.next, lost ? system_.free : retired_);
  if (member.next != member.base) {
    system_.free.keep(std::exchange(deployed_[index]->relief, {}).content);
  }
  member.made.forget();
  const std::uint64_t missed = deployed_[index]->task->counters().missed.load();
  receipt_.components.push_back(
      {member.component->name(), settled.pause, missed - missed_before_[index], settled.bytes});
}

void Commit::enter_resources() {
  for (std::size_t i = 0; i < swap_->resources().size(); ++i) {
    const ResourceFlip& flip = *swap_->resources()[i].flip;
    if (flip.state() != ResourceFlip::State::in_force) continue;
    PreparedResource& change = content_->resources[i];
    change.resource->install(change.parts.core, change.parts.bindings);
    if (change.parts.core != nullptr) retired_.add(change.base.core);
    change.made.forget();
    receipt_.components.push_back({change.resource->name(), flip.pause(), 0, flip.bytes()});
  }
}

void Commit::conclude() {
  const SwapResult& swapped = swap_->result();
  const bool nothing_happened =
      swapped.state == SwapResult::State::missed || swapped.state == SwapResult::State::revoked;
  if (nothing_happened) {
    result_ = not_applied();
    return let_go_new();
  }
  enter_resources();
  receipt_.state = ChangeState::applied;
  receipt_.commit = Duration{swapped.instant - system_.t0};
  receipt_.attempts = swapped.attempts;
  receipt_.generation = ++system_.generation;
  receipt_.warnings = content_->warnings;
  if (barrier_ != nullptr) {
    barrier_->tell(receipt_);
    barrier_->end();
  }
  change_membership();
  if (swapped.state != SwapResult::State::committed) {
    result_ = not_applied();
    return;
  }
  result_ = receipt_;
  if (way_back_ != nullptr) return begin_probation();
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    if (content_->members[i].part != Part::leaves) continue;
    static_cast<void>(let_go(system_, *std::exchange(deployed_[i], nullptr)));
  }
}

/// What joined is part of the architecture now, what left is not; it stays alive with the content.
void Commit::change_membership() {
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    PreparedMember& member = content_->members[i];
    if (!entered_[i] || !swap_->members()[i].in_force) continue;
    if (member.part == Part::leaves) {
      member.owner = system_.architecture.take_out(*member.component);
      deployed_[i]->hidden = true;
      deployed_[i]->changing = false;
    }
  }
  // A member that hangs may still use what was to leave.
  const bool whole = swap_->result().state == SwapResult::State::committed;
  for (ResourceBase* resource : content_->leaving_resources) {
    if (!whole) break;
    content_->left_resources.push_back(system_.architecture.take_out(*resource));
  }
  for (const auto& resource : content_->new_resources) system_.architecture.own(resource);
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    PreparedMember& member = content_->members[i];
    if (member.part != Part::joins) continue;
    system_.architecture.own(member.owner);
    deployed_[i]->hidden = false;
  }
}

void Commit::begin_probation() {
  system_.probation = std::make_unique<OnProbation>(system_, content_, std::move(ways_back_),
                                                    std::move(way_back_), std::move(retired_));
}

Result<Receipt> Commit::result() const {
  if (result_) return *result_;
  return refuse(Errc::wrong_state, "commit", "is still under way",
                "call advance() until it is not");
}

std::vector<Deployed*> Commit::silent() const {
  std::vector<Deployed*> silent;
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    if (swap_ != nullptr && !swap_->members()[i].in_force) silent.push_back(deployed_[i]);
  }
  return silent;
}

Error Commit::not_applied() const {
  std::string names;
  for (const Deployed* one : silent()) {
    names += (names.empty() ? "" : ", ") + one->task->name();
  }
  for (const ResourceMember& one : swap_->resources()) {
    if (one.flip->state() == ResourceFlip::State::in_force) continue;
    names += (names.empty() ? "" : ", ") + one.resource->name();
  }
  if (swap_->members().empty()) {
    return refuse(Errc::timed_out, names,
                  "is held by a caller that does not leave it, so it was not changed",
                  "look at `status`: a core that never returns holds its component");
  }
  const std::string look = "look at `status`: a core that never returns holds its component";
  switch (swap_->result().state) {
    case SwapResult::State::missed:
      return refuse(Errc::timed_out, names,
                    "every attempt missed its instant: the machine is overloaded", "try again");
    case SwapResult::State::revoked:
      return refuse(Errc::timed_out, names,
                    "did not end its job within 2 s, so the change was taken back", look);
    case SwapResult::State::waiting:
      return refuse(Errc::partly, names, "did not end its job in time; it will obey when it does",
                    look);
    default:
      return refuse(Errc::partly, names,
                    "did not end its job within 2 s: the change is in force on the others only",
                    "stop the component that hangs");
  }
}

PreparedMember member_of(ComponentBase& component, Mode mode) {
  PreparedMember member;
  member.component = &component;
  member.base = component.bundle();
  member.next = component.bundle();
  member.mode = mode;
  return member;
}

/// Probations first: a stop may make a task forget the way back that it took.
void System::advance() {
  if (const ModelLock::Hold hold(model, std::try_to_lock); hold) look_after_itself();
  std::erase_if(under_way, [](const std::shared_ptr<Commit>& commit) {
    static_cast<void>(commit->advance());
    return commit->over();
  });
}

void System::look_after_itself() {
  if (probation != nullptr) {
    static_cast<void>(probation->advance());
    if (probation->told()) fading.push_back(std::move(probation));
  }
  std::erase_if(fading, [&](const std::unique_ptr<OnProbation>& one) {
    if (one->advance()) return false;
    free.merge(one->take_free());
    return true;
  });
  look_after_reliefs(*this);
  forget_departed();
}

std::shared_ptr<Commit> begin_commit(System& system, PreparedChange& change, Swap::Kind kind,
                                     Duration longest_job) {
  // What an order was made from is true now; a rollback that gets into the books would undo that.
  if (kind == Swap::Kind::transaction) system.advance();
  auto commit = std::make_shared<Commit>(system, change.share(), kind, longest_job);
  if (!commit->over()) system.under_way.push_back(commit);
  return commit;
}

}  // namespace mauve::exec
