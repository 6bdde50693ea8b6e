// SPDX-License-Identifier: LGPL-3.0-or-later
/// Traces of files, and those that the daemon has.
#pragma once

#include <string>
#include <variant>

#include "mtrace/trace.h"
#include "session.h"

namespace mauve::ctl {

[[nodiscard]] std::variant<mtrace::Trace, Fault> read_trace(const std::string& file);

/// The recording of this name, page by page; empty: the trace that runs, or ran last.
[[nodiscard]] std::variant<mtrace::Trace, Fault> read_live(Session& session,
                                                           const std::string& recording);

}  // namespace mauve::ctl
