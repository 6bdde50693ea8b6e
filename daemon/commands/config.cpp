// SPDX-License-Identifier: LGPL-3.0-or-later
/// config.get: the running system as a file. config.check: everything wrong with another one.
#include "arch/describe.h"
#include "arch/load.h"
#include "arch/value_json.h"
#include "commands/answer.h"
#include "commands/architecture.h"
#include "commands/model.h"
#include "supervisor.h"

namespace mauve::daemon {

Value described(const Running& running) {
  return arch::describe(running.architecture, running.catalog, parked_now(running),
                        running.supervisor.supervision());
}

Result<Json> export_architecture(Running& running, const Call& /*call*/) {
  return Json{{"architecture", arch::to_json(described(running))}};
}

/// With a catalog of its own: nothing it loads or makes touches the running system.
Result<Json> check_architecture(Running& running, const Call& call) {
  plugin::Catalog catalog(running.catalog.directories());
  arch::Problems problems;
  static_cast<void>(arch::load(text_or(call.params, "text"), catalog, problems));
  return Json{{"errors", to_json(problems)}};
}

}  // namespace mauve::daemon
