// SPDX-License-Identifier: LGPL-3.0-or-later
/// mauved --judge: the process in which a file is judged.
#pragma once

#include "options.h"

namespace mauve::daemon {

/// Reads a question from standard input, judges it under the limits of confine(), and writes the
/// answer, {"judgement":{...}} or {"refused":{...}}, to standard output. When code of a plugin ends
/// the process or is ended, the hook that it was in stands on standard error. [main] of that
/// process
[[nodiscard]] int judge_as_child(const Options& options);

}  // namespace mauve::daemon
