// SPDX-License-Identifier: LGPL-3.0-or-later
/// The output of a command goes into the file of --output, or to standard output.
#pragma once

#include <string>

#include "cli/session.h"

namespace mauve::ctl {

/// Does the file of --output exist, so that the output replaces it? To be asked before it is
/// written.
[[nodiscard]] bool replaces_file(const Session& session);
/// To the file of --output, or to standard output; then reports it. Returns the exit code.
int write_output(Session& session, const std::string& text, const std::string& report = {},
                 Json facts = Json::object(), const std::string& remarks = {});
/// "drew 12 values to drive.svg", or with --json the facts and the file; remarks are lines below.
/// `replaced` is the answer of replaces_file(). Where standard output is the picture, to standard
/// error.
void report_output(Session& session, const std::string& report, Json facts, bool replaced,
                   const std::string& remarks = {});

}  // namespace mauve::ctl
