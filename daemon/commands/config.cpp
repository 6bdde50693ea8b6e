// SPDX-License-Identifier: LGPL-3.0-or-later
/// config.get: the running system as a file. config.check: everything wrong with another one.
#include "arch/build/lost_names.h"
#include "arch/compare/describe.h"
#include "arch/text/value_json.h"
#include "commands/answer.h"
#include "commands/change/architecture.h"
#include "commands/model.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

Value described(const Running& running) {
  const auto& supervision = running.supervisor.supervision();
  return arch::describe(running.architecture, running.catalog, parked_now(running), supervision,
                        arch::lost_of(supervision, running.architecture, running.catalog));
}

Result<Json> export_architecture(Running& running, const Call& /*call*/) {
  return Json{{"architecture", arch::to_json(described(running))}};
}

/// In a process of its own: nothing that the file names is made here.
void check_architecture(Running& running, const CallPtr& call, Ticket /*none*/) {
  running.judge(
      asker_of(*call), question_of(running, *call),
      [&running, call](Result<Json> judged) { answer(running, *call, std::move(judged)); });
}

}  // namespace mauve::daemon
