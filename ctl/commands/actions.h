// SPDX-License-Identifier: LGPL-3.0-or-later
/// The functions of the commands: they ask, print, and return the exit code. One function a row of
/// the table.
#pragma once

#include "cli/session.h"

namespace mauve::ctl {

/// The options that were given, of those that several changes have: "--state drop" and the like.
void add_options(const Session& session, Json& params);

/// Prints the errors of a file above the refusal; returns the exit code.
int fail_with_errors(Session& session, const Fault& fault, std::string_view file);

/// The names of all events, in the order of events.def.
[[nodiscard]] std::vector<std::string> message_names();

int run_status(Session& session);
int run_list(Session& session);
int run_show(Session& session);
int run_get(Session& session);
int run_watch(Session& session);
int run_record(Session& session);
int run_plot(Session& session);
int run_map(Session& session);
int run_graph(Session& session);
int run_plugins(Session& session);
int run_analyze(Session& session);
int run_stats(Session& session);
int run_metrics(Session& session);
int run_top(Session& session);
int run_rules(Session& session);
int run_why(Session& session);
int run_check(Session& session);
int run_export(Session& session);
int run_history(Session& session);
int run_logs(Session& session);
int run_explain(Session& session);
int run_log(Session& session);
int run_trace(Session& session);
int run_ping(Session& session);
int run_doctor(Session& session);
int run_help(Session& session);
int run_protocol(Session& session);
int run_new(Session& session);
/// Serves any command whose row names a method without arguments: prints the answer as the row of
/// the method describes it.
int run_answer(Session& session);
int run_completion(Session& session);
int run_version(Session& session);

int run_set(Session& session);
int run_start(Session& session);
int run_stop(Session& session);
int run_swap_core(Session& session);
int run_connect(Session& session);
int run_disconnect(Session& session);
int run_change(Session& session);
int run_call(Session& session);
int run_write(Session& session);
int run_wait(Session& session);
int run_confirm(Session& session);
int run_undo(Session& session);
int run_quarantine(Session& session);
int run_diff(Session& session);
int run_apply(Session& session);
int run_plan(Session& session);
int run_load(Session& session);
int run_unload(Session& session);
int run_reload(Session& session);
int run_rollback(Session& session);
int run_lock(Session& session);

int run_check_trace(Session& session);
int run_convert_trace(Session& session);
int run_timeline(Session& session);

}  // namespace mauve::ctl
