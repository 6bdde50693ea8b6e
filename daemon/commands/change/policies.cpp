// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/change/policies.h"

#include "commands/answer.h"

namespace mauve::daemon {

Result<StatePolicy> state_policy(const Json& params) {
  const auto text = text_or(params, "state");
  if (text.empty()) {
    return StatePolicy::keep;
  }
  if (text == "drop") {
    return StatePolicy::drop;
  }
  return refuse({Errc::invalid_value, "not_a_choice"}, "state",
                "'" + text.substr(0, 64) + "' is no way to treat state",
                "leave it out to hand the state over, or say drop");
}

Result<std::optional<Sync>> sync_of(const Json& params) {
  const auto text = text_or(params, "sync");
  if (text.empty()) {
    return std::optional<Sync>();
  }
  if (text == "cut" || text == "barrier") {
    return std::optional(text == "cut" ? Sync::cut : Sync::barrier);
  }
  return refuse({Errc::invalid_value, "not_a_choice"}, "sync",
                "'" + text.substr(0, 64) + "' is no way to change together",
                "say cut or barrier, or leave it out");
}

}  // namespace mauve::daemon
