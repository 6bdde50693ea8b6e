// SPDX-License-Identifier: LGPL-3.0-or-later
/// The trace event format, in JSON, that Perfetto (ui.perfetto.dev) and Chrome open.
#pragma once

#include <ostream>

#include "mtrace/trace.h"

namespace mauve::ctl::mtrace {

/// One process, a thread for each component, the most urgent first: jobs with their states, waits
/// for locks and holds as slices, arrows from each change to its members, values of users as
/// counters.
void write_chrome(const Trace& trace, std::ostream& out);

}  // namespace mauve::ctl::mtrace
