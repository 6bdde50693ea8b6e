// SPDX-License-Identifier: LGPL-3.0-or-later
/// The new bundle of one component, made beside the running one.
#include <array>

#include "exec/admission/placement.h"
#include "exec/prepare/afterwards.h"
#include "exec/prepare/edit_properties.h"
#include "exec/prepare/prepare_member.h"
#include "model/element/elements.h"
#include "model/element/hand_over.h"
#include "model/port/connection.h"
#include "rt/time/measured.h"

#include <mauve/detail/job.h>
#include <mauve/detail/port_base.h>
#include <mauve/fsm.h>
#include <mauve/host/resource.h>
#include <mauve/service.h>

namespace mauve::exec {
namespace {

/// Works out the new bundle of one component.
class MemberBuilder {
 public:
  MemberBuilder(const Afterwards& after, const Edit& edit, ComponentBase& component,
                std::shared_ptr<const Bundle> base, const ComponentType& type, bool configure)
      : after_(after),
        edit_(edit),
        component_(component),
        old_type_(type),
        kept_(std::move(base)),
        base_(*kept_),
        next_(std::make_shared<Bundle>(base_)),
        configure_(configure) {
    remake_shell_ = edit.type.has_value() || touches(edit, "shell");
    remake_core_ = remake_shell_ || edit.core.has_value() || touches(edit, "core");
    remake_fsm_ = remake_core_ || edit.fsm.has_value() || touches(edit, "fsm");
  }

  Result<PreparedMember> build() {
    for (const auto step :
         {&MemberBuilder::check, &MemberBuilder::make_shell, &MemberBuilder::make_core,
          &MemberBuilder::make_fsm, &MemberBuilder::connect, &MemberBuilder::set_task,
          &MemberBuilder::configure}) {
      if (Status done = (this->*step)(); !done) return done.error();
    }
    const bool other_code =
        is_other_code(*base_.core, *next_->core) || is_other_code(*base_.fsm, *next_->fsm);
    if (other_code) next_->measured = std::make_shared<rt::Measured>(next_->fsm->states().size());
    PreparedMember member;
    member.component = &component_;
    member.base = kept_;
    member.type = edit_.type;
    // Stopping and starting leave the bundle alone, so that `stop --all` does not overtake a change
    // that is being prepared.
    const bool only_mode =
        !remake_fsm_ && edit_.connect.empty() && edit_.disconnect.empty() && !edit_.task;
    member.next = only_mode ? member.base : next_;
    member.mode = edit_.mode;
    member.state = edit_.state;
    member.restart = edit_.mode == Mode::run;
    member.made = std::move(made_);
    return member;
  }

 private:
  Status check() {
    if (edit_.lock_budget) {
      return refuse({Errc::unsupported, "attribute_not_applicable"},
                    component_.name() + ".lock_budget", "is a component: only a resource is held",
                    "a job of it has a budget");
    }
    if (Status paths = check_paths(edit_, {"shell", "core", "fsm"}); !paths) return paths;
    if (!remake_core_) return ok();
    return check_state_survives(*base_.core, edit_);
  }

  Status make_shell() {
    if (!remake_shell_) return ok();
    Status done = make_element(component_.name() + ".shell", type().shell.make, next_->shell);
    if (done) done = copy_properties(*base_.shell, *next_->shell);
    if (done) done = set_properties(edit_, "shell", *next_->shell);
    if (done) done = keep_connections();
    return done;
  }

  /// The ports of a newer build may be others, or in another order.
  Status keep_connections() {
    auto table = std::make_shared<Bindings>(next_->shell->ports().size());
    for (const PortBase* old : base_.shell->ports()) {
      const auto& binding = (*base_.bindings)[old->index()];
      if (binding == nullptr) continue;
      const PortBase* same = next_->shell->find_port(old->name());
      if (same == nullptr) {
        return refuse({Errc::unknown_name, "unknown_port"}, old->address(),
                      "is connected, but the new shell has no such port", "disconnect it first");
      }
      if (Status fits = check_connection(*same, nullptr, binding->service()); !fits) return fits;
      (*table)[same->index()] = binding;
    }
    next_->bindings = std::move(table);
    return ok();
  }

  [[nodiscard]] const ComponentType& type() const { return edit_.type ? *edit_.type : old_type_; }

  Status make_core() {
    if (!remake_core_) return ok();
    if (edit_.core) next_->core_type = *edit_.core;
    if (edit_.fsm) next_->fsm_type = *edit_.fsm;
    const std::string at = component_.name() + ".core";
    Status done = check_contract(at, next_->core_type, next_->fsm_type, type().shell);
    if (done) done = make_element(at, next_->core_type.make, next_->core);
    if (done && !edit_.fsm && !edit_.type) {
      done = check_same_members(*base_.core, *next_->core, next_->core_type.contract);
    }
    if (done) done = prepare_hand_over(*base_.core, *next_->core, edit_.state);
    const bool same_type = !edit_.core || edit_.core->name == base_.core_type.name;
    const bool anew = edit_.core && edit_.values == Values::defaults;
    if (done && same_type && !anew) done = copy_properties(*base_.core, *next_->core);
    if (done && !same_type) done = keep_values(*base_.core, edit_, *next_->core);
    if (done) done = set_properties(edit_, "core", *next_->core);
    if (done) next_->core->bind(*next_->shell);
    return done;
  }

  Status make_fsm() {
    if (!remake_fsm_) return ok();
    if (edit_.fsm) next_->fsm_type = *edit_.fsm;
    const std::string at = component_.name() + ".fsm";
    Status done = check_contract(at, next_->core_type, next_->fsm_type, type().shell);
    if (done) done = make_element(at, next_->fsm_type.make, next_->fsm);
    if (done) done = copy_properties(*base_.fsm, *next_->fsm);
    if (done) done = set_properties(edit_, "fsm", *next_->fsm);
    return done;
  }

  Status connect() {
    for (const std::string& port : edit_.disconnect) {
      auto table = without_connection(*next_->shell, *next_->bindings, port);
      if (!table) return table.error();
      next_->bindings = *std::move(table);
    }
    for (const NewConnection& wanted : edit_.connect) {
      const Result<ServiceBase*> service = after_.find_service(wanted.service);
      if (!service) return service.error();
      auto table = with_connection(*next_->shell, *next_->bindings, wanted.port, **service,
                                   (*service)->resource().keep_alive(), wanted.max_age);
      if (!table) return table.error();
      next_->bindings = *std::move(table);
    }
    return ok();
  }

  Status set_task() {
    if (!edit_.task) return ok();
    if (edit_.task->stack != base_.task.stack) {
      return refuse({Errc::unsupported, "fixed_at_creation"}, component_.name() + ".task.stack",
                    "is chosen when the thread is made", "remove the component and add it anew");
    }
    next_->task = *edit_.task;
    next_->task.start = base_.task.start;
    if (Status sound = check_cpus(next_->task, component_.name()); !sound) return sound;
    return after_.may_run_at(next_->task.priority);
  }

  /// With no port connected: a core that is being prepared can move nothing.
  Status configure() {
    if (remake_shell_) made_.add(next_->shell);
    if (remake_core_) made_.add(next_->core);
    if (remake_fsm_) made_.add(next_->fsm);
    if (!configure_) return remake_fsm_ ? check_machine(*next_->fsm) : ok();
    if (Status free = after_.may_open(component_.name(), *next_); !free) return free;
    const NoPorts no_ports;
    const std::array<Configurable*, 3> order{next_->shell.get(), next_->core.get(),
                                             next_->fsm.get()};
    return configure_in_order(order);
  }

  const Afterwards& after_;
  const Edit& edit_;
  ComponentBase& component_;
  const ComponentType& old_type_;
  const std::shared_ptr<const Bundle> kept_;  // also if its thread is abandoned
  const Bundle& base_;
  std::shared_ptr<Bundle> next_;
  Retired made_;
  bool configure_;
  bool remake_shell_ = false;
  bool remake_core_ = false;
  bool remake_fsm_ = false;
};

Result<PreparedMember> build_and_drop(std::unique_ptr<MemberBuilder> builder,
                                      const std::string& component) {
  auto member = builder->build();
  const Status dropped = drop_elements(component, [&] { builder.reset(); });
  if (member && !dropped) return dropped.error();
  return member;
}

}  // namespace

Result<PreparedMember> prepare_member(const Afterwards& after, const Edit& edit,
                                      ComponentBase& component, bool configure) {
  return build_and_drop(std::make_unique<MemberBuilder>(after, edit, component, component.bundle(),
                                                        component.type(), configure),
                        component.name());
}

Result<PreparedMember> prepare_standby(const Afterwards& after, const Edit& edit,
                                       const PreparedMember& brings) {
  ComponentBase& component = *brings.component;
  const ComponentType& type = brings.type ? *brings.type : component.type();
  return build_and_drop(
      std::make_unique<MemberBuilder>(after, edit, component, brings.next, type, true),
      component.name());
}

Result<PreparedMember> prepare_joining(const Afterwards& after, const NewComponent& joining) {
  ComponentBase& component = *joining.component;
  for (const NewConnection& wanted : joining.connect) {
    const Result<ServiceBase*> service = after.find_service(wanted.service);
    if (!service) return service.error();
    Status done = component.connect(wanted.port, **service, (*service)->resource().keep_alive(),
                                    wanted.max_age);
    if (!done) return done.error();
  }
  const TaskAttributes task = component.bundle()->task;  // configure() makes another bundle
  Status ready = check_cpus(task, component.name());
  if (ready) ready = after.may_run_at(task.priority);
  if (ready) ready = after.may_open(component.name(), *component.bundle());
  const NoPorts no_ports;
  if (ready) ready = component.configure();
  if (!ready) return ready.error();
  PreparedMember member = member_of(component, task.start ? Mode::run : Mode::keep);
  member.owner = joining.component;
  member.part = Part::joins;
  member.restart = true;
  return member;
}

}  // namespace mauve::exec
