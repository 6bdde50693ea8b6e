// SPDX-License-Identifier: LGPL-3.0-or-later
/// A trace, of a file or of the running system, as a picture.
#include "mtrace/timeline.h"

#include <algorithm>
#include <sstream>

#include "base/duration.h"
#include "cli/output.h"
#include "commands/actions.h"
#include "render/words.h"
#include "trace/read_trace.h"

namespace mauve::ctl {
namespace {

std::variant<mtrace::Trace, Fault> trace_of(Session& session) {
  const std::string file = session.arguments.one("FILE");
  if (file.empty() || file == "live") return read_live(session, {}, Live::now);
  return read_trace(file);
}

/// A time since T0; false: it is none.
bool read_time(const Session& session, std::string_view option, std::optional<std::int64_t>& into) {
  if (!session.arguments.has(option)) return true;
  const auto time = parse_duration(session.arguments.one(option));
  if (time) into = time->count();
  return time.has_value();
}

std::vector<std::string> split(const std::vector<std::string>& lists) {
  std::vector<std::string> names;
  for (const std::string& list : lists) {
    std::istringstream stream(list);
    for (std::string name; std::getline(stream, name, ',');) {
      if (!name.empty()) names.push_back(name);
    }
  }
  return names;
}

/// The fault of a window that lies outside the trace.
std::optional<Fault> nothing_in(const mtrace::Trace& trace, const mtrace::View& view) {
  const std::int64_t first = trace.first_time();
  const std::int64_t last = trace.last_time();
  const bool after = view.from && *view.from > last;
  const bool before = view.to && *view.to < first;
  if (!after && !before) return std::nullopt;
  return protocol::wrong_use("usage_nothing_to_draw",
                             std::string(after ? "--from lies after" : "--to lies before") +
                                 " the trace, so there is nothing to draw",
                             {},
                             "the trace goes from " + mtrace::instant_in_words(first) + " to " +
                                 mtrace::instant_in_words(last));
}

/// The fault of a name that no component of the trace has.
std::optional<Fault> unknown_in(const mtrace::Trace& trace, const mtrace::View& view) {
  std::string names;
  for (const auto& one : trace.header.components) names += (names.empty() ? "" : ", ") + one.name;
  for (const std::string& wanted : view.components) {
    const auto is_it = [&](const auto& one) { return one.name == wanted; };
    if (std::ranges::any_of(trace.header.components, is_it)) continue;
    return protocol::wrong_use("usage_nothing_to_draw", "the trace has no component " + wanted, {},
                               names.empty() ? "the trace names no components" : "it has " + names);
  }
  return std::nullopt;
}

int write_picture(Session& session, const mtrace::Timeline& timeline) {
  std::string left_out;
  for (const std::string& what : timeline.left_out) left_out += "not shown: " + what + "\n";
  return write_output(
      session, kPictureOutput, timeline.svg,
      "drew " + mtrace::instant_in_words(timeline.from) + " to " +
          mtrace::instant_in_words(timeline.to),
      {{"from_ns", timeline.from}, {"to_ns", timeline.to}, {"left_out", timeline.left_out}},
      left_out);
}

}  // namespace

int run_timeline(Session& session) {
  if (const auto refused = refused_output(session, kPictureOutput)) return session.fail(*refused);
  mtrace::View view;
  view.components = split(session.arguments.all("--component"));
  if (!read_time(session, "--from", view.from) || !read_time(session, "--to", view.to)) {
    return session.fail(protocol::wrong_use("usage_not_a_time",
                                            "--from and --to are times since T0", {},
                                            "example: --from 1.2s --to 1.25s"));
  }
  if (view.from && view.to && *view.to <= *view.from) {
    return session.fail(protocol::wrong_use("usage_options_conflict", "--to is not after --from"));
  }
  const auto trace = trace_of(session);
  if (const auto* fault = std::get_if<Fault>(&trace)) return session.fail(*fault);
  const auto& found = std::get<mtrace::Trace>(trace);
  if (auto unknown = unknown_in(found, view)) return session.fail(*unknown);
  if (auto nothing = nothing_in(found, view)) return session.fail(*nothing);
  return write_picture(session, mtrace::draw_timeline(found, view));
}

}  // namespace mauve::ctl
