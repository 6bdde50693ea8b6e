// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/commit.h"

#include <algorithm>

#include "model/hand_over.h"

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

Error busy(const ResourceBase& resource) {
  return refuse(Errc::timed_out, resource.name(),
                "is held by a caller that does not leave it, so it was not changed",
                "look at `status`: a core that never returns holds its component");
}

/// Writes the safe value of a port that loses its service.
Status write_safe(ResourceBase& resource, const std::string& port) {
  const PortBase* found = resource.shell().find_port(port);
  const auto binding = resource.bindings()[found->index()];
  const Entry entry(resource.gate());
  if (!entry) return busy(resource);
  found->write_safe(binding->service());
  return ok();
}

Status rewire(System& system, PreparedResource& change) {
  ResourceBase& resource = *change.resource;
  for (const std::string& port : change.disconnect) {
    Status done = write_safe(resource, port);
    if (done) done = resource.disconnect(port);
    if (!done) return busy(resource);
  }
  for (const NewConnection& wanted : change.connect) {
    const Result<ServiceBase*> service = system.architecture.find_service(wanted.service);
    if (!service) return service.error();
    Status done = resource.connect(wanted.port, **service, (*service)->resource().keep_alive(),
                                   wanted.max_age);
    if (!done) return done;
  }
  return ok();
}

/// Under the resource's own lock, so between two accesses.
Status commit_resource(System& system, PreparedResource& change, MemberReceipt& receipt,
                       Retired& retired) {
  if (Status done = rewire(system, change); !done) return done;
  if (change.core == nullptr) return ok();
  const auto hand_over = plan_hand_over(change.resource->core(), *change.core, change.state);
  if (!hand_over) return hand_over.error();
  ResourceBase::Exchange exchange = change.resource->exchange_core(change.core, *hand_over);
  if (!exchange.done) return busy(*change.resource);
  change.made.forget();
  retired.add(std::move(exchange.old));
  receipt.bytes = exchange.bytes;
  receipt.pause = exchange.pause;
  return ok();
}

/// The elements of the old bundle that the new one does not use, in the order of dependency.
void retire(const PreparedMember& member, Retired& retired) {
  if (member.next->shell != member.base->shell) retired.add(member.base->shell);
  if (member.next->core != member.base->core) retired.add(member.base->core);
  if (member.next->fsm != member.base->fsm) retired.add(member.base->fsm);
}

}  // namespace

Commit::Commit(System& system, Content content, Swap::Kind kind, Duration longest_job)
    : system_(system), content_(std::move(content)) {
  for (const PreparedMember& member : content_->members) {
    deployed_.push_back(system_.find(member.component->name()));
  }
  if (Status sound = check(); !sound) {
    result_ = sound.error();
    over_ = true;
    content_.reset();
    return;
  }
  publish(kind, longest_job);
}

Status Commit::check() const {
  if (Status outside = refuse_in_job("deployer", "commit()"); !outside) return outside;
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    Status current = check_member(content_->members[i], *deployed_[i]);
    if (!current) return current;
  }
  return ok();
}

void Commit::publish(Swap::Kind kind, Duration longest_job) {
  entered_.resize(deployed_.size());
  if (deployed_.empty()) return;
  std::vector<Member> members;
  for (std::size_t i = 0; i < deployed_.size(); ++i) {
    Deployed& deployed = *deployed_[i];
    Member member;
    member.task = deployed.task.get();
    member.next = make_published(content_->members[i]);
    members.push_back(std::move(member));
    missed_before_.push_back(deployed.task->counters().missed.load());
    deployed.changing = true;
  }
  swap_ = std::make_unique<Swap>(std::move(members), *system_.runner, longest_job, kind);
}

bool Commit::advance() {
  if (over_) return true;
  over_ = swap_ == nullptr || swap_->advance();
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
  deployed_[index]->changing = deployed_[index]->parking = false;
  if (!settled.in_force) return;
  if (member.next != member.base) member.component->install(member.next);
  if (member.type) member.component->renew(*member.type);
  retire(member, retired_);
  member.made.forget();
  const std::uint64_t missed = deployed_[index]->task->counters().missed.load();
  receipt_.components.push_back(
      {member.component->name(), settled.pause, missed - missed_before_[index], settled.bytes});
}

void Commit::conclude() {
  const SwapResult swapped =
      swap_ != nullptr ? swap_->result()
                       : SwapResult{SwapResult::State::committed, system_.runner->now(), 1};
  const bool nothing_happened =
      swapped.state == SwapResult::State::missed || swapped.state == SwapResult::State::revoked;
  if (nothing_happened) {
    result_ = not_applied();
    return;
  }
  receipt_.state = ChangeState::applied;
  receipt_.commit = Duration{swapped.instant - system_.t0};
  receipt_.attempts = swapped.attempts;
  if (swapped.state != SwapResult::State::committed) {
    receipt_.generation = ++system_.generation;
    result_ = not_applied();
    return;
  }
  commit_resources();
}

void Commit::commit_resources() {
  Status done = ok();
  for (PreparedResource& resource : content_->resources) {
    MemberReceipt receipt{resource.resource->name(), Duration{0}, 0, 0};
    done = commit_resource(system_, resource, receipt, retired_);
    if (!done) break;
    receipt_.components.push_back(std::move(receipt));
  }
  if (!done && receipt_.components.empty()) {
    result_ = done.error();
    return;
  }
  receipt_.generation = ++system_.generation;
  if (done) {
    result_ = receipt_;
    return;
  }
  done.error().code = Errc::partly;
  done.error().message += "; the change is in force on all others";
  result_ = done.error();
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
    names += (names.empty() ? "" : ", ") + one->component->name();
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

void System::advance() {
  std::erase_if(under_way, [](const std::shared_ptr<Commit>& commit) {
    static_cast<void>(commit->advance());
    return commit->over();
  });
}

std::shared_ptr<Commit> begin_commit(System& system, PreparedChange& change, Swap::Kind kind,
                                     Duration longest_job) {
  system.advance();
  auto commit = std::make_shared<Commit>(system, change.share(), kind, longest_job);
  if (!commit->over()) system.under_way.push_back(commit);
  return commit;
}

}  // namespace mauve::exec
