// SPDX-License-Identifier: LGPL-3.0-or-later
#include "cli/command.h"

#include <algorithm>

#include "commands/actions.h"

namespace mauve::ctl {
namespace {

constexpr Argument one(std::string_view name, std::string_view text, Kind kind) {
  return {name, text, kind, true};
}
constexpr Argument maybe(std::string_view name, std::string_view text, Kind kind) {
  return {name, text, kind};
}
constexpr Argument some(std::string_view name, std::string_view text, Kind kind) {
  return {name, text, kind, true, true};
}
constexpr Argument any(std::string_view name, std::string_view text, Kind kind) {
  return {name, text, kind, false, true};
}
constexpr Argument flag(std::string_view name, std::string_view text) {
  return {name, text, Kind::none, false, false, true};
}

constexpr Argument choice(std::string_view name, std::string_view text, std::string_view choices) {
  return {name, text, Kind::none, false, false, false, choices};
}
constexpr Argument one_of(std::string_view name, std::string_view text, std::string_view choices) {
  return {name, text, Kind::none, true, false, false, choices};
}
/// Takes this word as well as what else it takes.
constexpr Argument also(std::string_view word, Argument argument) {
  argument.choices = word;
  argument.others = true;
  return argument;
}

constexpr Argument kState = choice("--state", "\"drop\": begin with a fresh state", "drop");
constexpr Argument kSync =
    choice("--sync",
           "\"cut\", or \"barrier\": members wait for each other; unsaid: where a contract changes",
           "cut barrier");
constexpr Argument kComponent = one("COMPONENT", "name of a component", Kind::component);
constexpr Argument kPort = one("PORT", "such as control.ports.scan", Kind::port);

constexpr Argument kProbation =
    also("off",
         maybe("--probation", "so many jobs of each member before it counts as good (3000), or off",
               Kind::none));
constexpr Argument kMisses = maybe("--misses",
                                   "late jobs tolerated on probation, M of the last K such as 1/64 "
                                   "(2/64; M is at least 1); a late "
                                   "job counts once, however many releases it cost",
                                   Kind::none);
constexpr Argument kConfirmWithin = maybe(
    "--confirm-within", "rolled back unless confirmed in this time, such as 30s", Kind::duration);

constexpr Argument kDryRun =
    flag("--dry-run", "tell what the change would do; it is prepared and dropped");

constexpr Argument kList[] = {maybe(
    "KIND",
    "components (default), resources, services, cores, fsms, types, ports, plugins or clients",
    Kind::category)};
constexpr Argument kShow[] = {
    one("ADDRESS", "component, resource or anything in them", Kind::address)};
constexpr Argument kGet[] = {
    some("ADDRESS", "such as control.core.gain or fix.read", Kind::address)};
constexpr Argument kWatch[] = {
    some("ADDRESS", "such as control.core.gain or fix.read", Kind::address),
    maybe("--every", "at most one value of each address in this time, such as 500ms",
          Kind::duration),
    flag("--changes", "only values that differ from the one before")};
constexpr Argument kFor =
    maybe("--for", "how long, such as 10s; unsaid: until Ctrl-C", Kind::duration);
constexpr Argument kRecord[] = {
    some("ADDRESS", "such as pose.read or control.missed", Kind::address), kFor,
    maybe("-o,--output", "file for the CSV; unsaid: standard output", Kind::file)};
constexpr Argument kPicture =
    maybe("-o,--output", "file for the SVG; unsaid: standard output", Kind::file);
constexpr Argument kPlot[] = {some("ADDRESS", "of numbers, such as pose.read", Kind::address), kFor,
                              kPicture};
constexpr Argument kMap[] = {
    one("POSE", "where it is: something with x and y; with heading and variances drawn as well",
        Kind::address),
    maybe("--grid", "an occupancy grid", Kind::address),
    maybe("--scan", "a laser scan, drawn where it was seen from", Kind::address),
    maybe("--path", "places to pass", Kind::address),
    maybe("--goal", "a place", Kind::address),
    maybe("--discs", "obstacles, each with a place and a radius", Kind::address),
    maybe("--mode", "what colours the way driven, such as control.core", Kind::address),
    kFor,
    kPicture};
constexpr Argument kGraph[] = {
    any("ELEMENT", "only these components and resources, with what they are connected to",
        Kind::component),
    flag("--dot", "for Graphviz (unless the name of the file says something else)"),
    flag("--mermaid", "for Markdown (by itself where the file ends with .mmd)"),
    flag("--svg", "a picture (by itself where the file ends with .svg)"),
    maybe("--fsm", "the state machine of this component instead", Kind::component),
    maybe("-o,--output", "file for it; unsaid: standard output", Kind::file)};
constexpr Argument kSet[] = {some("ADDRESS=VALUE", "JSON, or a bare text", Kind::assignment),
                             kDryRun,
                             kState,
                             kProbation,
                             kMisses,
                             kConfirmWithin};
constexpr Argument kSteps[] = {
    {"-f,--file", "the steps, an array as of a transaction; - for standard input", Kind::file,
     true},
    kDryRun,
    kState,
    kProbation,
    kMisses,
    kConfirmWithin};
constexpr Argument kCall[] = {
    one("SERVICE", "a call or event service, such as localization.reset", Kind::service),
    any("ARGUMENT", "what the service takes, JSON or a bare text", Kind::none)};
constexpr Argument kWrite[] = {
    one("SERVICE", "a write service, such as velocity.write", Kind::service),
    one("VALUE", "JSON or a bare text", Kind::none)};
constexpr Argument kWait[] = {
    {"--for", "a condition as of a rule, such as \"control.missed > 3\"", Kind::none, true}};
constexpr Argument kStart[] = {any("COMPONENT", "names of components", Kind::component),
                               flag("--all", "every component that does not run"),
                               flag("--reset", "with a fresh core state"), kDryRun};
constexpr Argument kStop[] = {any("COMPONENT", "names of components", Kind::component),
                              flag("--all", "every component, at once"), kDryRun};
constexpr Argument kSwap[] = {
    kComponent,
    one("CORE", "such as guidance/finite_time", Kind::core),
    any("--set", "KEY=VALUE of a property of the new core", Kind::setting),
    maybe("--budget", "processor time that a job of it may use, such as 2ms", Kind::duration),
    flag("--defaults", "the new core begins with its own values, not with those in force"),
    flag("--in-place",
         "stop, swap, start: for hardware that one core only can hold; without probation"),
    kDryRun,
    kState,
    kProbation,
    kMisses,
    kConfirmWithin};
constexpr Argument kConnect[] = {
    kPort,
    one("SERVICE", "such as scan.read", Kind::service),
    maybe("--max-age", "values older than this are stale, such as 50ms", Kind::duration),
    flag("--replace", "exchange the connection that the port has, at one instant"),
    kDryRun,
    kProbation,
    kMisses,
    kConfirmWithin};
constexpr Argument kDisconnect[] = {kPort, kDryRun, kProbation, kMisses, kConfirmWithin};
constexpr Argument kQuarantine[] = {choice("ACTION", "\"release\", or nothing to list", "release"),
                                    maybe("CORE", "the core to release", Kind::core)};
constexpr Argument kPlugin[] = {one("PLUGIN", "name of a plugin, not a path", Kind::plugin)};
constexpr Argument kLoad[] = {one("PLUGIN", "name of a plugin, not a path", Kind::available),
                              kDryRun};
constexpr Argument kReload[] = {kPlugin[0], kState, kProbation, kMisses, kConfirmWithin, kDryRun};
constexpr Argument kPlugins[] = {
    maybe("--for", "the cores that fit this component", Kind::component)};
constexpr Argument kStats[] = {
    also("reset", maybe("ADDRESS", "a component or a state of it; or \"reset\": counts anew",
                        Kind::component)),
    maybe("COMPONENT", "of reset: only this one", Kind::component)};
constexpr Argument kTop[] = {
    flag("-b,--batch", "tables one below the other, for scripts; with --json a line each"),
    maybe("-n,--count", "end after so many", Kind::number),
    maybe("--interval", "how often it looks, such as 500ms; unsaid: 1s", Kind::duration)};
constexpr Argument kRules[] = {maybe("RULE", "only this one, with all its parts", Kind::rule)};
constexpr Argument kWhy[] = {kComponent};
constexpr Argument kCheck[] = {one("FILE", "an architecture file", Kind::file)};
constexpr Argument kApply[] = {one("FILE", "an architecture file", Kind::file),
                               flag("--dry-run", "prepare and tell, but change nothing"),
                               kState,
                               kSync,
                               kProbation,
                               kMisses,
                               kConfirmWithin};
constexpr Argument kPlan[] = {one("FILE", "an architecture file", Kind::file), kState, kSync,
                              kProbation};
constexpr Argument kHistory[] = {
    maybe("-n,--lines", "how many of the newest", Kind::number),
    any("GENERATION", "two numbers: print what differs between these generations",
        Kind::generation)};
constexpr Argument kRollback[] = {
    one("GENERATION", "a number of mauvectl history", Kind::generation),
    kDryRun,
    kState,
    kSync,
    kProbation,
    kMisses,
    kConfirmWithin};
constexpr Argument kUndo[] = {flag("--dry-run", "tell which changes it takes back")};
constexpr Argument kTrace[] = {
    one_of("ACTION", "start, stop, status, list or dump", "start stop status list dump"),
    maybe("RECORDING", "of dump: one of the list; unsaid: what is traced now", Kind::recording),
    flag("--detail", "of start: every use of a port too"),
    maybe("--for", "of start: what is kept, such as 10s", Kind::duration),
    maybe("-o,--output", "of dump: *.mtrace, *.json for Perfetto, else a folder of CTF",
          Kind::file)};
constexpr Argument kLock[] = {
    one_of("LOCK", "none, params, topology or all", "none params topology all")};
constexpr Argument kExplain[] = {
    maybe("NAME", "an event, or what a plugin brings; without it, all events", Kind::explained)};
constexpr Argument kLogs[] = {
    maybe("COMPONENT", "only the records of this component; with --explain the name of an event",
          Kind::component),
    flag("--explain",
         "what the event of this name means and what to do; without a name, all events"),
    flag("-f,--follow", "go on with what comes"),
    maybe("-n,--lines", "how many of the last records", Kind::number),
    choice("--level", "debug, info, warn or error, and worse", "debug info warn error"),
    maybe("--since", "10min ago, 12:30, or a whole time such as 2026-01-31T12:00:00Z", Kind::none),
    maybe("--grep", "with this in text, component or event; capitals do not matter", Kind::none)};
constexpr Argument kLog[] = {
    one_of("WHAT", "level", "level"),
    also(
        "debug info warn error default",
        maybe("SETTING", "[COMPONENT=]LEVEL: debug, info, warn, error or default; unsaid: shows it",
              Kind::none)),
    maybe("--for", "reverts by itself after this time, such as 10min", Kind::duration)};
constexpr Argument kTraceFile = one("FILE", "a trace, *.mtrace", Kind::file);
constexpr Argument kTimeline[] = {
    also("live", maybe("FILE", "a trace, *.mtrace; unsaid, or live: that of the running system",
                       Kind::file)),
    maybe("--from",
          "time since T0, such as 1.2s; unsaid: around why it was kept, or the last second",
          Kind::duration),
    maybe("--to", "time since T0", Kind::duration),
    {"--component", "only these, such as control,scan", Kind::component, false, true},
    kPicture};
constexpr Argument kCheckTrace[] = {kTraceFile};
constexpr Argument kConvertTrace[] = {
    kTraceFile,
    {"-o,--output", "*.json for Perfetto, *.mtrace, else a folder of CTF", Kind::file, true},
    choice("--format", "chrome, ctf or mtrace, whatever the name of the output is",
           "chrome ctf mtrace")};

constexpr Argument kHelp[] = {maybe("COMMAND", "name of a command", Kind::command)};
constexpr Argument kCompletion[] = {one_of("SHELL", "bash, zsh or fish", "bash zsh fish")};
constexpr Argument kDoctor[] = {
    maybe("--wake", "also measure wake-up latencies for so long, such as 10s", Kind::duration)};

constexpr Command kCommands[] = {
    {"status",
     "Show the generation and one line for each component",
     "mauvectl status",
     {},
     false,
     run_status},
    {"list", "List components, resources, cores, ports, plugins or clients", "mauvectl list ports",
     kList, false, run_list},
    {"show", "Show everything about one object", "mauvectl show control", kShow, false, run_show},
    {"get", "Print values and their status", "mauvectl get control.core.gain fix.read", kGet, false,
     run_get},
    {"set", "Set properties, all in one change", "mauvectl set control.core.gain=0.3", kSet, true,
     run_set},
    {"watch", "Print every new value, one a line, until Ctrl-C", "mauvectl --json watch fix.read",
     kWatch, false, run_watch},
    {"record", "Write every new value as a row of CSV",
     "mauvectl record pose.read --for 10s -o drive.csv", kRecord, false, run_record},
    {"plot", "Draw values over time as an SVG picture",
     "mauvectl plot pose.read --for 10s -o drive.svg", kPlot, false, run_plot},
    {"map", "Draw the way driven as an SVG picture with what was seen on it",
     "mauvectl map pose.read --mode control.core --for 30s -o drive.svg", kMap, false, run_map},
    {"graph", "Draw the architecture, or a state machine", "mauvectl graph -o rover.svg", kGraph,
     false, run_graph},
    {"start", "Start components at the next instant of their release grid", "mauvectl start gnss",
     kStart, true, run_start},
    {"stop", "Stop components: each ends its job and writes safe values", "mauvectl stop --all",
     kStop, true, run_stop},
    {"swap-core", "Replace the core of a running component",
     "mauvectl swap-core control guidance/finite_time --set gain=0.3", kSwap, true, run_swap_core},
    {"connect", "Connect a port to a service", "mauvectl connect control.ports.scan scan.read",
     kConnect, true, run_connect},
    {"disconnect", "Disconnect a port", "mauvectl disconnect gnss.ports.fix", kDisconnect, true,
     run_disconnect},
    {"change", "Make several steps at one instant", "mauvectl change -f steps.json --dry-run",
     kSteps, true, run_change},
    {"call", "Call a call or event service of a resource", "mauvectl call localization.reset",
     kCall, true, run_call},
    {"write", "Write a value to a service of a resource", "mauvectl write limit.write 0.3", kWrite,
     true, run_write},
    {"wait", "Wait until a condition holds; exit code 3 when --timeout passes first",
     "mauvectl wait --for 'control.missed > 3' --timeout 10s", kWait, false, run_wait},
    {"confirm", "Confirm all changes on probation", "mauvectl confirm", {}, true, run_confirm},
    {"undo", "Undo the change on probation", "mauvectl undo --dry-run", kUndo, true, run_undo},
    {"quarantine", "List cores that failed and were rolled back, or release one",
     "mauvectl quarantine release guidance/widest_gap", kQuarantine, true, run_quarantine},
    {"apply", "Make the running system that of a file, all at once",
     "mauvectl apply rover.json --dry-run", kApply, true, run_apply},
    {"plan", "Prepare and drop what apply would do, and print it", "mauvectl plan rover.json",
     kPlan, true, run_plan},
    {"diff", "Print what a file would change; exit code 1 when it is something",
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
    {"check", "Check an architecture file and print all its errors", "mauvectl check rover.json",
     kCheck, false, run_check},
    {"export",
     "Print the running system as an architecture file",
     "mauvectl export > now.json",
     {},
     false,
     run_export},
    {"history",
     "List the saved generations with time, user, changes and reason, or compare two of them",
     "mauvectl history -n 10", kHistory, false, run_history},
    {"rollback", "Return to a saved generation", "mauvectl rollback 41", kRollback, true,
     run_rollback},
    {"lock", "Lock the system against changes, except stop, confirm and undo",
     "mauvectl lock all --reason mission", kLock, true, run_lock},
    {"logs", "Print the last events", "mauvectl logs -f gnss --level warn", kLogs, false, run_logs},
    {"explain", "Explain an event of the log, or a name that a plugin brings",
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
    {"help", "Print help for a command, or list all commands", "mauvectl help swap-core", kHelp,
     false, run_help},
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

std::vector<std::string> Argument::words() const {
  std::vector<std::string> all;
  for (auto rest = choices; !rest.empty();) {
    all.emplace_back(rest.substr(0, rest.find(' ')));
    rest.remove_prefix(std::min(rest.size(), all.back().size() + 1));
  }
  return all;
}

std::span<const Command> commands() { return kCommands; }

const Command* find_command(std::string_view name) {
  const auto found = std::find_if(std::begin(kCommands), std::end(kCommands),
                                  [&](const Command& one) { return one.name == name; });
  return found == std::end(kCommands) ? nullptr : found;
}

std::span<const Category> categories() { return kCategories; }

}  // namespace mauve::ctl
