// SPDX-License-Identifier: LGPL-3.0-or-later
/// watch.subscribe and watch.unsubscribe: every new value of some addresses.
#include "monitor/watch.h"

#include "commands/answer.h"
#include "commands/command.h"

namespace mauve::daemon {

Result<Json> watch(Running& running, const Call& call) {
  const auto addresses = texts(call.params, "addresses");
  const auto sub = running.watches.subscribe(running, call.caller, addresses);
  if (!sub) {
    return sub.error();
  }
  return Json{{"sub", *sub}};
}

Result<Json> unwatch(Running& running, const Call& call) {
  const auto sub = call.params["sub"].get<std::uint64_t>();
  if (!running.watches.unsubscribe(call.caller, sub)) {
    return refuse({Errc::unknown_name, "unknown_subscription"}, "sub " + std::to_string(sub),
                  "this connection has no such subscription");
  }
  return Json{{"sub", sub}};
}

}  // namespace mauve::daemon
