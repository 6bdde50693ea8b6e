// SPDX-License-Identifier: LGPL-3.0-or-later
/// rules.list: the conditions that the rules wait for, and their firings.
#include "commands/answer.h"
#include "commands/lock.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

Result<Json> list_rules(Running& running, const Call& call) {
  auto rules = running.supervisor.list(text_or(call.params, "rule"));
  if (!rules) {
    return rules;
  }
  const auto held = held_rules(running);
  for (auto& rule : (*rules)["items"]) {
    const auto found = held.find(rule["name"].get<std::string>());
    rule["held"] = found == held.end() ? std::string_view() : found->second;
  }
  return rules;
}

}  // namespace mauve::daemon
