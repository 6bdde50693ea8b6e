// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/recovery/quarantine.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include "commands/answer.h"
#include "commands/model.h"
#include "monitor/supervisor.h"
#include "state/state_store.h"

namespace mauve::daemon {

namespace {

/// "guidance/gap" -> "guidance/gap@BUILD_ID": another build is another version.
std::string version_of(const std::string& core, const std::string& build_id) {
  return core + "@" + build_id;
}

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

Status check_core(const Running& running, const std::string& component, const std::string& core) {
  return check_quarantine(running, component, core, build_of(running, core));
}

}  // namespace

std::string build_of(const Running& running, const std::string& core) {
  MAUVE_ON_THREAD(control);
  const auto* loaded = running.catalog.find(plugin_of(core));
  return loaded == nullptr ? std::string() : loaded->info().build_id;
}

bool quarantine(Running& running, const std::string& core, const std::string& reason) {
  MAUVE_ON_THREAD(control);
  const auto version = version_of(core, build_of(running, core));
  const bool fresh = running.quarantined.emplace(version, reason).second;
  if (fresh) {
    save(running);
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

Status check_quarantine(const Running& running, const std::string& component,
                        const std::string& core, const std::string& build_id) {
  MAUVE_ON_THREAD(control);
  const auto found = running.quarantined.find(version_of(core, build_id));
  if (found == running.quarantined.end()) {
    return ok();
  }
  return refuse(Errc::wrong_state, component + ".core",
                core + " is in quarantine, since it failed: " + found->second,
                "load a corrected build, or release it: mauvectl quarantine release " + core);
}

Status check_quarantine(const Running& running, const Change& change) {
  MAUVE_ON_THREAD(control);
  for (const auto& edit : change.edits) {
    if (!edit.core) {
      continue;
    }
    if (auto free = check_core(running, edit.component, edit.core->name); !free) {
      return free;
    }
  }
  for (const auto& joining : change.new_components) {
    const auto& component = *joining.component;
    const auto& core = component.bundle()->core_type.name;
    if (auto free = check_core(running, component.name(), core); !free) {
      return free;
    }
  }
  return ok();
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
  const auto released = std::erase_if(running.quarantined, [&](const auto& entry) {
    return entry.first.substr(0, entry.first.find('@')) == core;
  });
  if (released == 0) {
    return answer(running, *call,
                  refuse(Errc::unknown_name, core, "is not in quarantine",
                         "mauvectl quarantine lists what is"));
  }
  save(running);
  answer(running, *call,
         Json{{"core", core}, {"generation", running.generation.load()}, {"changed", true}});
}

}  // namespace mauve::daemon
