// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/output.h"
#include "commands/actions.h"
#include "mtrace/convert.h"
#include "render/words.h"
#include "trace/read_trace.h"

namespace mauve::ctl {

int run_convert_trace(Session& session) {
  const std::string output = session.arguments.one("-o,--output");
  const auto named = mtrace::format_named(session.arguments.one("--format"));
  const mtrace::Format format = named.value_or(mtrace::format_of(output));
  if (const auto refused = refused_output(session, output_of(format))) {
    return session.fail(*refused);
  }
  const auto read = read_trace(session.arguments.one("FILE"));
  if (const auto* fault = std::get_if<Fault>(&read)) return session.fail(*fault);
  const auto& trace = std::get<mtrace::Trace>(read);
  const bool replaced = replaces_file(session);
  if (const Status done = mtrace::convert(trace, format, output); !done) {
    return session.fail(bad_file(done.error()));
  }
  const std::uint64_t records = trace.records.size();
  report_output(session, "wrote " + counted(records, "record"),
                {{"records", records}, {"complete", trace.reading.complete}}, replaced);
  return 0;
}

}  // namespace mauve::ctl
