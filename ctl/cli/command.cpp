// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/command.h"

#include <algorithm>

#include "cli/arguments.h"
#include "commands/actions.h"

namespace mauve::ctl {
namespace argument_table {
namespace {

constexpr Command kCommands[] = {
    {"status",
     "Show the generation and one line for each component",
     "mauvectl status",
     {},
     false,
     run_status},
    {"list", "List components, resources, services, cores, fsms, types, ports, plugins or clients",
     "mauvectl list ports", kList, false, run_list},
    {"show", "Show everything about one object", "mauvectl show control", kShow, false, run_show},
    {"get", "Print values and their status", "mauvectl get control.core.speed odometry.read", kGet,
     false, run_get},
    {"set", "Set properties, all in one change", "mauvectl set control.core.speed=0.3", kSet, true,
     run_set},
    {"watch", "Print every new value, one a line, until Ctrl-C",
     "mauvectl --json watch odometry.read", kWatch, false, run_watch},
    {"record", "Write every new value as a row of CSV",
     "mauvectl record localization.pose --for 10s -o drive.csv", kRecord, false, run_record},
    {"plot", "Draw values over time as an SVG picture",
     "mauvectl plot localization.pose --for 10s -o drive.svg", kPlot, false, run_plot},
    {"map", "Draw the way driven as an SVG picture with what was seen on it",
     "mauvectl map localization.pose --mode control.core --for 30s -o drive.svg", kMap, false,
     run_map},
    {"graph", "Draw the architecture, or a state machine", "mauvectl graph -o rover.svg", kGraph,
     false, run_graph},
    {"start", "Start components at the next instant of their release grid", "mauvectl start gnss",
     kStart, true, run_start},
    {"stop", "Stop components: each ends its job and writes safe values", "mauvectl stop --all",
     kStop, true, run_stop},
    {"swap-core", "Replace the core of a running component",
     "mauvectl swap-core control guidance/potential_field --set gain=0.3", kSwap, true,
     run_swap_core},
    {"connect", "Connect a port to a service", "mauvectl connect control.ports.scan scan.read",
     kConnect, true, run_connect},
    {"disconnect", "Disconnect a port", "mauvectl disconnect gnss.ports.fix", kDisconnect, true,
     run_disconnect},
    {"change", "Make several steps at one instant", "mauvectl change -f steps.json --dry-run",
     kSteps, true, run_change},
    {"call", "Call a call or event service of a resource",
     "mauvectl call localization.predict_at 0", kCall, true, run_call},
    {"write", "Write a value to a service of a resource",
     "mauvectl write goal.write '{\"x\":20,\"y\":15}'", kWrite, true, run_write},
    {"wait", "Wait until a condition holds; exit code 3 when --timeout passes first",
     "mauvectl wait --for 'control.missed > 3' --timeout 10s", kWait, false, run_wait},
    {"confirm", "Confirm all changes on probation", "mauvectl confirm", kConfirm, true,
     run_confirm},
    {"undo", "Undo the newest change on probation, or a named one", "mauvectl undo --dry-run",
     kUndo, true, run_undo},
    {"quarantine", "List cores that failed and were rolled back, or release one",
     "mauvectl quarantine release guidance/widest_gap", kQuarantine, true, run_quarantine},
    {"apply", "Make the running system that of a file, all at once",
     "mauvectl apply rover.json --dry-run", kApply, true, run_apply},
    {"plan", "Print the changes that apply would make, without making them",
     "mauvectl plan rover.json", kPlan, true, run_plan},
    {"diff", "Print the differences of a file to the running system; exit code 1 if there are any",
     "mauvectl diff rover.json", kCheck, false, run_diff},
    {"load", "Load a plugin by its name", "mauvectl load guidance_extra", kLoad, true, run_load},
    {"unload", "Unload a plugin that nothing uses", "mauvectl unload guidance_extra", kPlugin, true,
     run_unload},
    {"reload", "Move every instance to the new code of a rebuilt plugin",
     "mauvectl reload guidance", kReload, true, run_reload},
    {"plugins", "List the loaded plugins and what they bring", "mauvectl plugins --for control",
     kPlugins, false, run_plugins},
    {"analyze",
     "Print response times: whether every deadline is met, and by how much",
     "mauvectl analyze",
     {},
     false,
     run_analyze},
    {"stats", "Print how long jobs and states took, or count them anew", "mauvectl stats control",
     kStats, true, run_stats},
    {"top", "Show one row for each component, live; ? lists the keys",
     "mauvectl top --interval 500ms", kTop, false, run_top},
    {"threads",
     "List the threads of mauved with priority, processor time and page faults",
     "mauvectl threads",
     {},
     false,
     run_answer,
     "daemon.threads"},
    {"metrics",
     "Print state and statistics in the text format of Prometheus",
     "mauvectl metrics > mauve.prom",
     {},
     false,
     run_metrics},
    {"rules", "List the rules of the daemon: state, last firing, why not", "mauvectl rules", kRules,
     false, run_rules},
    {"why", "Say why a component failed, what was done and what to do", "mauvectl why control",
     kWhy, false, run_why},
    {"check",
     "Print all errors of an architecture file, which the running mauved finds with its plugin "
     "folders, and what a start would note; without a daemon: mauved --check --plugin-dir DIR FILE",
     "mauvectl check rover.json", kCheck, false, run_check},
    {"export",
     "Print the running system as an architecture file",
     "mauvectl export > now.json",
     {},
     false,
     run_export},
    {"history",
     "List the saved generations with time, user, changes and reason, or compare two of them",
     "mauvectl history -n 10", kHistory, false, run_history},
    {"rollback",
     "Return to a saved generation. A generation has no code: the plugins stay in the builds that "
     "run",
     "mauvectl rollback 41", kRollback, true, run_rollback},
    {"lock",
     "Lock parameters, the topology or all, also against rules, until lock none or the end of "
     "mauved; "
     "a stop and confirm stay possible",
     "mauvectl lock all --reason mission", kLock, true, run_lock},
    {"logs", "Print the last events", "mauvectl logs -f gnss --level warn", kLogs, false, run_logs},
    {"explain",
     "Explain a message (an event, a refusal, a failure), a plugin, or a name that a plugin brings",
     "mauvectl explain rule_fired", kExplain, false, run_explain},
    {"trace", "Record what every thread does when, and read flight recordings",
     "mauvectl trace dump -o now.mtrace", kTrace, false, run_trace},
    {"log", "Set from which level on is logged, also of one component, for a time",
     "mauvectl log level control=debug --for 10min", kLog, true, run_log},
    {"doctor", "Check whether the machine is fit for real time, with a remedy for each finding",
     "mauvectl doctor --wake 10s", kDoctor, false, run_doctor},
    {"completion", "Print the script that completes command lines in a shell",
     "mauvectl completion bash > ~/.local/share/bash-completion/completions/mauvectl", kCompletion,
     false, run_completion},
    {"timeline", "Draw what ran when as an SVG picture",
     "mauvectl timeline drive.mtrace --from 1.2s --to 1.25s -o drive.svg", kTimeline, false,
     run_timeline},
    {"check-trace", "Check a trace against the model; exit code 1 when it breaks a rule",
     "mauvectl check-trace drive.mtrace", kCheckTrace, false, run_check_trace},
    {"convert-trace", "Convert a trace for Perfetto and Chrome, or babeltrace2 and Trace Compass",
     "mauvectl convert-trace drive.mtrace -o drive.json", kConvertTrace, false, run_convert_trace},
    {"new", "Write a project of your own that builds and passes its test into a new folder",
     "mauvectl new core my_core", kNew, false, run_new},
    {"help", "Print help for a command, or list all commands", "mauvectl help swap-core", kHelp,
     false, run_help},
    {"protocol",
     "List the methods of the protocol, or describe one; --json: as an OpenRPC document",
     "mauvectl protocol core.swap", kProtocol, false, run_protocol},
    {"ping", "Ask whether the daemon answers", "mauvectl ping", {}, false, run_ping},
    {"version",
     "Print the versions of client and daemon",
     "mauvectl version",
     {},
     false,
     run_version},
};

constexpr Category kCategories[] = {
    {"components", "component.list"}, {"resources", "resource.list"},
    {"cores", "core.list"},           {"fsms", "fsm.list"},
    {"types", "type.list"},           {"services", "service.list"},
    {"ports", "port.list"},           {"plugins", "plugin.list"},
    {"clients", "client.list"},
};

}  // namespace
}  // namespace argument_table

std::vector<std::string> Argument::words() const {
  std::vector<std::string> all;
  for (auto rest = choices; !rest.empty();) {
    all.emplace_back(rest.substr(0, rest.find(' ')));
    rest.remove_prefix(std::min(rest.size(), all.back().size() + 1));
  }
  return all;
}

std::span<const Command> commands() { return argument_table::kCommands; }

const Command* find_command(std::string_view name) {
  const auto found = std::ranges::find(argument_table::kCommands, name, &Command::name);
  return found == std::end(argument_table::kCommands) ? nullptr : found;
}

std::span<const Category> categories() { return argument_table::kCategories; }

}  // namespace mauve::ctl
