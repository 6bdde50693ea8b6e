// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/elements.h"

#include <vector>

namespace mauve {

Status check_contract(const std::string& at, const CoreType& core, const FsmType& fsm,
                      const ShellType& shell) {
  if (core.contract.name != fsm.contract.name) {
    return refuse(Errc::type_mismatch, at,
                  "core " + core.name + " fulfils contract " + core.contract.name +
                      ", but state machine " + fsm.name + " calls " + fsm.contract.name,
                  "choose a core of contract " + fsm.contract.name);
  }
  if (core.contract.fingerprint != fsm.contract.fingerprint || core.contract.shell != shell.name) {
    return refuse(
        Errc::type_mismatch, at,
        "core " + core.name + " was built with another header of contract " + core.contract.name,
        "rebuild its plugin with the headers of this runtime");
  }
  return ok();
}

void name_ports_in_trace(const Shell& shell) {
  const std::string& address = shell.address();
  const std::string owner = address.substr(0, address.find('.'));
  for (PortBase* port : shell.ports()) {
    port->name_in_trace(owner + "." + std::string(port->name()));
  }
}

Status check_machine(FsmBase& fsm) {
  if (fsm.configured()) return ok();
  if (Status built = fsm.configure(); !built) return built;
  return fsm.cleanup();
}

Status configure_in_order(std::span<Configurable* const> elements) {
  std::vector<Configurable*> configured;
  for (Configurable* element : elements) {
    if (element->configured()) continue;
    if (Status done = element->configure(); !done) {
      static_cast<void>(cleanup_in_reverse(configured));
      return done;
    }
    configured.push_back(element);
  }
  return ok();
}

Status cleanup_in_reverse(std::span<Configurable* const> elements) {
  Status first = ok();
  for (auto element = elements.rbegin(); element != elements.rend(); ++element) {
    Status done = (*element)->cleanup();
    if (first && !done) first = std::move(done);
  }
  return first;
}

}  // namespace mauve
