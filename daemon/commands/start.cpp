// SPDX-License-Identifier: LGPL-3.0-or-later
/// component.start: the fsm at its initial state, on the next instant of the grid.
#include "commands/answer.h"
#include "commands/change.h"
#include "commands/model.h"

namespace mauve::daemon {

void start(Running& running, const CallPtr& call, Ticket ticket) {
  Change change;
  for (const auto& name : texts(call->params, "components")) {
    const auto component = find_component(running, name);
    if (!component) {
      return answer(running, *call, component.error());
    }
    if (running.deployer.status(name).state == ComponentState::running) {
      return answer(running, *call,
                    refuse(Errc::wrong_state, name, "is running already",
                           "mauvectl stop " + name + " first"));
    }
    auto edit = edit_of(name);
    edit.mode = Mode::run;
    if (flag(call->params, "reset")) {
      edit.core = (*component)->bundle()->core_type;
      edit.state = StatePolicy::drop;
    }
    change.edits.push_back(std::move(edit));
  }
  if (change.edits.empty()) {
    return answer(running, *call,
                  refuse(Errc::invalid_value, "components", "names no component to start"));
  }
  apply(running, call, std::move(ticket), std::move(change));
}

}  // namespace mauve::daemon
