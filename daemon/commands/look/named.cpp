// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/look/named.h"

#include <algorithm>

#include "commands/answer.h"
#include "commands/model.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

std::vector<std::string> names_in(const Json& params, const char* name) {
  std::vector<std::string> names;
  for (auto& one : texts(params, name)) {
    if (std::find(names.begin(), names.end(), one) == names.end()) {
      names.push_back(std::move(one));
    }
  }
  return names;
}

bool is_away(const Running& running, const std::string& component) {
  if (running.architecture.find_component(component) != nullptr) {
    return false;
  }
  const auto open = running.deployer.probations();
  return std::ranges::any_of(open, [&component](const OpenProbation& one) {
    return std::ranges::find(one.removed, component) != one.removed.end();
  });
}

Result<std::vector<std::string>> components_meant(const Running& running, const Call& call,
                                                  const std::string& verb, Away away) {
  auto names = names_in(call.params, "components");
  const bool all = flag(call.params, "all");
  if (all == !names.empty()) {
    return refuse({Errc::invalid_value, "components_or_all"}, "components",
                  all ? "names components and says all" : "names no component to " + verb,
                  "either components or all");
  }
  if (all) {
    for (const auto* component : running.architecture.components()) {
      names.push_back(component->name());
    }
  }
  for (const auto& name : names) {
    const auto component = find_component(running, name);
    if (!component && (away == Away::refused || !is_away(running, name))) {
      return component.error();
    }
  }
  return names;
}

void say_already(const std::vector<std::string>& names, const char* state, Json& result) {
  if (!names.empty()) {
    result["already"] = names;
    result["already_state"] = state;
  }
}

}  // namespace mauve::daemon
