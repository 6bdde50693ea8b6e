// SPDX-License-Identifier: LGPL-3.0-or-later
/// From the running system to another architecture, in one change.
#include "commands/answer.h"
#include "commands/change.h"

namespace mauve::daemon {

void apply_architecture(Running& running, const CallPtr& call, Ticket /*ticket*/,
                        std::string /*text*/, std::string /*reason*/) {
  answer(running, *call,
         refuse(Errc::unsupported, std::string(call->method->name),
                "this version cannot change a running system into another architecture",
                "start it: mauved FILE, with a file of the state directory"));
}

}  // namespace mauve::daemon
