// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/change/plugin_members.h"

#include <map>
#include <optional>
#include <utility>

#include "commands/change/change.h"
#include "commands/model.h"
#include "mauve/host/architecture.h"
#include "mauve/host/component.h"
#include "mauve/host/resource.h"
#include "state/builds.h"

namespace mauve::daemon {

namespace {

template <typename T>
Status take_new(const std::map<std::string, T, std::less<>>& offered, std::optional<T>& type,
                const std::string& component) {
  if (!type) {
    return ok();
  }
  const auto found = offered.find(type->name);
  if (found == offered.end()) {
    return refuse({Errc::plugin_refused, "plugin_lacks_used_core"}, component,
                  "runs " + type->name + ", which the new file does not have any more",
                  "swap it for another one first");
  }
  type = found->second;
  return ok();
}

Status take_new_fallbacks(const plugin::LoadedPlugin& offered, Change& change) {
  for (auto& [component, fallback] : change.fallbacks) {
    const auto found = offered.cores.find(fallback->core.name);
    if (found == offered.cores.end()) {
      return refuse(
          {Errc::plugin_refused, "plugin_lacks_used_core"}, component,
          "falls back on " + fallback->core.name + ", which the new file does not have any more",
          "name another fallback_core in the file and apply it first");
    }
    fallback->core = found->second;
  }
  return ok();
}

/// "1.0.0 (build 3f2a91c4)"
std::string build_in_words(const plugin::PluginInfo& info) {
  return info.version + " (build " + short_build(info.build_id) + ")";
}

}  // namespace

Change members_of(const Running& running, const std::string& plugin, StatePolicy state) {
  Change change;
  for (const auto* component : running.architecture.components()) {
    const auto& bundle = *component->bundle();
    auto edit = edit_of(component->name());
    edit.state = state;
    if (plugin_of(bundle.core_type.name) == plugin) {
      edit.core = bundle.core_type;
    }
    if (plugin_of(bundle.fsm_type.name) == plugin) {
      edit.fsm = bundle.fsm_type;
    }
    if (plugin_of(component->type().name) == plugin) {
      edit.type = component->type();
    }
    if (const auto& fallback = component->fallback();
        fallback && plugin_of(fallback->core.name) == plugin) {
      edit.task = bundle.task;  // it takes part, so that a standby core of the old build goes
      change.fallbacks.push_back({component->name(), fallback});
    }
    if (edit.core || edit.fsm || edit.type || edit.task) {
      change.edits.push_back(std::move(edit));
    }
  }
  for (const auto* resource : running.architecture.resources()) {
    if (plugin_of(resource->type().name) != plugin) {
      continue;
    }
    auto edit = edit_of(resource->name());
    edit.state = state;
    edit.resource = resource->type();
    change.edits.push_back(std::move(edit));
  }
  return change;
}

Status take_new_types(const plugin::LoadedPlugin& offered, Change& change) {
  if (auto found = take_new_fallbacks(offered, change); !found) {
    return found;
  }
  for (auto& edit : change.edits) {
    auto found = take_new(offered.cores, edit.core, edit.member);
    if (found) {
      found = take_new(offered.fsms, edit.fsm, edit.member);
    }
    if (found) {
      found = take_new(offered.components, edit.type, edit.member);
    }
    if (found) {
      found = take_new(offered.resources, edit.resource, edit.member);
    }
    if (!found) {
      return found;
    }
  }
  return ok();
}

arch::Line line_of_build(const Running& running, const plugin::LoadedPlugin& offered) {
  const auto& info = offered.info();
  const auto* now = running.catalog.find(info.name);
  auto before = now == nullptr ? Value() : Value(build_in_words(now->info()));
  return arch::make_line("plugin", info.name, std::move(before), build_in_words(info));
}

}  // namespace mauve::daemon
