// SPDX-License-Identifier: LGPL-3.0-or-later
/// rules.list: the conditions that the rules wait for, and their firings.
#include "commands/answer.h"
#include "monitor/supervisor.h"

namespace mauve::daemon {

Result<Json> list_rules(Running& running, const Call& call) {
  return running.supervisor.list(text_or(call.params, "rule"));
}

}  // namespace mauve::daemon
