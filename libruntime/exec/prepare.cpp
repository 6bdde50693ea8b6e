// SPDX-License-Identifier: LGPL-3.0-or-later
/// Step 1 of a change: everything slow, and everything that can fail, beside the running system.
#include <algorithm>

#include "base/name.h"
#include "exec/system.h"
#include "model/connection.h"
#include "model/elements.h"
#include "model/hand_over.h"

#include <mauve/job.h>

namespace mauve::exec {
namespace {

/// "core.gain" -> {"core", "gain"}.
std::pair<std::string_view, std::string_view> split(std::string_view path) {
  const auto dot = path.find('.');
  return dot == std::string_view::npos ? std::pair{std::string_view{}, path}
                                       : std::pair{path.substr(0, dot), path.substr(dot + 1)};
}

bool touches(const Edit& edit, std::string_view element) {
  return std::any_of(edit.properties.begin(), edit.properties.end(),
                     [&](const auto& property) { return split(property.first).first == element; });
}

Error no_property(const Configurable& element, std::string_view name) {
  std::vector<std::string> names;
  for (const PropertyBase* known : element.properties()) names.emplace_back(known->name());
  const std::string nearest = nearest_name(name, names);
  return refuse(Errc::unknown_name, element.address() + "." + std::string(name),
                "there is no property of this name",
                nearest.empty() ? "" : "did you mean " + element.address() + "." + nearest + "?");
}

/// A remade element starts with the values of the one it replaces.
Status copy_properties(const Configurable& from, Configurable& into) {
  for (const PropertyBase* old : from.properties()) {
    PropertyBase* same = into.find_property(old->name());
    if (same == nullptr || !same_type(same->type(), old->type())) continue;
    if (same->type().to_value == nullptr) {
      return refuse(Errc::unsupported, old->address(), "its type has no description",
                    "describe it: specialise mauve::Described");
    }
    if (Status done = same->set(old->value()); !done) return done;
  }
  return ok();
}

Status set_properties(const Edit& edit, std::string_view name, Configurable& element) {
  for (const auto& [path, value] : edit.properties) {
    const auto [owner, property] = split(path);
    if (owner != name) continue;
    PropertyBase* found = element.find_property(property);
    if (found == nullptr) return no_property(element, property);
    if (Status done = found->set(value); !done) return done;
  }
  return ok();
}

Status check_paths(const Edit& edit, const std::vector<std::string_view>& elements) {
  for (const auto& [path, value] : edit.properties) {
    const auto owner = split(path).first;
    if (std::find(elements.begin(), elements.end(), owner) != elements.end()) continue;
    std::string list;
    for (const auto element : elements) list += (list.empty() ? "" : ", ") + std::string(element);
    return refuse(Errc::unknown_name, edit.component + "." + path, "is no property",
                  "properties that can change while it runs belong to: " + list);
  }
  return ok();
}

/// An integrator must not vanish silently.
Status check_state_survives(const CoreBase& core, const Edit& edit) {
  const bool same_core = !edit.core.has_value();
  if (!same_core || edit.state == StatePolicy::drop) return ok();
  if (core.state() != nullptr || core.slow_state() != nullptr || core.stateless()) return ok();
  return refuse(Errc::unsupported, core.address(),
                "declares neither a state to hand over nor that it has none, so this change would "
                "silently reset it",
                "say --state drop to start it fresh, or declare mauve::State or mauve::Stateless "
                "in the core");
}

/// Works out the new bundle of one component.
class MemberBuilder {
 public:
  MemberBuilder(System& system, const Edit& edit, ComponentBase& component, bool configure)
      : system_(system),
        edit_(edit),
        component_(component),
        base_(*component.bundle()),
        next_(std::make_shared<Bundle>(base_)),
        configure_(configure) {
    remake_shell_ = edit.type.has_value() || touches(edit, "shell");
    remake_core_ = remake_shell_ || edit.core.has_value() || touches(edit, "core");
    remake_fsm_ = remake_core_ || edit.fsm.has_value() || touches(edit, "fsm");
  }

  Result<PreparedMember> build() {
    for (const auto step :
         {&MemberBuilder::check, &MemberBuilder::make_shell, &MemberBuilder::make_core,
          &MemberBuilder::make_fsm, &MemberBuilder::connect, &MemberBuilder::configure}) {
      if (Status done = (this->*step)(); !done) return done.error();
    }
    PreparedMember member;
    member.component = &component_;
    member.base = component_.bundle();
    member.type = edit_.type;
    // Stopping and starting leave the bundle alone, so that `stop --all` does not overtake a change
    // that is being prepared.
    const bool only_mode = !remake_fsm_ && edit_.connect.empty() && edit_.disconnect.empty();
    member.next = only_mode ? member.base : next_;
    member.mode = edit_.mode;
    member.state = edit_.state;
    member.restart = edit_.mode == Mode::run;
    member.made = std::move(made_);
    return member;
  }

 private:
  Status check() {
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
        return refuse(Errc::unknown_name, old->address(),
                      "is connected, but the new shell has no such port", "disconnect it first");
      }
      if (Status fits = check_connection(*same, nullptr, binding->service()); !fits) return fits;
      (*table)[same->index()] = binding;
    }
    next_->bindings = std::move(table);
    return ok();
  }

  [[nodiscard]] const ComponentType& type() const {
    return edit_.type ? *edit_.type : component_.type();
  }

  Status make_core() {
    if (!remake_core_) return ok();
    if (edit_.core) next_->core_type = *edit_.core;
    if (edit_.fsm) next_->fsm_type = *edit_.fsm;
    const std::string at = component_.name() + ".core";
    Status done = check_contract(at, next_->core_type, next_->fsm_type, type().shell);
    if (done) done = make_element(at, next_->core_type.make, next_->core);
    if (done) done = prepare_hand_over(*base_.core, *next_->core, edit_.state);
    const bool same_type = !edit_.core || edit_.core->name == base_.core_type.name;
    if (done && same_type) done = copy_properties(*base_.core, *next_->core);
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
    if (done) next_->fsm->bind(*next_->core);
    return done;
  }

  Status connect() {
    for (const std::string& port : edit_.disconnect) {
      auto table = without_connection(*next_->shell, *next_->bindings, port);
      if (!table) return table.error();
      next_->bindings = *std::move(table);
    }
    for (const NewConnection& wanted : edit_.connect) {
      const Result<ServiceBase*> service = system_.architecture.find_service(wanted.service);
      if (!service) return service.error();
      auto table = with_connection(*next_->shell, *next_->bindings, wanted.port, **service,
                                   (*service)->resource().keep_alive(), wanted.max_age);
      if (!table) return table.error();
      next_->bindings = *std::move(table);
    }
    return ok();
  }

  /// With no port connected: a core that is being prepared can move nothing.
  Status configure() {
    if (remake_shell_) made_.add(next_->shell);
    if (remake_core_) made_.add(next_->core);
    if (remake_fsm_) made_.add(next_->fsm);
    if (!configure_) return ok();
    const Detached detached;
    const std::array<Configurable*, 3> order{next_->shell.get(), next_->core.get(),
                                             next_->fsm.get()};
    Status done = configure_in_order(order);
    if (done && remake_core_) {
      done = call_hook(next_->core->address(), "warm", [&] { return next_->core->warm(), ok(); });
    }
    return done;
  }

  System& system_;
  const Edit& edit_;
  ComponentBase& component_;
  const Bundle& base_;
  std::shared_ptr<Bundle> next_;
  Retired made_;
  bool configure_;
  bool remake_shell_ = false;
  bool remake_core_ = false;
  bool remake_fsm_ = false;
};

Status check_resource_connections(System& system, const Edit& edit, ResourceBase& resource) {
  for (const NewConnection& wanted : edit.connect) {
    const Result<ServiceBase*> service = system.architecture.find_service(wanted.service);
    if (!service) return service.error();
    auto table = with_connection(resource.shell(), resource.bindings(), wanted.port, **service,
                                 nullptr, wanted.max_age);
    if (!table) return table.error();
    if (Status nested = check_nesting(resource, (*service)->resource()); !nested) return nested;
  }
  for (const std::string& port : edit.disconnect) {
    auto table = without_connection(resource.shell(), resource.bindings(), port);
    if (!table) return table.error();
  }
  return ok();
}

Result<PreparedResource> prepare_resource(System& system, const Edit& edit,
                                          ResourceBase& resource) {
  PreparedResource prepared{&resource, nullptr, edit.connect, edit.disconnect, edit.state, {}};
  if (edit.mode != Mode::keep || edit.core || edit.fsm) {
    return refuse(Errc::unsupported, edit.component,
                  "is a resource: it has no thread to start or stop, and its core is replaced by "
                  "changing its properties only");
  }
  if (Status paths = check_paths(edit, {"core"}); !paths) return paths.error();
  if (Status sound = check_resource_connections(system, edit, resource); !sound) {
    return sound.error();
  }
  if (edit.properties.empty()) return prepared;
  Status done = check_state_survives(resource.core(), edit);
  if (done)
    done = make_element(resource.core().address(), resource.type().core.make, prepared.core);
  if (done) done = prepare_hand_over(resource.core(), *prepared.core, edit.state);
  if (done) done = copy_properties(resource.core(), *prepared.core);
  if (done) done = set_properties(edit, "core", *prepared.core);
  if (!done) return done.error();
  prepared.core->bind(resource.shell());
  prepared.made.add(prepared.core);
  const Detached detached;
  if (Status configured = prepared.core->configure(); !configured) return configured.error();
  return prepared;
}

Status check_once(const Change& change) {
  for (auto edit = change.edits.begin(); edit != change.edits.end(); ++edit) {
    const auto same = [&](const Edit& other) { return other.component == edit->component; };
    if (std::any_of(std::next(edit), change.edits.end(), same)) {
      return refuse(Errc::duplicate, edit->component, "is changed twice in one transaction");
    }
  }
  return ok();
}

}  // namespace

Result<PreparedChange> prepare_change(System& system, const Change& change, bool configure) {
  if (Status outside = refuse_in_job("deployer", "a change"); !outside) return outside.error();
  if (!system.up) {
    return refuse(Errc::wrong_state, system.architecture.name(), "is not deployed",
                  "before deployment change the elements themselves");
  }
  if (Status once = check_once(change); !once) return once.error();
  auto content = std::make_unique<PreparedChange::Content>();
  for (const Edit& edit : change.edits) {
    if (ResourceBase* resource = system.architecture.find_resource(edit.component)) {
      auto prepared = prepare_resource(system, edit, *resource);
      if (!prepared) return prepared.error();
      content->resources.push_back(*std::move(prepared));
      continue;
    }
    const Result<ComponentBase*> component = system.component(edit.component);
    if (!component) return component.error();
    auto member = MemberBuilder(system, edit, **component, configure).build();
    if (!member) return member.error();
    content->members.push_back(*std::move(member));
  }
  return PreparedChange(std::move(content));
}

}  // namespace mauve::exec
