// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>
#include <utility>

#include "commands/actions.h"

namespace mauve::ctl {
namespace {

using protocol::Exit;

int fail(Session& session, const Fault& fault) {
  return fail_with_errors(session, fault, session.arguments.one("FILE"));
}

int apply(Session& session, bool dry_run) {
  auto params = file_params(session);
  if (const auto* fault = std::get_if<Fault>(&params)) return session.fail(*fault);
  Json asked = std::get<Json>(std::move(params));
  if (dry_run) asked["dry_run"] = true;
  add_options(session, asked);
  const auto answer = session.call("architecture.apply", std::move(asked));
  if (const auto* fault = std::get_if<Fault>(&answer)) return fail(session, *fault);
  const auto& result = std::get<Json>(answer);
  const std::string file = session.arguments.one("FILE");
  session.print(result, dry_run ? render_plan(file, result, session.look())
                                : render_applied(file, result, session.look()));
  return 0;
}

}  // namespace

int fail_with_errors(Session& session, const Fault& fault, std::string_view file) {
  if (!session.screen.json && fault.errors.is_array()) {
    session.screen.err << render_errors(file, {{"errors", fault.errors}},
                                        {session.screen.width_err, session.screen.colour_err});
  }
  return session.fail(fault);
}

int run_apply(Session& session) { return apply(session, session.arguments.has("--dry-run")); }

int run_plan(Session& session) { return apply(session, true); }

int run_diff(Session& session) {
  auto params = file_params(session);
  if (const auto* fault = std::get_if<Fault>(&params)) return session.fail(*fault);
  const auto answer = session.call("architecture.diff", std::get<Json>(std::move(params)));
  if (const auto* refused = std::get_if<Fault>(&answer)) {
    Fault fault = *refused;
    // Exit code 1 means that something differs.
    if (fault.exit == static_cast<int>(Exit::refused)) fault.exit = static_cast<int>(Exit::usage);
    return fail(session, fault);
  }
  const auto& result = std::get<Json>(answer);
  session.print(result, render_diff(session.arguments.one("FILE"), result, session.look()));
  const bool same = result.is_object() && result.value("same", false);
  return same ? 0 : 1;
}

}  // namespace mauve::ctl
