// SPDX-License-Identifier: LGPL-3.0-or-later
#include "actions.h"
#include "mtrace/convert.h"
#include "mtrace/file.h"
#include "words.h"

namespace mauve::ctl {

int run_convert_trace(Session& session) {
  const std::string file = session.arguments.one("FILE");
  const std::string output = session.arguments.one("-o,--output");
  const auto named = mtrace::format_named(session.arguments.one("--format"));
  const mtrace::Format format = named.value_or(mtrace::format_of(output));
  const auto trace = mtrace::read_file(file);
  if (!trace) {
    return session.fail(
        protocol::fault_of(protocol::kUsage, trace.error().message, file, trace.error().hint));
  }
  if (const Status done = mtrace::convert(*trace, format, output); !done) {
    return session.fail(protocol::fault_of(done.error()));
  }
  const std::uint64_t records = trace->records.size();
  session.print({{"file", output}, {"records", records}, {"complete", trace->reading.complete}},
                "wrote " + counted(records, "record") + " to " + output + "\n");
  return 0;
}

}  // namespace mauve::ctl
