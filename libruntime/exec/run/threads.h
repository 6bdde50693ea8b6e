// SPDX-License-Identifier: LGPL-3.0-or-later
/// Tasks as real-time threads on the monotonic clock.
#pragma once

#include <memory>

#include "exec/run/runner.h"

#include <mauve/host/machine.h>
#include <mauve/time.h>

namespace mauve::exec {

/// `assumed`: how late a thread wakes up at most, as admission assumes it.
[[nodiscard]] std::unique_ptr<Runner> make_threads(Duration assumed = MachineCosts{}.wake);

}  // namespace mauve::exec
