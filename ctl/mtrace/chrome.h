// SPDX-License-Identifier: LGPL-3.0-or-later
/// The trace event format, in JSON, that Perfetto (ui.perfetto.dev) and Chrome open.
#pragma once

#include <ostream>

#include "mtrace/trace.h"

namespace mauve::ctl::mtrace {

/// The output has one process, with a thread for each component, the most urgent first. Slices show
/// jobs with their states, waits for locks and holds. Arrows lead from each change to its members;
/// values of users are counters.
void write_chrome(const Trace& trace, std::ostream& out);

}  // namespace mauve::ctl::mtrace
