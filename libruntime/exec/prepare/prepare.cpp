// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/prepare/prepare.h"
#include "exec/prepare/afterwards.h"
#include "exec/prepare/prepare_barrier.h"
#include "exec/prepare/prepare_member.h"
#include "exec/prepare/prepare_resource.h"
#include "exec/system/report_control.h"

#include <algorithm>
#include <array>

#include "base/name.h"
#include "exec/admission/admission.h"
#include "exec/prepare/edit_properties.h"
#include "exec/prepare/renew.h"
#include "exec/recovery/standby.h"
#include "exec/swap/bystanders.h"
#include "exec/swap/rewired.h"
#include "model/element/elements.h"
#include "model/element/state_transfer.h"
#include "model/job/abandonable_thread.h"

#include <mauve/detail/job.h>
#include <mauve/detail/port_base.h>
#include <mauve/host/architecture.h>
#include <mauve/host/resource.h>
#include <mauve/service.h>

namespace mauve::exec {
namespace {

template <typename Items, typename Name>
bool contains(const Items& items, const Name& wanted) {
  return std::find(items.begin(), items.end(), wanted) != items.end();
}

/// Leaving and joining elements are checked separately: the same name may do both.
Status check_names(const System& system, const Change& change) {
  std::vector<std::string> changed;
  std::vector<std::string> joining;
  for (const Edit& edit : change.edits) {
    if (contains(changed, edit.member)) {
      return refuse({Errc::duplicate, "changed_twice"}, edit.member,
                    "is changed twice in one change");
    }
    changed.push_back(edit.member);
  }
  for (const auto& one : change.new_resources) joining.push_back(one.resource->name());
  for (const auto& one : change.new_components) joining.push_back(one.component->name());
  for (std::size_t i = 0; i < joining.size(); ++i) {
    const std::string& name = joining[i];
    const bool twice = std::count(joining.begin(), joining.end(), name) > 1;
    const bool there = system.architecture.find_component(name) != nullptr ||
                       system.architecture.find_resource(name) != nullptr;
    if (twice || (there && !contains(change.remove, name))) {
      return refuse({Errc::duplicate, "name_in_use"}, name,
                    "there is something of this name already",
                    "choose another name, or remove the other one in the same change");
    }
  }
  for (const std::string& name : change.remove) {
    if (contains(changed, name) ||
        std::count(change.remove.begin(), change.remove.end(), name) > 1) {
      return refuse({Errc::duplicate, "changed_twice"}, name,
                    "is removed and changed in the same change");
    }
  }
  return ok();
}

Status check_worth(const Change& change) {
  const bool empty = change.edits.empty() && change.new_resources.empty() &&
                     change.new_components.empty() && change.remove.empty();
  if (!empty || change.changes_rules) return ok();
  return refuse({Errc::invalid_value, "change_empty"}, "change",
                "is empty: it says nothing that is to be different");
}

class Preparation {
 public:
  Preparation(System& system, const Change& change)
      : system_(system),
        change_(change),
        after_(system, change),
        content_(std::make_unique<PreparedChange::Content>()) {}

  Result<PreparedChange> run(bool configure) {
    content_->revision = system_.revision;
    if (configure) content_->made_from = change_.made_from;  // else the component is parked by then
    content_->what = what_of(change_);
    content_->sets = set_by(change_);
    content_->probation = change_.probation;
    content_->changes_rules = change_.changes_rules;
    content_->ends_stops = change_.ends_stops;
    content_->stops = change_.stops;
    content_->stopped_by = change_.stopped_by;
    content_->in_place = !configure;
    if (change_.sync == Sync::barrier) content_->barrier.emplace();
    for (const auto step : {&Preparation::let_leave, &Preparation::let_resources_join,
                            &Preparation::let_components_join}) {
      if (Status done = (this->*step)(); !done) return done.error();
    }
    for (const Edit& edit : change_.edits) {
      if (Status done = change(edit, configure); !done) return done.error();
    }
    if (Status fits = check_fit(system_.architecture, *content_); !fits) return fits.error();
    auto admitted = admit_change(system_, *content_);
    if (!admitted) return admitted.error();
    content_->warnings = *std::move(admitted);
    warn_of_new(rewired(system_.architecture, *content_).notes());
    content_->fallbacks = change_.fallbacks;
    if (Status done = make_standby_cores(configure); !done) return done.error();
    if (content_->barrier) content_->barrier->waits = waits_of(system_, *content_);
    return make_prepared(system_.architecture, std::move(content_));
  }

 private:
  Status let_leave() {
    for (const std::string& name : change_.remove) {
      if (ResourceBase* resource = system_.architecture.find_resource(name)) {
        content_->leaving_resources.push_back(resource);
        continue;
      }
      const Result<ComponentBase*> component = system_.component(name);
      if (!component) return component.error();
      PreparedMember member = member_of(**component, Mode::park);
      member.part = Part::leaves;
      content_->members.push_back(std::move(member));
    }
    return ok();
  }

  Status let_resources_join() {
    for (const NewResource& joining : change_.new_resources) {
      content_->new_resources.push_back(joining.resource);
    }
    for (const NewResource& joining : change_.new_resources) {
      Status done = content_->barrier ? prepare_replacement(system_, joining, *content_) : ok();
      if (done) done = prepare_joining(after_, joining);
      if (!done) return done;
    }
    return ok();
  }

  Status let_components_join() {
    for (const NewComponent& joining : change_.new_components) {
      auto member = prepare_joining(after_, joining);
      if (!member) return member.error();
      content_->members.push_back(*std::move(member));
    }
    return ok();
  }

  Status change(const Edit& edit, bool configure) {
    if (ResourceBase* resource = system_.architecture.find_resource(edit.member)) {
      auto prepared = prepare_resource(after_, edit, *resource);
      if (!prepared) return prepared.error();
      content_->resources.push_back(*std::move(prepared));
      return ok();
    }
    const Result<ComponentBase*> component = system_.component(edit.member);
    if (!component) return component.error();
    auto member = prepare_member(after_, edit, **component, configure);
    if (!member) return member.error();
    content_->members.push_back(*std::move(member));
    return ok();
  }

  /// A standby core that cannot be made does not delay the change: [control] tries again, and
  /// reports it, once the change is in force.
  Status make_standby_cores(bool configure) {
    if (!configure) return ok();  // a swap in place configures nothing beside the running core
    for (PreparedMember& member : content_->members) {
      const std::optional<Edit> edit = standby_of(system_, *content_, member);
      if (!edit) continue;
      auto standby = prepare_standby(after_, *edit, member);
      if (!standby && abandoned_here()) return standby.error();
      if (!standby || !admit_standby(system_, *content_, *standby)) continue;
      auto content = std::make_shared<PreparedChange::Content>();
      content->members.push_back(*std::move(standby));
      member.standby = std::move(content);
    }
    return ok();
  }

  void warn_of_new(const std::vector<Wiring::Note>& notes) {
    const std::vector<Wiring::Note> known = Wiring(system_.architecture).notes();
    for (const Wiring::Note& note : notes) {
      if (!contains(known, note)) content_->warnings.push_back(to_string(note));
    }
  }

  System& system_;
  const Change& change_;
  Afterwards after_;
  std::unique_ptr<PreparedChange::Content> content_;
};

bool holds_state(const CoreBase& core) {
  return core.declared_state() != nullptr || core.declared_slow_state() != nullptr ||
         dynamic_cast<const ValueStore*>(&core) != nullptr;
}

/// The elements whose states `--state drop` would drop in this change.
std::vector<std::string> would_drop(const Architecture& architecture, const Change& change) {
  std::vector<std::string> names;
  const auto look = [&](const std::string& name, const CoreBase& core) {
    if (holds_state(core) && !contains(names, name)) names.push_back(name);
  };
  for (const Edit& edit : change.edits) {
    const bool core_goes =
        edit.core || edit.type || touches(edit, "core") || touches(edit, "shell");
    if (!core_goes || edit.state == StatePolicy::drop) continue;
    const ComponentBase* const component = architecture.find_component(edit.member);
    const ResourceBase* const resource = architecture.find_resource(edit.member);
    if (component != nullptr) look(edit.member, *component->bundle()->core);
    if (resource != nullptr) look(edit.member, resource->core());
  }
  for (const NewResource& joining : change.new_resources) {
    const ResourceBase* const before = architecture.find_resource(joining.resource->name());
    if (before != nullptr && joining.state != StatePolicy::drop) {
      look(before->name(), before->core());
    }
  }
  return names;
}

/// The refusals whose hints propose `--state drop`.
constexpr std::array<std::string_view, 6> kMendedByDrop{
    "state_would_be_lost", "state_not_convertible", "state_not_described",
    "state_not_declared",  "state_not_plain",       "resource_poisoned"};

/// A hint that proposes `--state drop` names the states that it would drop beside the one refused.
Error with_all_dropped(const Architecture& architecture, const Change& change, Error error) {
  if (!contains(kMendedByDrop, error.id)) return error;
  std::string others;
  for (const std::string& name : would_drop(architecture, change)) {
    if (name == error.at.substr(0, error.at.find('.'))) continue;
    others += (others.empty() ? "" : ", ") + name;
  }
  if (!others.empty()) {
    error.hint += "; --state drop is for the whole change, and also drops the state of: " + others;
  }
  return error;
}

/// `whole` becomes the change with all its consequences.
Result<PreparedChange> prepare_locked(System& system, const Change& change, Change& whole,
                                      Preparation& preparation, bool configure) {
  const ModelLock::Hold hold(system.model);
  if (!hold)
    return refuse({Errc::timed_out, "preparation_abandoned"}, "deployer",
                  "the change was dropped before it began, since its thread was abandoned");
  if (Status same = system.check_made_from(change.made_from); !same) return same.error();
  if (Status sound = check_names(system, change); !sound) return sound.error();
  if (Status made = put_as_replacements(system.architecture, whole); !made) return made.error();
  auto prepared = preparation.run(configure);
  if (!prepared) return with_all_dropped(system.architecture, whole, prepared.error());
  return prepared;
}

}  // namespace

Result<PreparedChange> prepare_change(System& system, const Change& change, bool configure) {
  if (Status outside = refuse_in_job("deployer", "a change"); !outside) return outside.error();
  if (!system.up) {
    return refuse({Errc::wrong_state, "not_deployed"}, system.architecture.name(),
                  "is not deployed", "before deployment change the elements themselves");
  }
  if (Status sound = check_worth(change); !sound) return sound.error();
  Change whole = change;
  auto preparation = std::make_unique<Preparation>(system, whole);
  auto prepared = prepare_locked(system, change, whole, *preparation, configure);
  if (prepared) return prepared;
  // The destructors of dropped elements run user code, without lock.
  static_cast<void>(drop_elements(system.architecture.name(), [&] {
    preparation.reset();
    whole = {};
  }));
  return prepared;
}

}  // namespace mauve::exec
