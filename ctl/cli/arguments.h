// SPDX-License-Identifier: LGPL-3.0-or-later
/// The arguments of each command, for the rows of command.cpp.
#pragma once

#include "cli/command.h"

namespace mauve::ctl::argument_table {

inline constexpr Argument kState = choice("--state", "\"drop\": begin with a fresh state", "drop");
inline constexpr Argument kSync = choice(
    "--sync",
    "\"cut\", or \"barrier\": members wait for each other; default: where a contract changes",
    "cut barrier");
inline constexpr Argument kComponent = one("COMPONENT", "name of a component", Kind::component);
inline constexpr Argument kPort = one("PORT", "such as control.ports.scan", Kind::port);

inline constexpr Argument kProbation =
    also("off",
         maybe("--probation",
               "jobs of each member until the probation ends (default: 3000), or off", Kind::none));
inline constexpr Argument kMisses = maybe(
    "--misses",
    "M/K, such as 1/64: late jobs that the probation tolerates, M of the last K; M is at least "
    "1 (default: 2/64); a late job counts once, however many releases it cost",
    Kind::none);
inline constexpr Argument kConfirmWithin = maybe(
    "--confirm-within", "rolled back unless confirmed in this time, such as 30s", Kind::duration);

inline constexpr Argument kInPlace = flag("--in-place",
                                          "stop, change, start: for a device that only one core "
                                          "can hold; failures roll back, late jobs do "
                                          "not");
inline constexpr Argument kDryRun =
    flag("--dry-run", "show what the change would do; it is prepared and dropped");

inline constexpr Argument kList[] = {maybe(
    "KIND",
    "components (default), resources, services, cores, fsms, types, ports, plugins or clients",
    Kind::category)};
inline constexpr Argument kShow[] = {
    one("ADDRESS", "component, resource or anything in them, or a type of data", Kind::address)};
inline constexpr Argument kGet[] = {
    some("ADDRESS", "such as control.core.gain or fix.read", Kind::address)};
inline constexpr Argument kWatch[] = {
    some("ADDRESS", "such as control.core.gain or fix.read", Kind::address),
    maybe("--every", "at most one value of each address in this time, such as 500ms",
          Kind::duration),
    flag("--changes", "only values that differ from the one before")};
inline constexpr Argument kFor =
    maybe("--for", "how long, such as 10s; default: until Ctrl-C", Kind::duration);
inline constexpr Argument kRecord[] = {
    some("ADDRESS", "such as pose.read or control.missed", Kind::address), kFor,
    maybe("-o,--output", "file for the CSV; default, and -: standard output", Kind::file)};
inline constexpr Argument kPicture =
    maybe("-o,--output", "file for the SVG; default, and -: standard output", Kind::file);
inline constexpr Argument kPlot[] = {
    some("ADDRESS", "of numbers, such as pose.read", Kind::address), kFor, kPicture};
inline constexpr Argument kMap[] = {
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
inline constexpr Argument kGraph[] = {
    any("ELEMENT", "only these components and resources, with what they are connected to",
        Kind::component),
    flag("--dot", "for Graphviz (unless the name of the file says something else)"),
    flag("--mermaid", "for Markdown (by itself where the file ends with .mmd)"),
    flag("--svg", "a picture (by itself where the file ends with .svg)"),
    maybe("--fsm", "the state machine of this component instead", Kind::component),
    maybe("-o,--output", "file for it; default, and -: standard output", Kind::file)};
inline constexpr Argument kSet[] = {some("ADDRESS=VALUE", "JSON, or a bare text", Kind::assignment),
                                    kInPlace,
                                    kDryRun,
                                    kState,
                                    kProbation,
                                    kMisses,
                                    kConfirmWithin};
inline constexpr Argument kSteps[] = {
    {"-f,--file", "the steps, an array as of a transaction; - for standard input", Kind::file,
     true},
    kDryRun,
    kState,
    kProbation,
    kMisses,
    kConfirmWithin};
inline constexpr Argument kCall[] = {
    one("SERVICE", "a call or event service, such as localization.reset", Kind::service),
    any("ARGUMENT", "what the service takes, JSON or a bare text", Kind::none)};
inline constexpr Argument kWrite[] = {
    one("SERVICE", "a write service, such as velocity.write", Kind::service),
    one("VALUE", "JSON or a bare text", Kind::none)};
inline constexpr Argument kWait[] = {
    {"--for", "a condition as of a rule, such as \"control.missed > 3\"", Kind::none, true}};
inline constexpr Argument kStart[] = {any("COMPONENT", "names of components", Kind::component),
                                      flag("--all", "every component that does not run"),
                                      flag("--reset", "with a fresh core state"), kDryRun};
inline constexpr Argument kStop[] = {
    any("COMPONENT", "names of components", Kind::component),
    flag("--all", "every component, in stages: writers of safe values first"), kDryRun};
inline constexpr Argument kSwap[] = {
    kComponent,
    one("CORE", "such as guidance/finite_time", Kind::core),
    any("--set", "NAME=VALUE of a property of the new core", Kind::setting),
    maybe("--budget", "processor time that a job of it may use, such as 2ms", Kind::duration),
    flag("--defaults", "the new core begins with its own values, not with those in force"),
    kInPlace,
    kDryRun,
    kState,
    kProbation,
    kMisses,
    kConfirmWithin};
inline constexpr Argument kConnect[] = {
    kPort,
    one("SERVICE", "such as scan.read", Kind::service),
    maybe("--max-age", "values older than this are stale, such as 50ms", Kind::duration),
    flag("--replace", "exchange the connection that the port has, at one instant"),
    kDryRun,
    kProbation,
    kMisses,
    kConfirmWithin};
inline constexpr Argument kDisconnect[] = {kPort, kDryRun, kProbation, kMisses, kConfirmWithin};
inline constexpr Argument kQuarantine[] = {
    choice("ACTION", "\"release\", or nothing to list", "release"),
    maybe("CORE", "the core to release", Kind::core)};
inline constexpr Argument kPlugin[] = {one("PLUGIN", "name of a plugin, not a path", Kind::plugin)};
inline constexpr Argument kLoad[] = {one("PLUGIN", "name of a plugin, not a path", Kind::available),
                                     kDryRun};
inline constexpr Argument kReload[] = {kPlugin[0], kInPlace,       kState, kProbation,
                                       kMisses,    kConfirmWithin, kDryRun};
inline constexpr Argument kPlugins[] = {
    maybe("--for", "the cores that fit this component", Kind::component)};
inline constexpr Argument kStats[] = {
    also("reset", maybe("ADDRESS", "a component or a state of it; or \"reset\": counts anew",
                        Kind::component)),
    maybe("COMPONENT", "of reset: only this one", Kind::component)};
inline constexpr Argument kTop[] = {
    flag("-b,--batch", "tables one below the other, for scripts; with --json a line each"),
    maybe("-n,--count", "end after so many", Kind::number),
    maybe("--interval", "how often it looks, such as 500ms; default: 1s", Kind::duration)};
inline constexpr Argument kRules[] = {
    maybe("RULE", "only this one, with all its parts", Kind::rule)};
inline constexpr Argument kWhy[] = {kComponent};
inline constexpr Argument kCheck[] = {one("FILE", "an architecture file", Kind::file)};
inline constexpr Argument kApply[] = {
    one("FILE", "an architecture file", Kind::file),
    flag("--dry-run", "prepare and show the change, but change nothing"),
    kState,
    kSync,
    kProbation,
    kMisses,
    kConfirmWithin};
inline constexpr Argument kPlan[] = {one("FILE", "an architecture file", Kind::file), kState, kSync,
                                     kProbation};
inline constexpr Argument kHistory[] = {
    maybe("-n,--lines", "how many of the newest", Kind::number),
    any("GENERATION", "two numbers: print what differs between these generations",
        Kind::generation)};
inline constexpr Argument kRollback[] = {
    one("GENERATION", "a number of mauvectl history", Kind::generation),
    kDryRun,
    kState,
    kSync,
    kProbation,
    kMisses,
    kConfirmWithin};
inline constexpr Argument kConfirm[] = {flag("--dry-run", "show which changes it confirms")};
inline constexpr Argument kUndo[] = {
    maybe("GENERATION", "one that the change made; default: the newest change", Kind::generation),
    flag("--dry-run", "show which changes it rolls back")};
inline constexpr Argument kTrace[] = {
    one_of("ACTION", "start, stop, status, list or dump", "start stop status list dump"),
    maybe("RECORDING", "of dump: one of the list; default: what is traced now", Kind::recording),
    flag("--detail", "of start: every use of a port too"),
    maybe("--for", "of start: what is kept, such as 10s", Kind::duration),
    maybe("-o,--output", "of dump: *.mtrace, *.json for Perfetto, else a folder of CTF",
          Kind::file)};
inline constexpr Argument kLock[] = {
    one_of("LOCK", "none, params, topology or all", "none params topology all")};
inline constexpr Argument kExplain[] = {
    maybe("NAME", "an event, or what a plugin brings; without it, all events", Kind::explained)};
inline constexpr Argument kLogs[] = {
    maybe("COMPONENT", "only the records of this component; with --explain the name of an event",
          Kind::component),
    flag("--explain",
         "what the event of this name means and what to do; without a name, all events"),
    flag("-f,--follow", "go on with what comes"),
    maybe("-n,--lines", "how many of the last records", Kind::number),
    choice("--level", "debug, info, warn or error, and worse", "debug info warn error"),
    maybe("--since", "10min ago, 12:30, or a whole time such as 2026-01-31T12:00:00Z", Kind::none),
    maybe("--grep", "with this in text, component or event; capitals do not matter", Kind::none)};
inline constexpr Argument kLog[] = {
    one_of("WHAT", "level", "level"),
    also("debug info warn error default",
         maybe("SETTING",
               "[COMPONENT=]LEVEL: debug, info, warn, error or default; default: shows it",
               Kind::none)),
    maybe("--for", "reverts by itself after this time, such as 10min", Kind::duration)};
inline constexpr Argument kTraceFile = one("FILE", "a trace, *.mtrace", Kind::file);
inline constexpr Argument kTimeline[] = {
    also("live", maybe("FILE", "a trace, *.mtrace; unsaid, or live: that of the running system",
                       Kind::file)),
    maybe("--from",
          "time since T0, such as 1.2s; default: around the cause of a flight recording, else the "
          "last 50 jobs of the most frequent component, at most 1s",
          Kind::duration),
    maybe("--to", "time since T0", Kind::duration),
    {"--component", "only these, such as control,scan", Kind::component, false, true},
    kPicture};
inline constexpr Argument kCheckTrace[] = {kTraceFile};
inline constexpr Argument kConvertTrace[] = {
    kTraceFile,
    {"-o,--output", "*.json for Perfetto, *.mtrace, else a folder of CTF", Kind::file, true},
    choice("--format", "chrome, ctf or mtrace, whatever the name of the output is",
           "chrome ctf mtrace")};

inline constexpr Argument kNew[] = {
    one_of("KIND", "what the project brings: a core, a component, a resource or a driver",
           "core component resource driver"),
    one("NAME", "of the plugin and its folder: small letters, digits and _, such as my_core",
        Kind::none)};
inline constexpr Argument kHelp[] = {maybe("COMMAND", "name of a command", Kind::command)};
inline constexpr Argument kProtocol[] = {
    maybe("METHOD", "only this method, with all its parameters and the fields of its answer",
          Kind::method)};
inline constexpr Argument kCompletion[] = {one_of("SHELL", "bash, zsh or fish", "bash zsh fish")};
inline constexpr Argument kDoctor[] = {
    maybe("--wake", "also measure wake-up latencies for so long, such as 10s", Kind::duration)};

}  // namespace mauve::ctl::argument_table
