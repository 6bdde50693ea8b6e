// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/build/build.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "arch/build/check_rules.h"
#include "arch/compare/task_attributes.h"
#include "arch/parse/built_in.h"
#include "arch/parse/parts.h"
#include "arch/parse/resolve.h"
#include "arch/parse/unit_hint.h"
#include "base/name.h"
#include "mauve/host/architecture.h"
#include "model/component/wiring.h"
#include "model/element/elements.h"
#include "model/port/connection.h"
#include "model/resource/resource_graph.h"
#include "rt/thread/thread.h"

namespace mauve::arch {
namespace {

// The shell of a component that could not be made: connected only to see whether it could be.
class LooseShell {
 public:
  LooseShell() = default;
  explicit LooseShell(std::shared_ptr<Shell> shell) : shell_(std::move(shell)) {
    if (shell_ != nullptr) table_.resize(shell_->ports().size());
  }

  [[nodiscard]] bool made() const { return shell_ != nullptr; }
  [[nodiscard]] const Shell& shell() const { return *shell_; }
  Status connect(std::string_view port, ServiceBase& service, std::shared_ptr<void> keep_alive,
                 Duration max_age) {
    auto table = with_connection(*shell_, table_, port, service, std::move(keep_alive), max_age);
    if (!table) return table.error();
    table_ = **table;
    return ok();
  }

 private:
  std::shared_ptr<Shell> shell_;
  Bindings table_;
};

class Builder {
 public:
  Builder(const Spec& spec, const plugin::Catalog& catalog, Problems& problems)
      : spec_(spec), catalog_(catalog), problems_(problems), resolver_(spec, catalog, problems) {}

  std::unique_ptr<Architecture> run(rules::Supervision* supervision, LostNames lost) {
    for (const ResourceSpec& resource : spec_.resources) make(resource);
    for (const ComponentSpec& component : spec_.components) make(component);
    for (const auto& [spec, resource] : resources_) connect(*spec, resource);
    for (const auto& [spec, component] : components_) connect(*spec, component);
    for (auto& [spec, shell] : loose_) connect(*spec, shell.made() ? &shell : nullptr);
    check_cycles();
    check_writers();
    Problems lost_names;
    auto& on_rules = lost == LostNames::kept && problems_.empty() ? lost_names : problems_;
    auto checked = check_rules(spec_, *architecture_, catalog_, on_rules);
    if (supervision != nullptr) *supervision = std::move(checked);
    return problems_.empty() ? std::move(architecture_) : nullptr;
  }

 private:
  void make(const ResourceSpec& spec) {
    std::optional<ResourceParts> parts = resolver_.resource(spec);
    if (!parts) return loose_.push_back({&spec, {}});
    auto resource = parts->type ? std::make_unique<ResourceBase>(spec.name, *std::move(parts->type))
                                : make_built_in(spec.type.value, spec.name, std::move(parts->data));
    if (!resource->made()) return problems_.add(spec.type.where, resource->made().error());
    set_properties(spec.name, spec.properties, parts_of(*resource));
    if (spec.lock_budget) resource->lock().set_budget(spec.lock_budget->value);
    resources_.emplace_back(&spec, &architecture_->own(std::move(resource)));
  }

  void make(const ComponentSpec& spec) {
    check_cpus(spec);
    ComponentParts parts = resolver_.component(spec);
    auto fallback_core = fallback(spec, parts);
    if (!parts.complete()) return check_parts(spec, parts);
    parts.type->fsm = *parts.fsm;
    auto component = std::make_unique<ComponentBase>(spec.name, *parts.type, *parts.core);
    if (!component->made()) {
      refuse_part(spec, parts, component->made().error());
      return check_parts(spec, parts);
    }
    set_properties(spec.name, spec.properties, parts_of(*component));
    check(component->fsm(), spec);
    component->fall_back_to(std::move(fallback_core));
    write_attributes(spec.task, component->task());
    component->task().start = spec.start;
    components_.emplace_back(&spec, &architecture_->own(std::move(component)));
  }

  /// Reports the error for which a start would refuse this state machine.
  void check(FsmBase& fsm, const ComponentSpec& spec) {
    if (Status sound = check_machine(fsm); !sound) {
      problems_.add(spec.fsm ? spec.fsm->where : spec.type.where, std::move(sound.error()));
    }
  }

  // Reports the CPUs that the deployer would refuse on this machine.
  void check_cpus(const ComponentSpec& spec) {
    for (const int cpu : spec.task.cpus.value) {
      Status usable = rt::check_cpu(cpu, spec.name + ".task.cpus");
      if (!usable) problems_.add(spec.task.cpus.where, std::move(usable.error()));
    }
  }

  // Reports the error of this part, which could not be made, and leaves the part out.
  void refuse_part(const ComponentSpec& spec, ComponentParts& parts, const Error& error) {
    Position where = spec.type.where;
    if (error.at.ends_with(".core")) {
      if (spec.core) where = spec.core->where;
      parts.core.reset();
    } else if (error.at.ends_with(".fsm")) {
      if (spec.fsm) where = spec.fsm->where;
      parts.fsm.reset();
    } else {
      parts.type.reset();
    }
    problems_.add(where, error);
  }

  // A component that cannot be made: its known parts are checked all the same.
  void check_parts(const ComponentSpec& spec, ComponentParts& parts) {
    std::shared_ptr<Shell> shell;
    std::shared_ptr<CoreBase> core;
    std::shared_ptr<FsmBase> fsm;
    const auto make = [&](const char* part, const auto& maker, auto& into) {
      Status made = make_element(spec.name + part, maker, into);
      if (!made) refuse_part(spec, parts, made.error());
    };
    if (parts.type) make(".shell", parts.type->shell.make, shell);
    if (parts.core) make(".core", parts.core->make, core);
    if (parts.fsm) make(".fsm", parts.fsm->make, fsm);
    set_properties(spec.name, spec.properties,
                   {{{"shell", shell.get()}, {"core", core.get()}, {"fsm", fsm.get()}}});
    if (parts.fsm) check(*fsm, spec);
    loose_.push_back({&spec, LooseShell(std::move(shell))});
  }

  // The fallback core is made once, to check that it can be made and that it accepts its values.
  std::optional<ComponentBase::Fallback> fallback(const ComponentSpec& spec,
                                                  const ComponentParts& parts) {
    if (!spec.fallback) return std::nullopt;
    std::optional<CoreType> type = resolver_.fallback(spec, parts.fsm);
    if (!type) return std::nullopt;
    const std::string at = spec.name + ".fallback_core";
    std::shared_ptr<CoreBase> core;
    Status made = make_element(at, type->make, core);
    if (made && parts.complete()) made = check_contract(at, *type, *parts.fsm, parts.type->shell);
    if (!made) {
      problems_.add(spec.fallback->core.where, std::move(made.error()));
      return std::nullopt;
    }
    core->adopt(at + ".core");
    const Parts only_core{{{"core", core.get()}}};
    set_properties(at, spec.fallback->properties, only_core);
    ComponentBase::Fallback fallback{*std::move(type), {}};
    for (const PropertySpec& property : spec.fallback->properties) {
      const PropertyBase* const found = find_property(only_core, property.name);
      if (found != nullptr) fallback.properties.emplace_back(property.name, found->value());
    }
    return fallback;
  }

  void set_properties(const std::string& name, const std::vector<PropertySpec>& properties,
                      const Parts& parts) {
    for (const PropertySpec& property : properties) {
      if (is_of_missing_part(parts, property.name)) continue;
      PropertyBase* const found = find_property(parts, property.name);
      if (found == nullptr) {
        problems_.add(property.where, {Errc::unknown_name, "unknown_property"},
                      name + "." + property.name, name + " has no property of this name",
                      did_you_mean(property.name, property_names(parts), "\""));
      } else if (Status done = found->set(property.value); !done) {
        problems_.add(property.value_where,
                      with_unit(*found, property.value, std::move(done.error())));
      }
    }
  }

  // Null: ports are not known, only the services can be checked.
  template <typename Owner>
  void connect(const ElementSpec& spec, Owner* owner) {
    for (const ConnectionSpec& connection : spec.connections) {
      ServiceBase* const service = find_service(spec, connection);
      if (owner == nullptr) continue;
      if (service == nullptr) {
        if (auto known = find_port(owner->shell(), connection.port); !known) {
          problems_.add(connection.where, std::move(known.error()));
        }
        continue;
      }
      const PortBase* const port = owner->shell().find_port(connection.port);
      if (connection.max_age && port != nullptr && port->signature().kind != PortKind::read) {
        problems_.add(connection.where, {Errc::invalid_value, "file_key_without_meaning"},
                      port->address(), "\"max_age\" has no meaning here: only read ports have it");
        continue;
      }
      Status done = owner->connect(connection.port, *service, service->resource().keep_alive(),
                                   connection.max_age.value_or(Duration{0}));
      // A port that the file connects twice is a key twice: reported with its first place already.
      if (!done && done.error().code != Errc::duplicate) {
        problems_.add(connection.where, std::move(done.error()));
      }
    }
  }

  // Null when there is none; reported, unless its resource was refused and reported already.
  ServiceBase* find_service(const ElementSpec& spec, const ConnectionSpec& connection) {
    const std::string resource = connection.service.substr(0, connection.service.find('.'));
    const bool refused = architecture_->find_resource(resource) == nullptr &&
                         std::any_of(spec_.resources.begin(), spec_.resources.end(),
                                     [&](const ResourceSpec& r) { return r.name == resource; });
    if (refused) return nullptr;
    Result<ServiceBase*> service = architecture_->find_service(connection.service);
    if (service) return *service;
    Error& error = service.error();
    problems_.add(connection.service_where, reason_of(error),
                  spec.name + ".ports." + connection.port,
                  connection.service + ": " + error.message, error.hint);
    return nullptr;
  }

  void check_cycles() {
    Status sound = ResourceGraph(*architecture_).check();
    if (sound) return;
    const auto found = std::find_if(
        spec_.resources.begin(), spec_.resources.end(),
        [&](const ResourceSpec& resource) { return resource.name == sound.error().at; });
    problems_.add(found == spec_.resources.end() ? Position{} : found->where,
                  std::move(sound.error()));
  }

  void check_writers() {
    auto errors = Wiring(*architecture_).errors();
    Devices devices;  // all of them are new
    for (const ComponentBase* component : architecture_->components()) {
      const auto bundle = component->bundle();
      devices.put(component->name(), *bundle->shell, *bundle->core, true);
    }
    std::ranges::move(devices.errors(), std::back_inserter(errors));
    for (Error& error : errors) {
      const Position where = place_of(error.at);
      problems_.add(where, std::move(error));
    }
  }

  /// Of a port or a property in the file.
  [[nodiscard]] Position place_of(const std::string& at) const {
    Position where;
    const auto find = [&](const auto& elements) {
      for (const auto& [spec, element] : elements) {
        for (const ConnectionSpec& connection : spec->connections) {
          if (spec->name + ".ports." + connection.port == at) where = connection.where;
        }
        for (const PropertySpec& property : spec->properties) {
          if (spec->name + "." + property.name == at) where = property.where;
        }
      }
    };
    find(resources_);
    find(components_);
    return where;
  }

  const Spec& spec_;
  const plugin::Catalog& catalog_;
  Problems& problems_;
  Resolver resolver_;
  std::vector<std::pair<const ResourceSpec*, ResourceBase*>> resources_;
  std::vector<std::pair<const ComponentSpec*, ComponentBase*>> components_;
  std::vector<std::pair<const ElementSpec*, LooseShell>> loose_;  // of refused components
  std::unique_ptr<Architecture> architecture_ = std::make_unique<Architecture>(spec_.name);
};

}  // namespace

std::unique_ptr<Architecture> build(const Spec& spec, const plugin::Catalog& catalog,
                                    Problems& problems, rules::Supervision* supervision,
                                    LostNames lost) {
  return Builder(spec, catalog, problems).run(supervision, lost);
}

}  // namespace mauve::arch
