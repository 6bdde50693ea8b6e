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

/// Collects the users of cores that are in quarantine.
class Losses {
 public:
  explicit Losses(const Running& running) : running_(running) {}

  void look_at(const std::string& user, const std::string& core) {
    const auto found = running_.quarantined.find(version_of(core, build_of(running_, core)));
    if (found != running_.quarantined.end()) {
      rows_.push_back({{"user", user}, {"core", core}, {"reason", found->second}});
    }
  }
  void look_at(const std::string& user, const rules::Steps& steps) {
    for (const auto& step : steps) {
      if (step.action == rules::Action::swap) {
        look_at(user, step.object);
      }
    }
  }
  [[nodiscard]] Json take() { return std::move(rows_); }

 private:
  const Running& running_;
  Json rows_ = Json::array();
};

/// A transaction that only rules apply is reported with its rules.
bool may_be_requested(const rules::Supervision& supervision, const std::string& transaction) {
  return std::ranges::any_of(supervision.may_request, [&](const auto& entry) {
    return std::ranges::find(entry.second, transaction) != entry.second.end();
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

bool quarantine(Running& running, const std::string& core, const std::string& reason) {
  MAUVE_ON_THREAD(control);
  const auto version = version_of(core, build_of(running, core));
  const bool fresh = running.quarantined.emplace(version, reason).second;
  if (fresh) {
    save(running);
    keep_out(running);
  }
  return fresh;
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

void CoresInQuarantine::replace(Names names) {
  const MutexLock lock(mutex_);
  names_ = std::move(names);
}

bool CoresInQuarantine::contains(const std::string& core) const {
  const MutexLock lock(mutex_);
  return names_.contains(core);
}

CoresInQuarantine::Names cores_kept_out(const Json& list, const plugin::Catalog& catalog) {
  CoresInQuarantine::Names cores;
  for (const auto& entry : list) {
    if (const auto core = text_or(entry, "core");
        text_or(entry, "build_id") == build_of(catalog, core)) {
      cores.insert(core);
    }
  }
  return cores;
}

void keep_out(const Running& running) {
  MAUVE_ON_THREAD(control);
  if (running.kept_out != nullptr) {
    running.kept_out->replace(cores_kept_out(listed(running), running.catalog));
  }
}

Json lost_to_quarantine(const Running& running) {
  MAUVE_ON_THREAD(control);
  if (running.quarantined.empty()) {
    return Json::array();
  }
  Losses losses(running);
  const auto& supervision = running.supervisor.supervision();
  for (const auto& rule : supervision.rules) {
    const auto* named = supervision.find(rule.transaction);
    losses.look_at("rule " + rule.name, named != nullptr ? *named : rule.steps);
  }
  for (const auto& [name, steps] : supervision.transactions) {
    if (may_be_requested(supervision, name)) {
      losses.look_at("transaction " + name, steps);
    }
  }
  for (const auto* component : running.architecture.components()) {
    if (const auto& fallback = component->fallback()) {
      losses.look_at("the fallback core of " + component->name(), fallback->core.name);
    }
  }
  return losses.take();
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
  keep_out(running);
  answer(running, *call,
         Json{{"core", core}, {"generation", running.generation.load()}, {"changed", true}});
}

}  // namespace mauve::daemon
