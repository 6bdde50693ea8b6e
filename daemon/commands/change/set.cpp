// SPDX-License-Identifier: LGPL-3.0-or-later
/// param.set: properties of running components and resources and attributes of tasks, all in one
/// change.
#include <algorithm>

#include "arch/compare/task_attributes.h"
#include "arch/parse/part_of_value.h"
#include "arch/parse/unit_hint.h"
#include "arch/text/value_json.h"
#include "commands/answer.h"
#include "commands/change/change_in_place.h"
#include "commands/change/policies.h"
#include "commands/model.h"
#include "commands/path_rule.h"

namespace mauve::daemon {

namespace {

constexpr std::string_view kTaskPart = ".task.";

/// Refused here, before anything is made: unknown address, wrong type, out of range.
Result<Value> accepted_value(const Running& running, const std::string& address, const Json& json) {
  const auto target = find_target(running, address);
  if (!target) {
    return arch::part_not_set(running.architecture, address, json.dump(), target.error());
  }
  if (target->property == nullptr) {
    return refuse({Errc::unknown_name, "unknown_property"}, address,
                  "is no property, it cannot be set",
                  "mauvectl show " + target->element.name() +
                      " lists the properties; attributes of a task are set as COMPONENT.task.NAME");
  }
  auto value = arch::from_json(json);
  if (!value) {
    value.error().at = address;
    return value.error();
  }
  if (auto good = target->property->accepts(*value); !good) {
    return arch::with_unit(*target->property, *value, good.error());
  }
  return value;
}

/// The edit of the element that an address begins with.
Edit& edit_for(const Running& running, const std::string& address, StatePolicy policy,
               Change& change) {
  const auto owner = address.substr(0, address.find('.'));
  auto edit = std::find_if(change.edits.begin(), change.edits.end(),
                           [&](const Edit& one) { return one.member == owner; });
  if (edit == change.edits.end()) {
    edit = change.edits.insert(edit, edit_of(owner));
    edit->state = policy;
    edit->allows = path_rule(running.path_dirs);
  }
  return *edit;
}

/// "heater.task.budget": an attribute of a task, which is no property of an element.
Status set_attribute(const Running& running, const std::string& address, const Json& json,
                     Edit& edit) {
  const auto component = find_component(running, edit.member);
  if (!component) {
    return component.error();
  }
  if (!edit.task) {
    edit.task = (*component)->bundle()->task;
  }
  const auto at = edit.member + std::string(kTaskPart);
  return arch::set_attribute(*edit.task, at.substr(0, at.size() - 1), address.substr(at.size()),
                             json.dump());
}

Status add_value(const Running& running, const std::string& address, const Json& json, Edit& edit) {
  const auto rest = std::string_view(address).substr(edit.member.size());
  if (rest.starts_with(kTaskPart)) {
    return set_attribute(running, address, json, edit);
  }
  auto value = accepted_value(running, address, json);
  if (!value) {
    return value.error();
  }
  edit.properties.emplace_back(rest.substr(1), *std::move(value));
  return ok();
}

Result<Change> change_of(const Running& running, const Json& params) {
  const auto policy = state_policy(params);
  if (!policy) {
    return policy.error();
  }
  Change change;
  for (const auto& [address, json] : params["values"].items()) {
    auto& edit = edit_for(running, address, *policy, change);
    if (auto added = add_value(running, address, json, edit); !added) {
      return added.error();
    }
  }
  if (change.edits.empty()) {
    return refuse({Errc::invalid_value, "change_empty"}, "values", "names no property to set");
  }
  return change;
}

}  // namespace

void set(Running& running, const CallPtr& call, Ticket ticket) {
  auto change = change_of(running, call->params);
  if (!change) {
    return answer(running, *call, change.error());
  }
  apply_as_asked(running, call, std::move(ticket), *std::move(change));
}

}  // namespace mauve::daemon
