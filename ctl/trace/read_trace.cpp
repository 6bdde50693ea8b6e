// SPDX-License-Identifier: LGPL-3.0-or-later
#include "trace/read_trace.h"

#include <utility>

#include "mtrace/file.h"
#include "render/words.h"

namespace mauve::ctl {

std::variant<mtrace::Trace, Fault> read_trace(const std::string& file) {
  auto trace = mtrace::read_file(file);
  if (!trace) return bad_file(trace.error());
  return std::move(*trace);
}

std::variant<mtrace::Trace, Fault> read_live(Session& session, const std::string& recording,
                                             Live live) {
  mtrace::Builder builder;
  Json params{{"from", 0}, {"count", protocol::kMostRecords}};
  if (!recording.empty()) params["recording"] = recording;
  if (live == Live::now) params["now"] = true;
  for (bool end = false; !end;) {
    auto answer = session.call("trace.read", params);
    if (auto* fault = std::get_if<Fault>(&answer)) return std::move(*fault);
    const Json& page = std::get<Json>(answer);
    if (!page.is_object()) {
      return protocol::fault_of(protocol::kBadAnswer, "the answer is no page of a trace");
    }
    const std::uint64_t from = whole_number(params, "from");
    if (from == 0) {
      const Status sound = builder.header(page.value("header", Json()));
      if (!sound) return protocol::fault_of(sound.error());
    }
    for (const Json& record : list_in(page, "records")) builder.record(record);
    const std::uint64_t next = whole_number(page, "next");
    end = page.value("end", Json(true)) != false || next <= from;
    params["from"] = next;
    // All pages are of the same moment.
    if (page.contains("recording")) params["recording"] = page["recording"];
  }
  builder.complete();
  return builder.take();
}

OutputKind output_of(mtrace::Format format) {
  return {mtrace::begin_of(format), {}, false, format == mtrace::Format::ctf};
}

}  // namespace mauve::ctl
