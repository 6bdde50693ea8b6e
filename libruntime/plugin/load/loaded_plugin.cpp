// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/load/loaded_plugin.h"

#include "base/address.h"
#include "mauve/plugin.h"
#include "mauve/type.h"
#include "plugin/load/hold.h"

namespace mauve::plugin {

Result<LoadedPlugin> LoadedPlugin::of(std::shared_ptr<Library> library) {
  LoadedPlugin plugin(std::move(library));
  Status good = plugin.collect_cores();
  if (good) good = plugin.collect_fsms();
  if (good) good = plugin.collect_components();
  if (good) good = plugin.collect_resources();
  if (good) good = plugin.collect_types();
  for (const auto& [name, component] : plugin.components) {
    if (good) good = plugin.check_component(component);
  }
  if (!good) return good.error();
  return plugin;
}

Status LoadedPlugin::check_name(const std::string& name, const char* kind, bool used) const {
  const std::string prefix = info().name + "/";
  if (!name.starts_with(prefix) || !is_name(std::string_view(name).substr(prefix.size()))) {
    return refuse({Errc::invalid_value, "plugin_bad_name"}, name,
                  "is no name for a " + std::string(kind) + " of plugin " + info().name,
                  "names match [a-z][a-z0-9_]{0,63}; the plugin's own is put in front");
  }
  if (used) {
    return refuse({Errc::duplicate, "plugin_registers_twice"}, name,
                  "is registered twice as a " + std::string(kind) + " by plugin " + info().name);
  }
  return ok();
}

Status LoadedPlugin::collect_cores() {
  for (const CoreType& core : library_->declared().cores) {
    Status good = check_name(core.name, "core", cores.contains(core.name));
    if (!good) return good;
    cores[core.name] = {core.name, core.contract, keep(library_, core.make, core.name)};
  }
  return ok();
}

Status LoadedPlugin::collect_fsms() {
  for (const FsmType& fsm : library_->declared().fsms) {
    Status good = check_name(fsm.name, "state machine", fsms.contains(fsm.name));
    if (!good) return good;
    fsms[fsm.name] = {fsm.name, fsm.contract, keep(library_, fsm.make, fsm.name)};
  }
  return ok();
}

Status LoadedPlugin::collect_components() {
  for (const ComponentType& plain : library_->declared().components) {
    Status good = check_name(plain.name, "component", components.contains(plain.name));
    if (!good) return good;
    const FsmType fsm{plain.fsm.name, plain.fsm.contract,
                      keep(library_, plain.fsm.make, plain.fsm.name)};
    const ShellType shell{plain.shell.name, keep(library_, plain.shell.make, plain.name),
                          plain.shell.members};
    components[plain.name] = {plain.name, shell, fsm, plain.default_core};
    fsms.try_emplace(plain.name, fsm);
  }
  return ok();
}

Status LoadedPlugin::collect_resources() {
  for (const ResourceType& plain : library_->declared().resources) {
    Status good = check_name(plain.name, "resource", resources.contains(plain.name));
    if (!good) return good;
    const CoreType core{plain.core.name, plain.core.contract,
                        keep(library_, plain.core.make, plain.core.name)};
    const ShellType shell{plain.shell.name, keep(library_, plain.shell.make, plain.name),
                          plain.shell.members};
    resources[plain.name] = {plain.name, shell, core, keep(library_, plain.interface, plain.name)};
    cores.try_emplace(plain.name, core);
  }
  return ok();
}

Status LoadedPlugin::collect_types() {
  for (const DataType* type : library_->declared().types) {
    if (!is_revised_name(type->name)) {
      return refuse({Errc::invalid_value, "plugin_bad_name"}, type->name,
                    "is no name for a data type of plugin " + info().name,
                    "a described type is called like \"laser_scan/1\"");
    }
    if (!types.try_emplace(type->name, type).second) {
      return refuse({Errc::duplicate, "plugin_registers_twice"}, type->name,
                    "is registered twice as a data type by plugin " + info().name);
    }
  }
  return ok();
}

Status LoadedPlugin::check_component(const ComponentType& component) const {
  if (component.fsm.contract.shell != component.shell.name) {
    return refuse({Errc::type_mismatch, "plugin_other_shell"}, component.name,
                  "its state machine is for cores with another shell",
                  "register the shell that the contract class names");
  }
  const auto core = cores.find(component.default_core);
  if (core == cores.end()) {
    if (!component.default_core.starts_with(info().name + "/")) return ok();
    return refuse({Errc::unknown_name, "plugin_no_default_core"}, component.name,
                  "its default core " + component.default_core + " is not registered",
                  "add plugin.core<...>(...) for it");
  }
  if (core->second.contract != component.fsm.contract) {
    return refuse(
        {Errc::type_mismatch, "plugin_other_contract"}, component.name,
        "its default core " + component.default_core + " has contract " +
            core->second.contract.name + ", its state machine calls " + component.fsm.contract.name,
        "write `using Contract = BASE;` into BASE, the class that the state machine calls and the "
        "core derives from (mauve/core.h)");
  }
  return ok();
}

}  // namespace mauve::plugin
