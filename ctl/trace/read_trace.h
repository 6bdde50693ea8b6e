// SPDX-License-Identifier: LGPL-3.0-or-later
/// Traces of files, and those that the daemon has.
#pragma once

#include <string>
#include <variant>

#include "cli/output.h"
#include "cli/session.h"
#include "mtrace/convert.h"
#include "mtrace/trace.h"

namespace mauve::ctl {

[[nodiscard]] std::variant<mtrace::Trace, Fault> read_trace(const std::string& file);

enum class Live {
  newest,  ///< the trace that is on, else the one that ended last
  now,     ///< the present: the trace that is on, else the flight recorder
};

/// The recording of this name, page by page; without a name the live trace.
[[nodiscard]] std::variant<mtrace::Trace, Fault> read_live(Session& session,
                                                           const std::string& recording,
                                                           Live live = Live::newest);

/// The output of a command that writes a trace.
[[nodiscard]] OutputKind output_of(mtrace::Format format);

}  // namespace mauve::ctl
