// SPDX-License-Identifier: LGPL-3.0-or-later
/// Code that is new to mauved is tried in a process of its own first.
#pragma once

#include <functional>
#include <string>

#include "commands/command.h"

namespace mauve::daemon {

/// [control] Has a process of its own make all that `question` names. If that process gives its
/// verdict, `then` is called on [control], also if the verdict names errors: the change finds them
/// again. If code of a plugin crashes, hangs or ends the process, the call is answered with a
/// refusal, and mauved is unaffected. `at`: the file or plugin that a refusal names if it names no
/// nearer place.
void try_out(Running& running, const CallPtr& call, const Question& question, const std::string& at,
             std::function<void()> then);

/// A file that names this plugin and nothing else.
[[nodiscard]] Question question_of_plugin(const std::string& name);

}  // namespace mauve::daemon
