// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/output.h"

#include <filesystem>
#include <utility>

#include "cli/files.h"

namespace mauve::ctl {

bool replaces_file(const Session& session) {
  const std::filesystem::path file = session.arguments.one("-o,--output");
  std::error_code none;
  // A trace in the form of CTF is a folder.
  return std::filesystem::is_regular_file(file, none) ||
         std::filesystem::is_regular_file(file / "metadata", none);
}

void report_output(Session& session, const std::string& report, Json facts, bool replaced,
                   const std::string& remarks) {
  const std::string file = session.arguments.one("-o,--output");
  if (file.empty()) {
    if (!report.empty()) session.screen.err << report << "\n" << remarks << std::flush;
    return;
  }
  facts["file"] = file;
  facts["replaced"] = replaced;
  const std::string way = replaced ? ", replacing the file of that name\n" : "\n";
  session.print(facts, (report.empty() ? "" : report + " to " + file + way) + remarks);
}

int write_output(Session& session, const std::string& text, const std::string& report, Json facts,
                 const std::string& remarks) {
  const std::string file = session.arguments.one("-o,--output");
  const bool replaced = replaces_file(session);
  if (file.empty()) {
    session.screen.out << text << std::flush;
  } else if (const Status done = write_file(file, [&](std::ostream& out) { out << text; }); !done) {
    return session.fail(bad_file(done.error()));
  }
  report_output(session, report, std::move(facts), replaced, remarks);
  return 0;
}

}  // namespace mauve::ctl
