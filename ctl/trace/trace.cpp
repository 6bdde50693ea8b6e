// SPDX-License-Identifier: LGPL-3.0-or-later
/// trace: begin and end one, list those that there are, and write one to a file.
#include <chrono>
#include <string>
#include <variant>

#include "base/duration.h"
#include "cli/output.h"
#include "commands/actions.h"
#include "mtrace/convert.h"
#include "render/table.h"
#include "render/words.h"
#include "trace/read_trace.h"

namespace mauve::ctl {
namespace {

using protocol::wrong_use;

constexpr const char* kFileOption = "-o,--output";

std::string in_words(const Json& status) {
  const bool on = status.value("on", false);
  const std::string detail = status.value("detail", false) ? " in detail" : "";
  const bool flight = status.value("flight_recorder", false);
  std::string text = on ? "tracing" + detail : std::string("no trace is on");
  if (on) text += ", the last " + std::to_string(whole_number(status, "seconds")) + " s are kept";
  text += flight ? "; the flight recorder is on\n" : "; the flight recorder is off\n";
  text += counted(whole_number(status, "records"), "record") + " kept, " +
          counted(whole_number(status, "lost"), "record") + " lost, " +
          counted(whole_number(status, "recordings"), "flight recording") + "\n";
  return text;
}

int print_status(Session& session, std::string_view method, const Json& params) {
  const auto answer = session.call(method, params);
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const Json& status = std::get<Json>(answer);
  session.print(status, in_words(status));
  return 0;
}

int start(Session& session) {
  Json params = Json::object();
  if (session.arguments.has("--detail")) params["detail"] = true;
  if (session.arguments.has("--for")) {
    const std::string text = session.arguments.one("--for");
    const auto kept = parse_duration(text);
    constexpr std::chrono::seconds kOne{1};
    if (!kept || *kept < kOne || (*kept % kOne).count() != 0) {
      return session.fail(wrong_use("usage_not_a_time", "--for takes whole seconds", text,
                                    "example: mauvectl trace start --for 10s"));
    }
    params["seconds"] = *kept / kOne;
  }
  return print_status(session, "trace.start", params);
}

int list(Session& session) {
  const auto answer = session.call("trace.list", Json::object());
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const Json& result = std::get<Json>(answer);
  const auto items = list_in(result, "items");
  if (items.empty()) {
    session.print(result, "no flight recordings\n");
    return 0;
  }
  Table table({{"NAME"}, {"TIME"}, {"RECORDS", true}, {"REASON"}});
  for (const Json& one : items) {
    table.add({{word(one, "name")},
               {time_in_words(word(one, "when"))},
               {word(one, "records")},
               {word(one, "why")}});
  }
  const Look look = session.look();
  session.print(result, table.text(look.width, look.colour));
  return 0;
}

int dump(Session& session) {
  const std::string file = session.arguments.one(kFileOption);
  if (file.empty())
    return session.fail(wrong_use("usage_missing_argument", "-o says into which file", {},
                                  "example: mauvectl trace dump -o now.mtrace"));
  const mtrace::Format format = mtrace::format_of(file);
  if (const auto refused = refused_output(session, output_of(format))) {
    return session.fail(*refused);
  }
  const auto read = read_live(session, session.arguments.one("RECORDING"));
  if (const auto* fault = std::get_if<Fault>(&read)) return session.fail(*fault);
  const auto& trace = std::get<mtrace::Trace>(read);
  const bool replaced = replaces_file(session);
  if (const Status done = mtrace::convert(trace, format, file); !done) {
    return session.fail(bad_file(done.error()));
  }
  const std::uint64_t records = trace.records.size();
  report_output(session, "wrote " + counted(records, "record"),
                {{"records", records}, {"lost", trace.header.lost}}, replaced);
  return 0;
}

}  // namespace

int run_trace(Session& session) {
  const std::string action = session.arguments.one("ACTION");
  if (action == "start") return start(session);
  if (action == "stop") return print_status(session, "trace.stop", Json::object());
  if (action == "status") return print_status(session, "trace.status", Json::object());
  if (action == "list") return list(session);
  return dump(session);
}

}  // namespace mauve::ctl
