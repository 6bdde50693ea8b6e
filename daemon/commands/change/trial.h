// SPDX-License-Identifier: LGPL-3.0-or-later
/// Code that is new to mauved is tried in a process of its own first.
#pragma once

#include <functional>
#include <string>

#include "commands/command.h"

namespace mauve::daemon {

/// [control] Makes all that `question` names in a process of its own. When that ends by itself,
/// `go_on` is called on [control]; its errors are not looked at, since the change finds them again
/// among the elements that run. When code of a plugin crashes, hangs or ends that process, the call
/// is answered so, and nothing has touched mauved.
/// `at`: the name of the file or plugin, for a refusal that knows no nearer place.
void try_out(Running& running, const CallPtr& call, const Question& question, const std::string& at,
             std::function<void()> go_on);

/// A file that names this plugin and nothing else.
[[nodiscard]] Question question_of_plugin(const std::string& name);

}  // namespace mauve::daemon
