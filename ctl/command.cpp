// SPDX-License-Identifier: LGPL-3.0-or-later
#include "command.h"

#include <algorithm>

#include "actions.h"

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
constexpr Argument kConfirmWithin =
    maybe("--confirm-within", "rolled back unless confirmed in this time, such as 30s", Kind::none);

constexpr Argument kList[] = {maybe(
    "KIND", "components (default), resources, cores, ports, plugins or clients", Kind::category)};
constexpr Argument kShow[] = {
    one("ADDRESS", "component, resource or anything in them", Kind::address)};
constexpr Argument kGet[] = {
    some("ADDRESS", "such as control.core.gain or fix.read", Kind::address)};
constexpr Argument kFor = maybe("--for", "how long, such as 10s; unsaid: until Ctrl-C", Kind::none);
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
                             kState, kProbation, kMisses, kConfirmWithin};
constexpr Argument kStart[] = {any("COMPONENT", "names of components", Kind::component),
                               flag("--all", "every component that does not run"),
                               flag("--reset", "with a fresh core state")};
constexpr Argument kStop[] = {any("COMPONENT", "names of components", Kind::component),
                              flag("--all", "every component, at once")};
constexpr Argument kSwap[] = {
    kComponent,
    one("CORE", "such as guidance/finite_time", Kind::core),
    any("--set", "KEY=VALUE of a property of the new core", Kind::none),
    maybe("--budget", "processor time that a job of it may use, such as 2ms", Kind::none),
    flag("--defaults", "the new core begins with its own values, not with those in force"),
    flag("--in-place",
         "stop, swap, start: for hardware that one core only can hold; without probation"),
    kState,
    kProbation,
    kMisses,
    kConfirmWithin};
constexpr Argument kConnect[] = {
    kPort,
    one("SERVICE", "such as scan.read", Kind::service),
    maybe("--max-age", "values older than this are stale, such as 50ms", Kind::none),
    kProbation,
    kMisses,
    kConfirmWithin};
constexpr Argument kDisconnect[] = {kPort, kProbation, kMisses, kConfirmWithin};
constexpr Argument kQuarantine[] = {choice("ACTION", "\"release\", or nothing to list", "release"),
                                    maybe("CORE", "the core to release", Kind::core)};
constexpr Argument kPlugin[] = {one("PLUGIN", "name of a plugin, not a path", Kind::plugin)};
constexpr Argument kReload[] = {kPlugin[0], kState};
constexpr Argument kPlugins[] = {
    maybe("--for", "the cores that fit this component", Kind::component)};
constexpr Argument kStats[] = {
    also("reset", maybe("ADDRESS", "a component or a state of it; or \"reset\": counts anew",
                        Kind::component)),
    maybe("COMPONENT", "of reset: only this one", Kind::component)};
constexpr Argument kTop[] = {
    flag("-b,--batch", "tables one below the other, for scripts; with --json a line each"),
    maybe("-n,--count", "end after so many", Kind::none),
    maybe("--interval", "how often it looks, such as 500ms; unsaid: 1s", Kind::none)};
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
constexpr Argument kHistory[] = {maybe("-n,--lines", "how many of the newest", Kind::none)};
constexpr Argument kRollback[] = {one("GENERATION", "a number of mauvectl history", Kind::none),
                                  kState, kSync};
constexpr Argument kTrace[] = {
    one_of("ACTION", "start, stop, status, list or dump", "start stop status list dump"),
    maybe("RECORDING", "of dump: one of the list; unsaid: what is traced now", Kind::none),
    flag("--detail", "of start: every use of a port too"),
    maybe("--for", "of start: what is kept, such as 10s", Kind::none),
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
    maybe("-n,--lines", "how many of the last records", Kind::none),
    choice("--level", "debug, info, warn or error, and worse", "debug info warn error"),
    maybe("--since", "10min ago, 12:30, or a whole time such as 2026-01-31T12:00:00Z", Kind::none),
    maybe("--grep", "with this in text, component or event; capitals do not matter", Kind::none)};
constexpr Argument kLog[] = {
    one_of("WHAT", "level", "level"),
    also(
        "debug info warn error default",
        maybe("SETTING", "[COMPONENT=]LEVEL: debug, info, warn, error or default; unsaid: shows it",
              Kind::none)),
    maybe("--for", "reverts by itself after this time, such as 10min", Kind::none)};
constexpr Argument kTraceFile = one("FILE", "a trace, *.mtrace", Kind::file);
constexpr Argument kTimeline[] = {
    also("live", maybe("FILE", "a trace, *.mtrace; unsaid, or live: that of the running system",
                       Kind::file)),
    maybe("--from",
          "time since T0, such as 1.2s; unsaid: around why it was kept, or the last second",
          Kind::none),
    maybe("--to", "time since T0", Kind::none),
    {"--component", "only these, such as control,scan", Kind::component, false, true},
    kPicture};
constexpr Argument kCheckTrace[] = {kTraceFile};
constexpr Argument kConvertTrace[] = {
    kTraceFile,
    {"-o,--output", "*.json for Perfetto, *.mtrace, else a folder of CTF", Kind::file, true},
    choice("--format", "chrome, ctf or mtrace, whatever the name of the output is",
           "chrome ctf mtrace")};

constexpr Argument kCompletion[] = {one_of("SHELL", "bash, zsh or fish", "bash zsh fish")};
constexpr Argument kDoctor[] = {
    maybe("--wake", "also measure wake-up latencies for so long, such as 10s", Kind::none)};

constexpr Command kCommands[] = {
    {"status", "generation and one line a component", "mauvectl status", {}, false, run_status},
    {"list", "components, resources, cores, ports, plugins or clients", "mauvectl list ports",
     kList, false, run_list},
    {"show", "everything about one object", "mauvectl show control", kShow, false, run_show},
    {"get", "values and their status", "mauvectl get control.core.gain fix.read", kGet, false,
     run_get},
    {"set", "properties, all in one change", "mauvectl set control.core.gain=0.3", kSet, true,
     run_set},
    {"watch", "every new value, one a line, until Ctrl-C", "mauvectl --json watch fix.read", kGet,
     false, run_watch},
    {"record", "every new value as a row of CSV",
     "mauvectl record pose.read --for 10s -o drive.csv", kRecord, false, run_record},
    {"plot", "values over time, as an SVG picture",
     "mauvectl plot pose.read --for 10s -o drive.svg", kPlot, false, run_plot},
    {"map", "the way driven, as an SVG picture with what was seen on it",
     "mauvectl map pose.read --mode control.core --for 30s -o drive.svg", kMap, false, run_map},
    {"graph", "the architecture, or a state machine, as a picture", "mauvectl graph -o rover.svg",
     kGraph, false, run_graph},
    {"start", "components, at the next instant of their grid", "mauvectl start gnss", kStart, true,
     run_start},
    {"stop", "components: end the job, write safe values, park", "mauvectl stop --all", kStop, true,
     run_stop},
    {"swap-core", "replace the core of a running component",
     "mauvectl swap-core control guidance/finite_time --set gain=0.3", kSwap, true, run_swap_core},
    {"connect", "a port to a service", "mauvectl connect control.ports.scan scan.read", kConnect,
     true, run_connect},
    {"disconnect", "a port", "mauvectl disconnect gnss.ports.fix", kDisconnect, true,
     run_disconnect},
    {"confirm", "the change on probation: it stays", "mauvectl confirm", {}, true, run_confirm},
    {"undo", "the change on probation: back to before it", "mauvectl undo", {}, true, run_undo},
    {"quarantine", "new cores that failed and were rolled back; release one",
     "mauvectl quarantine release guidance/widest_gap", kQuarantine, true, run_quarantine},
    {"apply", "make the running system that of a file, all at once",
     "mauvectl apply rover.json --dry-run", kApply, true, run_apply},
    {"plan", "what apply would do, prepared and dropped", "mauvectl plan rover.json", kPlan, true,
     run_plan},
    {"diff", "what a file would change; exit code 1 when it is something",
     "mauvectl diff rover.json", kCheck, false, run_diff},
    {"load", "a plugin, by name", "mauvectl load guidance_extra", kPlugin, true, run_load},
    {"unload", "a plugin that nothing uses", "mauvectl unload guidance_extra", kPlugin, true,
     run_unload},
    {"reload", "a rebuilt plugin: move every instance to the new code, without probation",
     "mauvectl reload guidance", kReload, true, run_reload},
    {"plugins", "what is loaded and what it brings", "mauvectl plugins --for control", kPlugins,
     false, run_plugins},
    {"analyze",
     "response times: is every deadline met, by how much",
     "mauvectl analyze",
     {},
     false,
     run_analyze},
    {"stats", "what jobs and states took; reset counts anew", "mauvectl stats control", kStats,
     true, run_stats},
    {"top", "live, one row a component; ? tells the keys", "mauvectl top --interval 500ms", kTop,
     false, run_top},
    {"metrics",
     "state and statistics in the text format of Prometheus",
     "mauvectl metrics > mauve.prom",
     {},
     false,
     run_metrics},
    {"rules", "what the daemon does by itself: state, last firing, why not", "mauvectl rules",
     kRules, false, run_rules},
    {"why", "a component failed: what happened, what was done, what to do", "mauvectl why control",
     kWhy, false, run_why},
    {"check", "an architecture file, all errors at once", "mauvectl check rover.json", kCheck,
     false, run_check},
    {"export",
     "the running system as an architecture file",
     "mauvectl export > now.json",
     {},
     false,
     run_export},
    {"history", "saved generations: when, who, what", "mauvectl history -n 10", kHistory, false,
     run_history},
    {"rollback", "to a saved generation", "mauvectl rollback 41", kRollback, true, run_rollback},
    {"lock", "what may not be changed, but by stop, confirm and undo",
     "mauvectl lock all --reason mission", kLock, true, run_lock},
    {"logs", "the last events", "mauvectl logs -f gnss --level warn", kLogs, false, run_logs},
    {"explain", "what an event of the log means and what to do, or what a plugin's name is",
     "mauvectl explain rule_fired", kExplain, false, run_explain},
    {"trace", "what every thread did when, and recordings of what went wrong",
     "mauvectl trace dump -o now.mtrace", kTrace, false, run_trace},
    {"log", "level: from which level on is logged, also of one component, for a time",
     "mauvectl log level control=debug --for 10min", kLog, true, run_log},
    {"doctor", "is the machine fit for real time; what was found, and the remedy",
     "mauvectl doctor --wake 10s", kDoctor, false, run_doctor},
    {"completion", "the script that makes a shell complete command lines of mauvectl",
     "mauvectl completion bash > ~/.local/share/bash-completion/completions/mauvectl", kCompletion,
     false, run_completion},
    {"timeline", "what ran when, as an SVG picture",
     "mauvectl timeline drive.mtrace --from 1.2s --to 1.25s -o drive.svg", kTimeline, false,
     run_timeline},
    {"check-trace", "prove a trace against the model; exit code 1 when it breaks a rule",
     "mauvectl check-trace drive.mtrace", kCheckTrace, false, run_check_trace},
    {"convert-trace", "for Perfetto and Chrome, or babeltrace2 and Trace Compass",
     "mauvectl convert-trace drive.mtrace -o drive.json", kConvertTrace, false, run_convert_trace},
    {"ping", "does the daemon answer", "mauvectl ping", {}, false, run_ping},
    {"version", "of client and daemon", "mauvectl version", {}, false, run_version},
};

constexpr Category kCategories[] = {
    {"components", "component.list"}, {"resources", "resource.list"}, {"cores", "core.list"},
    {"ports", "port.list"},           {"plugins", "plugin.list"},     {"clients", "client.list"},
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
