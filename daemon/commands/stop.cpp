// SPDX-License-Identifier: LGPL-3.0-or-later
/// component.stop: ends the current job, writes safe values, parks. Served before everything else,
/// also while a long change is prepared.
#include "commands/answer.h"
#include "commands/change.h"
#include "commands/model.h"

namespace mauve::daemon {

namespace {

Result<std::vector<std::string>> wanted(const Running& running, const Call& call) {
  auto names = texts(call.params, "components");
  const bool all = flag(call.params, "all");
  if (all == !names.empty()) {
    return refuse(Errc::invalid_value, "components",
                  all ? "names components and says all" : "names no component to stop",
                  "either components or all");
  }
  if (all) {
    for (const auto* component : running.architecture.components()) {
      names.push_back(component->name());
    }
  }
  for (const auto& name : names) {
    if (const auto component = find_component(running, name); !component) {
      return component.error();
    }
  }
  return names;
}

}  // namespace

void stop(Running& running, const CallPtr& call, Ticket /*none: it waits for no other change*/) {
  if (auto met = check_conditions(running, *call); !met) {
    return answer(running, *call, met.error());
  }
  const auto names = wanted(running, *call);
  if (!names) {
    return answer(running, *call, names.error());
  }
  for (const auto& name : *names) {
    ++running.stops[name];
  }
  auto stopping = flag(call->params, "all")
                      ? Result<std::shared_ptr<Ongoing>>(running.deployer.begin_stop_all())
                      : running.deployer.begin_stop(*names);
  if (!stopping) {
    return answer(running, *call, stopping.error());
  }
  when_answered(running, *std::move(stopping), [&running, call](Ongoing& done) {
    const auto receipt = done.result();
    if (!receipt) {
      return answer(running, *call, receipt.error(), "safe");
    }
    answer(running, *call, to_json(*receipt));
  });
}

}  // namespace mauve::daemon
