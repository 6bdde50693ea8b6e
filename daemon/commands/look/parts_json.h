// SPDX-License-Identifier: LGPL-3.0-or-later
/// Ports, services and state machines as they are sent on the wire. [control]
#pragma once

#include "commands/model.h"
#include "mauve/fsm.h"

namespace mauve::daemon {

/// {"name","kind","type","service"}; the service is null where it is not connected.
[[nodiscard]] Json port_row(const Element& element, const PortBase& port);

/// So the age of its value is known: other services would run their core for it.
[[nodiscard]] bool reads_shared_data(const Element& element, const PortBase& port);

/// {"name","kind","type"}
[[nodiscard]] Json service_row(const ServiceBase& service);
[[nodiscard]] Json service_rows(const ResourceBase& resource);

/// {"initial","states":[{"name","kind","wait_ns","transitions":[{"to","guarded","guard"}]}]};
/// transitions in the order in which guards are asked, the transition that needs no guard last.
[[nodiscard]] Json machine_json(const FsmBase& fsm);

/// [{"address","text"}]: connections of the running system that may be a mistake. [control]
[[nodiscard]] Json wiring_notes(const Running& running);

}  // namespace mauve::daemon
