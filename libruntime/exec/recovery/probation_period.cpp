// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/recovery/probation_period.h"

#include <algorithm>
#include <utility>

#include "exec/admission/membership.h"
#include "exec/admission/timing_model.h"
#include "exec/recovery/incident.h"
#include "exec/recovery/inherit.h"
#include "exec/swap/resource_update.h"
#include "exec/system/books.h"
#include "exec/system/report_control.h"
#include "model/job/keep_for_abandoned.h"

#include <mauve/host/architecture.h>

namespace mauve::exec {
namespace {

constexpr const char* kNewer = "a newer change";
constexpr const char* kFailed = "a core of it failed, and what a rule brought is not rolled back";

/// Does the resource have the parts that the change gave it?
bool in_force(const PreparedResource& change) {
  const ResourceBase& resource = *change.resource;
  return (change.parts.core == nullptr || resource.shared_core() == change.parts.core) &&
         (change.parts.bindings == nullptr || resource.shared_bindings() == change.parts.bindings);
}

/// `owner` is null for a member of a derived architecture.
template <typename Element>
void put_back(Architecture& architecture, Element& element, std::shared_ptr<Element> owner) {
  if (owner == nullptr) return architecture.add(element);
  architecture.own(std::move(owner));
}

/// Of the member that has run the fewest jobs. Without members no job proves the change.
std::uint64_t jobs_left(const std::vector<MemberRollback>& members, const Probation& rules) {
  const std::uint64_t jobs = rules.activations;
  std::uint64_t left = members.empty() ? jobs : 0;
  for (const MemberRollback& member : members) {
    const std::uint64_t releases = member.deployed->task->counters().releases.load();
    left = std::max(left, jobs - std::min(jobs, releases - member.releases_before));
  }
  return left;
}

std::string over_budget(const std::vector<MemberRollback>& members) {
  std::string text;
  for (const MemberRollback& member : members) {
    text += over_budget_in_words(member.deployed->task->counters().over_present_budget.load(),
                                 member.deployed->component->name());
  }
  return text;
}

}  // namespace

ProbationPeriod::ProbationPeriod(System& system, std::shared_ptr<Content> content,
                                 std::vector<MemberRollback> members,
                                 std::shared_ptr<Rollback> rollback, Retired replaced,
                                 std::uint64_t number, std::vector<std::uint64_t> joined)
    : system_(system),
      departed_(system.departed),
      content_(std::move(content)),
      members_(std::move(members)),
      rollback_(std::move(rollback)),
      replaced_(std::move(replaced)),
      generations_(std::move(joined)),
      number_(number),
      began_(system.runner->now()) {
  generations_.push_back(system.generation);
  for (const PreparedResource& change : content_->resources) {
    if (!in_force(change)) continue;
    ResourceParts before = change.base;
    if (change.parts.core == nullptr) before.core.reset();
    if (change.parts.bindings == nullptr) before.bindings.reset();
    updates_.push_back(std::make_unique<ResourceUpdate>(*change.resource, std::move(before),
                                                        change.state, rollback_->decision()));
  }
}

ProbationPeriod::~ProbationPeriod() {
  if (phase_ == Phase::over || (phase_ == Phase::withdrawing && all_quiescent())) return;
  // The system goes down: a member whose thread has ended uses nothing any more.
  const auto ended = [](const MemberRollback& member) { return member.deployed->ended; };
  if (std::all_of(members_.begin(), members_.end(), ended)) return;
  for (MemberRollback& member : members_) {
    keep_for_abandoned(std::shared_ptr<TaskUpdate>(std::move(member.withdrawn)));
  }
  keep_for_abandoned(rollback_);
}

bool ProbationPeriod::awaits_confirmation() const {
  return content_->probation->confirm_within > Duration{0} && open();
}

bool ProbationPeriod::advance() {
  if (phase_ == Phase::watching) watch();
  if (phase_ == Phase::going_back) go_back();
  if (phase_ == Phase::withdrawing && all_quiescent()) {
    for (auto& update : updates_) {
      if (!update->disarm()) return true;
    }
    updates_.clear();
    phase_ = Phase::over;
  }
  return phase_ != Phase::over;
}

void ProbationPeriod::watch() {
  if (rollback_->decided()) {
    phase_ = Phase::going_back;
    for (const MemberRollback& member : members_) {
      const std::string& name = member.deployed->task->name();
      const bool parks = member.in_force && member.origin.mode == Mode::park;
      if (parks && content_->ended_stops.contains(name)) system_.stops.stand_again(name);
    }
    for (const std::string& name : content_->ended_stops) system_.stops.end_for_good(name);
    system_.obey_stops();
    report_control(system_, TraceKind::rollback, content_->what, rollback_->decision().instant(),
                   number_);
    report_members(system_, *content_, number_);
    for (const MemberRollback& member : members_) system_.runner->wake(*member.deployed->task);
    return;
  }
  if (rollback_->closed()) {
    if (held_.expired()) {
      end(Outcome::Kind::overtaken, rollback_->only_undo() ? kFailed : kNewer);
    }
    return;
  }
  const Probation& rules = *content_->probation;
  const Duration passed{system_.runner->now() - began_};
  if (rules.confirm_within > Duration{0}) {
    if (passed >= rules.confirm_within) {
      static_cast<void>(undo("not confirmed within its time"));
    }
    return;
  }
  const bool all_proved = jobs_left(members_, rules) == 0;
  if ((all_proved || passed >= rules.time) && awaits_verdict()) return;
  if (all_proved) {
    static_cast<void>(
        pass(std::to_string(rules.activations) + " jobs without a fault" + over_budget(members_)));
  } else if (passed >= rules.time) {
    static_cast<void>(pass("its time passed without a fault" + over_budget(members_)));
  }
}

/// A core that is seldom released may have too few jobs for a verdict when its time has passed. A
/// member under suspicion gets twice as many more as a verdict takes for a core that is always too
/// slow.
bool ProbationPeriod::awaits_verdict() {
  bool waits = false;
  for (MemberRollback& member : members_) {
    const Task& task = *member.deployed->task;
    const std::uint64_t releases = task.counters().releases.load();
    if (member.last_release == 0) member.last_release = releases + 2 * Evidence::kJobs;
    waits = waits || (task.suspected() && releases < member.last_release);
  }
  return waits;
}

bool ProbationPeriod::undo(const std::string& reason) {
  if (phase_ != Phase::watching) return false;
  return rollback_->trigger(system_.runner->clock(), reason);
}

bool ProbationPeriod::pass(const std::string& reason, Outcome::Kind kind) {
  if (phase_ != Phase::watching || !held_.expired() || !rollback_->close()) return false;
  end(kind, reason);
  return true;
}

void ProbationPeriod::overtake() {
  if (phase_ != Phase::watching) return;
  static_cast<void>(rollback_->close());  // or a member that failed meanwhile does
  end(Outcome::Kind::overtaken, kNewer);
}

void ProbationPeriod::end(Outcome::Kind kind, const std::string& reason) {
  for (std::size_t i = 0; i < content_->members.size(); ++i) {
    PreparedMember& member = content_->members[i];
    if (member.part != Part::leaves) continue;
    if (member.owner != nullptr) retired_.keep(member.owner);
  }
  for (const std::string& name : content_->ended_stops) system_.stops.end_for_good(name);
  report(kind, reason);
  retire_kept(members_, *content_, retired_);
  retired_.merge(std::move(replaced_));
  withdraw();
  let_go_left();
}

void ProbationPeriod::pass_on_to(Content& heir, const std::vector<MemberRollback>& members) {
  static_cast<void>(rollback_->close());  // or a member that failed meanwhile does
  adopt(*content_, heir, members, retired_);
  heir.ended_stops.merge(std::exchange(content_->ended_stops, {}));
  retire_kept(members_, *content_, heir, members, retired_);
  replaced_.forget();
  withdraw();
}

std::shared_ptr<const void> ProbationPeriod::hold() {
  auto held = held_.lock();
  if (held == nullptr) held_ = held = std::make_shared<int>();
  return held;
}

OpenProbation ProbationPeriod::look() const {
  // Changes that joined may have the same members.
  const auto once = [](std::vector<std::string>& names, const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  OpenProbation open{generations_,
                     {},
                     Duration{system_.runner->now() - began_},
                     *content_->probation,
                     rollback_->rolls_back(),
                     jobs_left(members_, *content_->probation)};
  for (std::size_t i = 0; i < content_->members.size(); ++i) {
    const PreparedMember& member = content_->members[i];
    const Origin& origin = members_[i].origin;
    once(open.components, member.component->name());
    if (member.part == Part::leaves) once(open.removed, member.component->name());
    note_one_way(member.component->name(), *member.next->core, *origin.bundle->core, origin.state,
                 open.notes);
  }
  for (const PreparedResource& one : content_->resources) {
    once(open.components, one.resource->name());
    if (one.parts.core == nullptr) continue;
    note_one_way(one.resource->name(), *one.parts.core, *one.base.core, one.state, open.notes);
  }
  if (!content_->barrier) return open;
  for (const auto& one : content_->barrier->replacements) {
    note_replaced(*one.from, *one.into, one.state, open.notes);
  }
  return open;
}

/// Takes the rollbacks out of the mailboxes; each is freed after the next quiescent point of its
/// task.
void ProbationPeriod::withdraw() {
  phase_ = Phase::withdrawing;
  for (MemberRollback& member : members_) {
    Task& task = *member.deployed->task;
    if (task.mailbox().claim_rollback(*member.back)) member.withdrawn.reset(member.back);
    member.quiescent_after = task.mailbox().quiescent_count();
    system_.runner->wake(task);
  }
  retired_.keep(content_);
}

void ProbationPeriod::let_go_left() {
  for (std::size_t i = 0; i < content_->members.size(); ++i) {
    if (content_->members[i].part != Part::leaves) continue;
    static_cast<void>(let_go(system_, *members_[i].deployed));
  }
}

bool ProbationPeriod::all_quiescent() const {
  return std::all_of(members_.begin(), members_.end(), [&](const MemberRollback& member) {
    return !member.in_force || member.deployed->ended ||
           member.deployed->task->mailbox().quiescent_count() > member.quiescent_after;
  });
}

void ProbationPeriod::go_back() {
  const Instant now = system_.runner->now();
  for (auto& update : updates_) update->help(now);
  if (!rollback_->decided() || !all_are_back() || !may_let_go()) return;
  report(Outcome::Kind::rolled_back, culprit());
  install_old();
  retire_kept(members_, *content_, retired_);
  if (!quiet_) system_.outcomes.back().generation = ++system_.generation;
  replaced_.forget();
  retired_.keep(content_);
  for (MemberRollback& member : members_) {
    member.quiescent_after = member.deployed->task->mailbox().quiescent_count();
    system_.runner->wake(*member.deployed->task);
  }
  phase_ = Phase::withdrawing;
}

bool ProbationPeriod::all_are_back() const {
  const bool members = std::all_of(members_.begin(), members_.end(), [](const auto& member) {
    return !member.in_force ||
           member.answer->progress.load(std::memory_order_acquire) == TaskUpdate::Progress::done;
  });
  return members && std::all_of(updates_.begin(), updates_.end(),
                                [](const auto& update) { return update->settled(); });
}

/// An order to park may be on its way to a component that joined; its task is parked, so that is
/// over soon.
bool ProbationPeriod::may_let_go() const {
  for (std::size_t i = 0; i < content_->members.size(); ++i) {
    const bool leaves = members_[i].in_force && content_->members[i].part == Part::joins;
    if (leaves && members_[i].deployed->changing) return false;
  }
  return true;
}

/// The model shows the elements that callers and threads use again.
void ProbationPeriod::install_old() {
  ++system_.revision;
  Architecture& architecture = system_.architecture;
  for (std::size_t i = 0; i < content_->members.size(); ++i) {
    PreparedMember& member = content_->members[i];
    Deployed* const deployed = members_[i].deployed;
    if (!members_[i].in_force) continue;
    deployed->shown = number_;
    if (member.next != member.base) member.component->install(member.base);
    if (member.type) member.component->renew(*member.type);
    if (member.part == Part::leaves) {
      put_back(architecture, *member.component, std::exchange(member.owner, nullptr));
      deployed->hidden = false;
    }
    schedule(system_, *deployed);
    if (!is_timed_alike(*member.next, *member.base)) deployed->timed = system_.runner->now();
    retire(*member.next, *member.base, retired_);
    static_cast<void>(
        deployed->task->mailbox().reclaim());  // frees the updates before; their elements stay
    if (member.part != Part::joins) continue;
    static_cast<void>(architecture.take_out(*member.component));
    static_cast<void>(let_go(system_, *deployed));
  }
  for (const PreparedResource& change : content_->resources) {
    if (!in_force(change)) continue;
    change.resource->install(change.base.core, change.base.bindings);
    if (change.lock_budget) change.resource->lock().set_budget(change.base_lock_budget);
    if (change.parts.core != nullptr) retired_.add(change.parts.core);
  }
  exchange_fallbacks(architecture, content_->fallbacks);
  for (const auto& resource : content_->new_resources) {
    static_cast<void>(architecture.take_out(*resource));
  }
  for (std::size_t i = 0; i < content_->left_resources.size(); ++i) {
    put_back(architecture, *content_->leaving_resources[i], content_->left_resources[i]);
  }
}

void ProbationPeriod::report_after_all() {
  if (!std::exchange(quiet_, false)) return;
  generations_.back() = ++system_.generation;
}

std::string ProbationPeriod::culprit() const {
  const std::string text = rollback_->text();
  if (rollback_->cause() == Cause::asked) return text;
  return to_string(incident_of(system_, rollback_->fault()));
}

/// The new cores that failed. A resource that fails its caller is not the fault of the caller's
/// core.
void ProbationPeriod::name_cores(Outcome& end) const {
  if (end.incident && !end.incident->resource.empty()) return;
  for (const PreparedMember& member : content_->members) {
    const std::string& core = member.next->core_type.name;
    const bool is_new =
        member.part == Part::joins || is_other_code(*member.base->core, *member.next->core);
    if (is_new && member.component->name() == end.component) end.cores.push_back(core);
  }
}

void ProbationPeriod::report(Outcome::Kind kind, const std::string& reason) {
  if (quiet_) return;
  Outcome end;
  end.began = generations_.front();
  end.generations = generations_;
  end.generation = system_.generation;
  for (const auto& one : system_.probations) {
    if (one.get() == this || one->reported()) continue;
    const std::uint64_t first = one->generations_.front();
    end.oldest_open = end.oldest_open == 0 ? first : std::min(end.oldest_open, first);
  }
  end.kind = kind;
  end.reason = reason;
  if (kind == Outcome::Kind::rolled_back) {
    end.commit = Duration{rollback_->decision().instant() - system_.t0};
    for (const MemberRollback& member : members_) {
      if (&member.deployed->task->report() == rollback_->failed_member()) {
        end.component = member.deployed->task->name();
      }
    }
    if (!end.component.empty()) end.incident = incident_of(system_, rollback_->fault());
    name_cores(end);
  }
  system_.outcomes.push_back(std::move(end));
}

}  // namespace mauve::exec
