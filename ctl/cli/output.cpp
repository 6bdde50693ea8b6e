// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/output.h"

#include <utility>

#include "cli/files.h"

namespace mauve::ctl {

void report_output(Session& session, const std::string& report, Json facts,
                   const std::string& remarks) {
  const std::string file = session.arguments.one("-o,--output");
  if (file.empty()) {
    if (!report.empty()) session.screen.err << report << "\n" << remarks << std::flush;
    return;
  }
  facts["file"] = file;
  session.print(facts, (report.empty() ? "" : report + " to " + file + "\n") + remarks);
}

int write_output(Session& session, const std::string& text, const std::string& report, Json facts,
                 const std::string& remarks) {
  const std::string file = session.arguments.one("-o,--output");
  if (file.empty()) {
    session.screen.out << text << std::flush;
  } else if (const Status done = write_file(file, [&](std::ostream& out) { out << text; }); !done) {
    return session.fail(bad_file(done.error()));
  }
  report_output(session, report, std::move(facts), remarks);
  return 0;
}

}  // namespace mauve::ctl
