// SPDX-License-Identifier: LGPL-3.0-or-later
/// config.get: the running system as a file. config.check: everything wrong with another one.
#include "arch/describe.h"
#include "arch/load.h"
#include "arch/value_json.h"
#include "commands/answer.h"
#include "supervisor.h"

namespace mauve::daemon {

Result<Json> export_architecture(Running& running, const Call& /*call*/) {
  const auto parked = [&](const ComponentBase& component) {
    return running.deployer.status(component.name()).state != ComponentState::running;
  };
  return Json{
      {"architecture", arch::to_json(arch::describe(running.architecture, running.catalog, parked,
                                                    running.supervisor.supervision()))}};
}

/// With a catalog of its own: nothing it loads or makes touches the running system.
Result<Json> check_architecture(Running& running, const Call& call) {
  plugin::Catalog catalog(running.catalog.directories());
  arch::Problems problems;
  static_cast<void>(arch::load(text_or(call.params, "text"), catalog, problems));
  Json errors = Json::array();
  for (const auto& problem : problems.sorted()) {
    errors.push_back({{"line", problem.where.line},
                      {"column", problem.where.column},
                      {"at", problem.error.at},
                      {"code", to_string(problem.error.code)},
                      {"message", problem.error.message},
                      {"hint", problem.error.hint}});
  }
  return Json{{"errors", std::move(errors)}};
}

}  // namespace mauve::daemon
