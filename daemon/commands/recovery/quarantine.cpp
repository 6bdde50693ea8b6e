// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/recovery/quarantine.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include "commands/answer.h"
#include "commands/model.h"
#include "mauve/host/architecture.h"
#include "state/state_store.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

using logging::Event;

namespace {

/// "guidance/gap" -> "guidance/gap@BUILD_ID": another build is another version.
std::string version_of(const std::string& core, const std::string& build_id) {
  return core + "@" + build_id;
}

std::string core_of(const std::string& version) { return version.substr(0, version.find('@')); }

Json listed(const Running& running) {
  Json cores = Json::array();
  for (const auto& [version, reason] : running.quarantined) {
    const auto at = version.find('@');
    cores.push_back({{"core", version.substr(0, at)},
                     {"build_id", version.substr(at + 1)},
                     {"reason", reason}});
  }
  return cores;
}

void save(Running& running) {
  if (running.store != nullptr) {
    running.store->quarantine(listed(running));
  }
}

bool brings(const rules::Steps& steps, const std::string& core) {
  return std::ranges::any_of(steps, [&core](const rules::Step& step) {
    return step.action == rules::Action::swap && step.object == core;
  });
}

/// `at`: the place that gets the core, for example "control.core".
Status check_core(const Running& running, const std::string& at, const std::string& core,
                  const std::string& build_id) {
  const auto found = running.quarantined.find(version_of(core, build_id));
  if (found == running.quarantined.end()) {
    return ok();
  }
  return refuse({Errc::wrong_state, "core_in_quarantine"}, at,
                core + " is in quarantine, since it failed: " + found->second,
                "load a corrected build, or release it: mauvectl quarantine release " + core);
}

}  // namespace

std::string build_of(const Running& running, const std::string& core) {
  MAUVE_ON_THREAD(control);
  return build_of(running.catalog, core);
}

std::string build_of(const plugin::Catalog& catalog, const std::string& core) {
  const auto* loaded = catalog.find(plugin_of(core));
  return loaded == nullptr ? std::string() : loaded->info().build_id;
}

std::string reaction_with(const Running& running, const std::string& core) {
  MAUVE_ON_THREAD(control);
  const auto& supervision = running.supervisor.supervision();
  for (const auto& rule : supervision.rules) {
    if (brings(rule.steps, core)) {
      return "rule " + rule.name;
    }
  }
  for (const auto& [name, steps] : supervision.transactions) {
    if (brings(steps, core)) {
      return "transaction " + name;
    }
  }
  for (const auto* component : running.architecture.components()) {
    if (const auto& fallback = component->fallback(); fallback && fallback->core.name == core) {
      return "the fallback core of " + component->name();
    }
  }
  return {};
}

void quarantine(Running& running, const std::string& core, const std::string& reason) {
  MAUVE_ON_THREAD(control);
  if (const auto user = reaction_with(running, core); !user.empty()) {
    running.log.write(Event::quarantine_spared, {{"core", core}, {"text", reason}, {"by", user}});
    return;
  }
  const auto version = version_of(core, build_of(running, core));
  if (running.quarantined.emplace(version, reason).second) {
    save(running);
    running.log.write(Event::quarantined, {{"core", core}, {"text", reason}});
  }
}

void spare_reactions(Running& running) {
  MAUVE_ON_THREAD(control);
  const auto released = std::erase_if(running.quarantined, [&running](const auto& entry) {
    const auto core = core_of(entry.first);
    const auto user = reaction_with(running, core);
    if (!user.empty()) {
      running.log.write(Event::quarantine_spared,
                        {{"core", core}, {"text", entry.second}, {"by", user}});
    }
    return !user.empty();
  });
  if (released > 0) {
    save(running);
  }
}

void restore_quarantine(Running& running) {
  if (running.store == nullptr) {
    return;
  }
  for (const auto& entry : running.store->quarantined()) {
    running.quarantined.emplace(version_of(text_or(entry, "core"), text_or(entry, "build_id")),
                                text_or(entry, "reason"));
  }
}

Status check_quarantine(const Running& running, const Change& change, const BuildOf& build) {
  MAUVE_ON_THREAD(control);
  auto allowed = ok();
  const auto look_at = [&](const std::string& at, const std::string& core) {
    if (allowed) {
      allowed = check_core(running, at, core, build ? build(core) : build_of(running, core));
    }
  };
  for (const auto& edit : change.edits) {
    if (edit.core) {
      look_at(edit.member + ".core", edit.core->name);
    }
  }
  for (const auto& [component, fallback] : change.fallbacks) {
    if (fallback) {
      look_at(component + ".fallback_core", fallback->core.name);
    }
  }
  for (const auto& joining : change.new_components) {
    const auto& component = *joining.component;
    look_at(component.name() + ".core", component.bundle()->core_type.name);
    if (const auto& fallback = component.fallback()) {
      look_at(component.name() + ".fallback_core", fallback->core.name);
    }
  }
  return allowed;
}

bool is_in_quarantine(const Running& running, const std::string& core) {
  MAUVE_ON_THREAD(control);
  return running.quarantined.contains(version_of(core, build_of(running, core)));
}

std::string step_to_run(const Running& running, const ComponentStatus& component) {
  const auto& core = component.core;
  if (!is_in_quarantine(running, core)) {
    return "mauvectl start " + component.name;
  }
  return "mauvectl reload " + plugin_of(core) + ": a corrected build of " + core +
         ", which is in quarantine; or mauvectl quarantine release " + core +
         ", then mauvectl start " + component.name + " --reset";
}

std::set<std::string, std::less<>> cores_in(const Json& list, const plugin::Catalog& catalog) {
  std::set<std::string, std::less<>> cores;
  for (const auto& entry : list) {
    if (const auto core = text_or(entry, "core");
        text_or(entry, "build_id") == build_of(catalog, core)) {
      cores.insert(core);
    }
  }
  return cores;
}

Result<Json> list_quarantine(Running& running, const Call& /*call*/) {
  return Json{{"cores", listed(running)}};
}

void release_quarantine(Running& running, const CallPtr& call, Ticket /*none*/) {
  if (auto met = check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  const auto core = text_or(call->params, "core");
  const auto released = std::erase_if(
      running.quarantined, [&](const auto& entry) { return core_of(entry.first) == core; });
  if (released == 0) {
    return answer(running, *call,
                  refuse({Errc::unknown_name, "not_in_quarantine"}, core, "is not in quarantine",
                         "mauvectl quarantine lists what is"));
  }
  save(running);
  answer(running, *call,
         Json{{"core", core}, {"generation", running.generation.load()}, {"changed", true}});
}

}  // namespace mauve::daemon
