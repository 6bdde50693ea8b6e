// SPDX-License-Identifier: LGPL-3.0-or-later
/// core.swap: another core behind the same contract, at a boundary, state handed over.
#include <algorithm>

#include "arch/compare/diff.h"
#include "arch/text/value_json.h"
#include "base/duration.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/change/change_in_place.h"
#include "commands/change/policies.h"
#include "commands/model.h"
#include "commands/path_rule.h"
#include "exec/system/prepared.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

namespace {

/// "gain" and "core.gain" mean the same here.
std::string property_path(const std::string& key) {
  return key.find('.') == std::string::npos ? "core." + key : key;
}

/// The budget is the processor time that a job of the new core may use. It stays as it was when the
/// request does not set it.
Status declare_budget(const ComponentBase& component, const Json& params, Edit& edit) {
  if (!params.contains("budget")) {
    return ok();
  }
  const auto budget = parse_duration(text_or(params, "budget"));
  if (!budget) {
    return refuse(reason_of(budget.error()), "budget", budget.error().message, budget.error().hint);
  }
  edit.task = component.bundle()->task;
  edit.task->budget = *budget;
  return ok();
}

Result<Edit> edit_from(const Running& running, const Json& params) {
  const auto component = find_component(running, text_or(params, "component"));
  if (!component) {
    return component.error();
  }
  auto core = running.catalog.core(text_or(params, "core"));
  if (!core) {
    return core.error();
  }
  const auto policy = state_policy(params);
  if (!policy) {
    return policy.error();
  }
  auto edit = edit_of((*component)->name());
  edit.core = *std::move(core);
  edit.state = *policy;
  edit.values = flag(params, "defaults") ? Values::defaults : Values::keep;
  edit.allows = path_rule(running.path_dirs);
  if (auto declared = declare_budget(**component, params, edit); !declared) {
    return declared.error();
  }
  if (const auto set = params.find("set"); set != params.end()) {
    for (const auto& [key, json] : set->items()) {
      auto value = arch::from_json(json);
      if (!value) {
        value.error().at = edit.member + "." + property_path(key);
        return value.error();
      }
      edit.properties.emplace_back(property_path(key), *std::move(value));
    }
  }
  return edit;
}

/// Reports two kinds of properties of the core before. Some differ, since the request asked for the
/// defaults of the new core; the new core does not have the others.
class Properties final : public ChangeHooks {
 public:
  Properties(const ComponentBase& component, const Edit& edit) {
    for (const auto* property : component.bundle()->core->properties()) {
      const std::string name(property->name());
      const auto set = [&](const auto& given) { return given.first == "core." + name; };
      if (std::ranges::none_of(edit.properties, set)) {
        before_.emplace_back(name, property->value());
      }
    }
  }
  Status check_prepared(PreparedChange& change) override {
    const auto& core = *change.content().members.front().next->core;
    for (const auto& [name, before] : before_) {
      const auto* next = core.find_property(name);
      if (next == nullptr) {
        gone_.push_back({{"name", name}, {"before", arch::to_json(before)}});
      } else if (!arch::same_value(before, next->value())) {
        differ_.push_back({{"name", name},
                           {"before", arch::to_json(before)},
                           {"after", arch::to_json(next->value())}});
      }
    }
    return ok();
  }
  void in_force(std::uint64_t /*generation*/) override {}
  void complete(Json& result) override {
    if (!differ_.empty()) {
      result["defaults"] = differ_;
    }
    if (!gone_.empty()) {
      result["gone"] = gone_;
    }
  }

 private:
  std::vector<std::pair<std::string, Value>> before_;
  Json differ_ = Json::array();
  Json gone_ = Json::array();
};

}  // namespace

void swap_core(Running& running, const CallPtr& call, Ticket ticket) {
  auto edit = edit_from(running, call->params);
  if (!edit) {
    return answer(running, *call, edit.error());
  }
  auto properties =
      std::make_shared<Properties>(*running.architecture.find_component(edit->member), *edit);
  apply_as_asked(running, call, std::move(ticket), {{*std::move(edit)}}, std::move(properties));
}

}  // namespace mauve::daemon
