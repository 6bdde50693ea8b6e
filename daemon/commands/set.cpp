// SPDX-License-Identifier: LGPL-3.0-or-later
/// param.set: properties of running components and resources, all in one change.
#include <algorithm>

#include "arch/value_json.h"
#include "commands/answer.h"
#include "commands/change.h"
#include "commands/model.h"
#include "commands/path_rule.h"

namespace mauve::daemon {

namespace {

/// Refused here, before anything is made: unknown address, wrong type, out of range.
Result<Value> accepted_value(const Running& running, const std::string& address, const Json& json) {
  const auto target = find_target(running, address);
  if (!target) {
    return target.error();
  }
  if (target->property == nullptr) {
    return refuse(Errc::unknown_name, address, "is no property, it cannot be set",
                  "mauvectl show " + target->element.name() + " lists the properties");
  }
  auto value = arch::from_json(json);
  if (!value) {
    value.error().at = address;
    return value.error();
  }
  if (auto good = target->property->accepts(*value); !good) {
    return good.error();
  }
  return value;
}

Result<Change> change_of(const Running& running, const Json& params) {
  const auto policy = state_policy(params);
  if (!policy) {
    return policy.error();
  }
  Change change;
  for (const auto& [address, json] : params["values"].items()) {
    auto value = accepted_value(running, address, json);
    if (!value) {
      return value.error();
    }
    const auto dot = address.find('.');
    const auto owner = address.substr(0, dot);
    auto edit = std::find_if(change.edits.begin(), change.edits.end(),
                             [&](const Edit& one) { return one.component == owner; });
    if (edit == change.edits.end()) {
      edit = change.edits.insert(edit, edit_of(owner));
      edit->state = *policy;
      edit->allows = path_rule(running.path_dirs);
    }
    edit->properties.emplace_back(address.substr(dot + 1), *std::move(value));
  }
  if (change.edits.empty()) {
    return refuse(Errc::invalid_value, "values", "names no property to set");
  }
  return change;
}

}  // namespace

void set(Running& running, const CallPtr& call, Ticket ticket) {
  auto change = change_of(running, call->params);
  if (!change) {
    return answer(running, *call, change.error());
  }
  apply(running, call, std::move(ticket), *std::move(change));
}

}  // namespace mauve::daemon
